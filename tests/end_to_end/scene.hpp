#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "clients/connection/control_client.hpp"
#include "clients/connection/subscriber.hpp"
#include "daemon/config.hpp"
#include "drivers/simulated/iiod_server.hpp"
#include "drivers/simulated/scenario.hpp"
#include "drivers/simulated/simulated_adc.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "tests/scratch_folder.hpp"

namespace kolsky::scene {

struct LabOptions {
  std::string scenario = "core";
  std::string faults{};  ///< script
  double period_s = 0.0;
  std::function<void(FrontEndSettings&)> front_end{};
};

/// The simulated digitiser behind its IIOD server, and the bench file that goes with it. The model
/// of a scenario is run once per process.
class Lab {
 public:
  explicit Lab(const LabOptions& options = {});

  [[nodiscard]] std::string uri() const { return server_->uri(); }
  [[nodiscard]] std::string bench() const { return bench_toml(scenario_); }
  /// What the model knows of the specimen.
  [[nodiscard]] const SpecimenHistory& truth() const { return truth_; }
  /// And of a ball.
  [[nodiscard]] const BallHistory& ball() const { return ball_; }
  [[nodiscard]] std::int64_t attribute(const std::string& name);
  void stop() { server_->stop(); }

 private:
  Scenario scenario_;
  SpecimenHistory truth_;
  BallHistory ball_;
  std::unique_ptr<SimulatedAdc> adc_;
  std::unique_ptr<IiodServer> server_;
};

/// A configuration in a folder of its own, on free ports.
class Installation {
 public:
  /// @param uri    of the digitiser
  /// @param bench  text of the bench file
  Installation(const std::string& uri, const std::string& bench);

  /// Lines for a section; none replace what is there.
  Installation& set(const std::string& section, const std::string& line);
  /// Writes the file. @return its path
  std::filesystem::path write() const;
  [[nodiscard]] DaemonConfig read() const { return read_config(write()); }
  [[nodiscard]] std::filesystem::path store() const { return folder_ / "store"; }
  [[nodiscard]] const testing::ScratchFolder& folder() const { return folder_; }

 private:
  testing::ScratchFolder folder_;
  std::string uri_;
  std::map<std::string, std::string> sections_;
};

/// A client that has subscribed before anything happens.
class Listener {
 public:
  Listener(const EndpointConfig& endpoints, const std::string& client_id = "tester");

  [[nodiscard]] ControlClient& control() { return control_; }
  /// Arms as soon as the preflight passes. @throws what arming threw in the end
  void arm();
  /// The next message of a topic; empty after the patience.
  [[nodiscard]] std::optional<Received> next(const std::string& topic,
                                             std::chrono::milliseconds patience = kPatience);
  template <typename Message>
  [[nodiscard]] std::optional<Message> next_message(
      const std::string& topic, std::chrono::milliseconds patience = kPatience) {
    const std::optional<Received> received = next(topic, patience);
    Message message;
    if (!received || !message.ParseFromString(received->payload)) {
      return std::nullopt;
    }
    return message;
  }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

  static constexpr std::chrono::milliseconds kPatience{5000};

 private:
  ControlClient control_;
  Subscriber subscriber_;
  std::map<std::string, std::vector<Received>> waiting_;
  std::uint64_t lost_ = 0;
};

/// Looks again and again until it is so. @return whether it came to be
[[nodiscard]] bool eventually(const std::function<bool()>& condition,
                              std::chrono::milliseconds patience = std::chrono::seconds(10));

}  // namespace kolsky::scene
