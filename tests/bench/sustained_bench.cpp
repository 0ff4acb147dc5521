// Runs kolskyd on four channels of the simulated digitiser, accelerated, and says what was lost and
// what share of a core each program took. Leaves with 1 where a sample was lost.
//
// usage: bench_sustained [--speed FACTOR] [--seconds OF_THE_WALL_CLOCK] [--accounted]
#include <iio.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "drivers/simulated/scenario.hpp"
#include "tests/end_to_end/daemon_process.hpp"
#include "tests/end_to_end/scene.hpp"
#include "tests/scratch_folder.hpp"

namespace {

using namespace kolsky;
using scene::DaemonProcess;
using scene::Installation;
using scene::Process;
using Clock = std::chrono::steady_clock;

constexpr const char* kScenario = "bar";  // four gauges
constexpr double kShot_s = 0.5;           ///< of the wall clock, from shot to shot

struct Options {
  double speed = 10.0;
  double seconds = 60.0;
  bool accounted = false;
};

/// A kolsky-digitiser on a free port.
class DigitiserProcess {
 public:
  explicit DigitiserProcess(double speed)
      : process_({KOLSKY_DIGITISER, "--listen", "127.0.0.1:0", "--scenario", kScenario, "--speed",
                  std::to_string(speed), "--period", std::to_string(kShot_s * speed)},
                 folder_ / "output") {
    const bool up = scene::eventually([this] { return !uri().empty(); });
    if (!up) {
      throw std::runtime_error("kolsky-digitiser does not serve:\n" + process_.output());
    }
  }
  [[nodiscard]] Process& process() { return process_; }
  [[nodiscard]] std::string uri() const {
    std::istringstream output(process_.output());
    for (std::string line; std::getline(output, line) && !output.eof();) {
      if (line.starts_with("ip:")) {
        return line;
      }
    }
    return "";
  }
  [[nodiscard]] std::int64_t attribute(const char* name) const {
    iio_context* context = iio_create_context_from_uri(std::string(uri()).data());
    if (context == nullptr) {
      throw std::runtime_error(uri() + " does not answer");
    }
    long long value = 0;
    const iio_device* device = iio_context_find_device(context, "kolsky-adc");
    const int error = iio_device_attr_read_longlong(device, name, &value);
    iio_context_destroy(context);
    if (error != 0) {
      throw std::runtime_error(std::string("no attribute ") + name);
    }
    return value;
  }

 private:
  testing::ScratchFolder folder_;
  Process process_;
};

struct Snapshot {
  v1::Status status;
  double daemon_cpu_s = 0.0;
  double digitiser_cpu_s = 0.0;
  Clock::time_point time = Clock::now();
};

Snapshot look(DaemonProcess& daemon, DigitiserProcess& digitiser) {
  return {.status = daemon.listener().control().status(),
          .daemon_cpu_s = daemon.process().cpu_s(),
          .digitiser_cpu_s = digitiser.process().cpu_s()};
}

/// @return whether the daemon keeps to its share of a core
bool print(const Snapshot& before, const Snapshot& after, double speed) {
  const double wall_s = std::chrono::duration<double>(after.time - before.time).count();
  const auto samples =
      static_cast<double>(after.status.samples_read() - before.status.samples_read());
  const auto share = [&](double earlier_s, double later_s) {
    return 100.0 * (later_s - earlier_s) / wall_s;
  };
  std::printf("speed %g, %.0f s of the wall clock: %.1f s of signal, 4 x %.0f samples\n", speed,
              wall_s, 1e-6 * samples, samples);
  std::printf("lost %llu samples, %llu gaps of unknown length, %llu overflows, %llu reconnects\n",
              static_cast<unsigned long long>(after.status.samples_missing()),
              static_cast<unsigned long long>(after.status.gaps_of_unknown_length()),
              static_cast<unsigned long long>(after.status.overflows()),
              static_cast<unsigned long long>(after.status.reconnects()));
  constexpr double kBound = 15.0;
  const double real_time = share(before.daemon_cpu_s, after.daemon_cpu_s) / speed;
  std::printf(
      "kolskyd %.1f %% of one core (%.1f %% at real time, bound %.0f: %s), kolsky-digitiser "
      "%.1f %%\n",
      share(before.daemon_cpu_s, after.daemon_cpu_s), real_time, kBound,
      real_time < kBound ? "kept" : "MISSED", share(before.digitiser_cpu_s, after.digitiser_cpu_s));
  return real_time < kBound;
}

/// What the daemon counted is what the digitiser says it withheld.
bool accounted_for(DaemonProcess& daemon, const DigitiserProcess& digitiser) {
  return scene::eventually([&] {
    const auto withheld = digitiser.attribute("overrun_lost_samples");
    const v1::Status status = daemon.listener().control().status();
    return static_cast<std::int64_t>(status.samples_missing()) == withheld &&
           status.reconnects() == 0 && status.gaps_of_unknown_length() == 0;
  });
}

bool run(const Options& options) {
  DigitiserProcess digitiser(options.speed);
  Installation installation(digitiser.uri(), bench_toml(find_scenario(kScenario)));
  installation.write();
  DaemonProcess daemon(installation);
  daemon.listener().arm();
  const Snapshot before = look(daemon, digitiser);
  std::this_thread::sleep_for(std::chrono::duration<double>(options.seconds));
  const Snapshot after = look(daemon, digitiser);
  const bool kept = print(before, after, options.speed);
  const bool accounted = accounted_for(daemon, digitiser);
  std::printf("%llu triggers, %llu shots stored; what is missing is %saccounted for\n",
              static_cast<unsigned long long>(after.status.triggers()),
              static_cast<unsigned long long>(after.status.shots_stored()),
              accounted ? "" : "NOT ");
  return accounted && (options.accounted || (kept && after.status.samples_missing() == 0));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("kolskyd on four accelerated channels: what is lost, what it takes",
               "bench_sustained");
  Options options;
  app.add_option("--speed", options.speed, "factor on real time")->capture_default_str();
  app.add_option("--seconds", options.seconds, "of the wall clock")->capture_default_str();
  app.add_flag("--accounted", options.accounted,
               "losses and the share of a core are no failure, only what is not counted is");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options) ? 0 : 1;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "bench_sustained: %s\n", failure.what());
    return 1;
  }
}
