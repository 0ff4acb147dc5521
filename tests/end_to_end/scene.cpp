#include "tests/end_to_end/scene.hpp"

#include <unistd.h>

#include <sstream>
#include <stdexcept>
#include <thread>

#include "drivers/simulated/digitiser_setup.hpp"
#include "drivers/simulated/scenario_source.hpp"
#include "processing/base/error.hpp"

namespace kolsky::scene {

namespace {

using Clock = std::chrono::steady_clock;

// A sanitizer makes everything slower but the clock.
#ifdef KOLSKY_SANITIZED
constexpr double kSpeed = 0.1;
#else
constexpr double kSpeed = 1.0;
#endif

const BenchHistory& shot_of(const Scenario& scenario) {
  static std::map<std::string, BenchHistory> shots;
  auto found = shots.find(scenario.name);
  if (found == shots.end()) {
    found = shots.emplace(scenario.name, run_shot(scenario)).first;
  }
  return found->second;
}

std::vector<Fault> script(const std::string& text) {
  std::istringstream stream(text);
  return parse_fault_script(stream, "faults");
}

SubscriberOptions results_of(const EndpointConfig& endpoints) {
  SubscriberOptions options;
  options.endpoint = endpoints.results;
  return options;
}

ControlClientOptions control_of(const EndpointConfig& endpoints, const std::string& client_id) {
  ControlClientOptions options;
  options.endpoint = endpoints.control;
  options.client_id = client_id;
  return options;
}

}  // namespace

Lab::Lab(const LabOptions& options) : scenario_(find_scenario(options.scenario)) {
  if (options.front_end) {
    options.front_end(scenario_.front_end);
  }
  const BenchHistory& shot = shot_of(scenario_);
  truth_ = shot.specimen.value_or(SpecimenHistory{});
  ball_ = shot.ball.value_or(BallHistory{});
  AdcSettings settings = adc_settings(scenario_);
  settings.speed = kSpeed;
  settings.period_s = options.period_s;
  settings.faults = script(options.faults);
  adc_ = std::make_unique<SimulatedAdc>(std::move(settings),
                                        std::make_unique<ScenarioSource>(scenario_, shot));
  server_ = std::make_unique<IiodServer>("127.0.0.1:0", *adc_);
  server_->start();
}

std::int64_t Lab::attribute(const std::string& name) {
  IiodCommand command;
  command.scope = AttributeScope::device;
  command.attribute = name;
  return std::stoll(adc_->read_attribute(command, 0).text);
}

Installation::Installation(const std::string& uri, const std::string& bench) : uri_(uri) {
  folder_.write("bench.toml", bench);
  set("trigger", "channel = \"g1\"");
  // Echoes of one shot last 8 ms; tests fire again sooner than the usual hold-off lets them.
  set("trigger", "hold_off_samples = 15000");
  set("store", "folder = \"store\"");
  for (const char* endpoint : {"results", "preview", "control"}) {
    set("endpoints", std::string(endpoint) + " = \"tcp://127.0.0.1:*\"");
  }
}

Installation& Installation::set(const std::string& section, const std::string& line) {
  sections_[section] += line + "\n";
  return *this;
}

std::filesystem::path Installation::write() const {
  std::string text = "bench = \"bench.toml\"\n";
  const auto top = sections_.find("");
  text += top == sections_.end() ? "" : top->second;
  std::string digitiser = "uri = \"" + uri_ + "\"\n";
  for (const auto& [section, lines] : sections_) {
    if (section == "digitiser") {
      digitiser += lines;
    } else if (!section.empty()) {
      text.append("[").append(section).append("]\n").append(lines);
    }
  }
  folder_.write("kolskyd.toml", text + "[digitiser]\n" + digitiser);
  return folder_ / "kolskyd.toml";
}

Listener::Listener(const EndpointConfig& endpoints, const std::string& client_id)
    : control_(control_of(endpoints, client_id)), subscriber_(results_of(endpoints)) {
  static_cast<void>(subscriber_.join(control_, kPatience));
}

void Listener::arm() {
  std::string refusal = "never tried";
  const bool armed = eventually([&] {
    try {
      control_.arm();
      return true;
    } catch (const InputError& error) {
      refusal = error.what();
      return refusal.find("not known yet") == std::string::npos;  // only the noise needs time
    }
  });
  if (!armed || control_.status().state() != v1::ARMED) {
    throw std::runtime_error("not armed: " + refusal);
  }
}

std::optional<Received> Listener::next(const std::string& topic,
                                       std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  for (;;) {
    std::vector<Received>& mine = waiting_[topic];
    if (!mine.empty()) {
      Received first = std::move(mine.front());
      mine.erase(mine.begin());
      return first;
    }
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) {
      return std::nullopt;
    }
    SubscriberEvent event = subscriber_.next(left);
    if (auto* received = std::get_if<Received>(&event)) {
      waiting_[received->topic].push_back(std::move(*received));
    } else if (const auto* gone = std::get_if<Lost>(&event)) {
      lost_ += gone->count;
    }
  }
}

bool eventually(const std::function<bool()>& condition, std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  while (!condition()) {
    if (Clock::now() > deadline) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace kolsky::scene
