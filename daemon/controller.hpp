#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/live/preflight.hpp"
#include "daemon/publish/control_server.hpp"
#include "daemon/station.hpp"

namespace kolsky {

/// What clients may ask of a station, and the states it goes through.
class Controller : public ControlHandler {
 public:
  explicit Controller(Station& station);

  void status(v1::Status& status) override;
  void snapshot(v1::Snapshot& snapshot) override;
  void arm(v1::Preflight& preflight) override;
  void disarm() override;
  void force_trigger() override;
  void fire() override;
  void reload() override;
  void stop() override { stop_requested_.store(true); }
  void list_shots(std::size_t most, v1::ShotList& shots) override;
  void get_shot(const std::string& id, v1::ShotAndResult& shot) override;
  void diagnose(const v1::Diagnose& request, v1::Diagnosis& diagnosis) override;
  void cancel_diagnosis() override { station_.diagnoses().cancel(); }
  void diagnosis(v1::Diagnosis& diagnosis) override;

  /// Arms if the preflight passes. @return its items
  std::vector<PreflightItem> try_arm();
  void publish_status();
  /// Changes whenever the state does; for whoever publishes changes.
  [[nodiscard]] int state() const;
  [[nodiscard]] bool stop_requested() const { return stop_requested_.load(); }
  /// Who to name as the operator; called for every status.
  void name_operator(std::function<std::string()> name);

 private:
  [[nodiscard]] PreflightFacts facts();
  void fill_channels(v1::Status& status);
  void fill_criticism(v1::Status& status);
  void wait_for_trigger() const;
  void need_stream(const char* command) const;

  Station& station_;
  std::atomic<bool> stop_requested_{false};
  std::mutex operator_mutex_;
  std::function<std::string()> operator_;
};

}  // namespace kolsky
