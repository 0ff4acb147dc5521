#include "daemon/live/monitor.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "daemon/live/previewer.hpp"
#include "daemon/live/sd_notify.hpp"
#include "daemon/log.hpp"

namespace kolsky {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTurn{50};
constexpr milliseconds kHeartbeat{1000};
// A read returns within about a second, a reconnection within libiio's network time-out.
constexpr milliseconds kReadPatience{15'000};
constexpr milliseconds kDiskPatience{20'000};

}  // namespace

Monitor::Monitor(Station& station, Controller& controller, bool auto_arm)
    : station_(station),
      controller_(controller),
      auto_arm_(auto_arm),
      watchdog_interval_(watchdog_interval_us() / 2) {
  threads_.add("acquisition", kReadPatience, [&acquirer = station.acquirer()] {
    return ThreadWatch::Pulse{acquirer.counters().progress, !acquirer.ended()};
  });
  threads_.add("recorder", kDiskPatience, [&recorder = station.recorder()] {
    return ThreadWatch::Pulse{recorder.counters().progress, recorder.busy()};
  });
  threads_.add("archivist", kDiskPatience, [&archivist = station.archivist()] {
    return ThreadWatch::Pulse{archivist.progress(), !archivist.idle()};
  });
}

Monitor::~Monitor() {
  stop();
}

void Monitor::start() {
  thread_ = Thread("kolsky-monitor", [this] { run(); });
}

void Monitor::stop() {
  stop_.store(true);
  thread_.join();
}

void Monitor::run() {
  auto next = std::chrono::steady_clock::now();
  while (!stop_.load()) {
    turn(next);
    next = std::max(next + kTurn, std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

void Monitor::turn(std::chrono::steady_clock::time_point now) {
  preview();
  if (auto_arm_) {
    arm_by_itself();
  }
  const int state = controller_.state();
  const std::uint64_t stored = station_.archivist().stored();
  if (now >= next_heartbeat_ || state != last_state_ || stored != last_stored_) {
    last_state_ = state;
    last_stored_ = stored;
    next_heartbeat_ = now + kHeartbeat;
    controller_.publish_status();
  }
  watch_threads(now);
}

void Monitor::preview() {
  if (auto settings = station_.settings(); settings != previewed_) {
    previewer_ =
        std::make_unique<Previewer>(station_.ring(), station_.publisher(), settings->blank);
    previewed_ = std::move(settings);
  }
  previewer_->publish_new();
}

void Monitor::arm_by_itself() {
  const std::vector<PreflightItem> items = controller_.try_arm();
  auto_arm_ = !passed(items);
  const std::string refusal = failures(items);
  if (refusal != last_refusal_ && !refusal.empty()) {
    log::info("not armed yet: " + refusal);
  }
  last_refusal_ = refusal;
}

void Monitor::watch_threads(std::chrono::steady_clock::time_point now) {
  const std::optional<std::string> stuck = threads_.find_stuck(now);
  if (stuck && stuck_ != *stuck) {
    log::error("the " + *stuck + " thread does not get on");
  }
  stuck_ = stuck.value_or("");
  if (!stuck && watchdog_interval_.count() > 0 && now >= next_watchdog_) {
    next_watchdog_ = now + watchdog_interval_;
    sd_notify("WATCHDOG=1");
  }
}

}  // namespace kolsky
