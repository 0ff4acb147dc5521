#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "clients/connection/subscriber.hpp"
#include "clients/terminal/terminal.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/reduction/reduction.hpp"

namespace kolsky::cli {

/// What `watch` knows of the daemon, from its messages in the order they came.
class LiveView {
 public:
  /// The state when the watching began.
  void begin(const v1::Snapshot& snapshot, const v1::ShotList& shots);

  /// Takes in what a subscriber heard. @return a line for people, empty where nothing new happened
  std::string take(const SubscriberEvent& event);

  /// The screen: no more lines than the terminal has rows, none wider.
  [[nodiscard]] std::string screen(const Terminal& terminal) const;

  /// What happened since `begin`, one object each, heartbeats left out.
  [[nodiscard]] const JsonList& events() const { return events_; }
  [[nodiscard]] const v1::Status& status() const { return status_; }
  [[nodiscard]] std::uint64_t results() const { return results_; }
  [[nodiscard]] std::uint64_t lost_messages() const;

 private:
  struct Trace {
    std::string unit;
    double step_s = 0.0;  ///< from one pair to the next
    std::deque<double> minimum;
    std::deque<double> maximum;
  };
  struct LastLoop {
    std::string shot_id;
    Reduction reduction;
  };

  std::string take_message(const Received& message);
  std::string take_status(const Received& message);
  std::string take_shot(const Received& message);
  std::string take_result(const Received& message);
  std::string take_fault(const Received& message);
  std::string take_comparison(const Received& message);
  std::string take_diagnosis(const Received& message);
  void take_preview(const Received& message);
  std::string take_lost(const Lost& lost);
  std::string take_unreadable(const std::string& reason);

  v1::ShotSummary& show_result(const v1::Result& result);
  v1::ShotSummary& summary_of(const std::string& id);

  [[nodiscard]] std::vector<std::string> trace_lines(const Terminal& terminal) const;
  [[nodiscard]] std::vector<std::string> shot_lines(const Terminal& terminal) const;
  [[nodiscard]] std::vector<std::string> loop_lines(const Terminal& terminal, int rows) const;
  [[nodiscard]] std::string loss_line(bool colour) const;
  [[nodiscard]] std::vector<std::string> model_lines(bool colour) const;

  v1::Status status_;
  std::map<std::string, Trace> traces_;  ///< by gauge
  std::deque<v1::ShotSummary> shots_;    ///< newest first
  std::optional<LastLoop> last_loop_;
  std::string last_fault_;
  std::map<std::string, std::uint64_t> lost_;  ///< by topic
  std::uint64_t restarts_ = 0;
  std::uint64_t results_ = 0;
  JsonList events_;
};

}  // namespace kolsky::cli
