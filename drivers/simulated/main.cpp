#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "drivers/files/captures/capture.hpp"
#include "drivers/simulated/capture_source.hpp"
#include "drivers/simulated/digitiser_setup.hpp"
#include "drivers/simulated/iiod_server.hpp"
#include "drivers/simulated/number_text.hpp"
#include "drivers/simulated/scenario_source.hpp"
#include "processing/base/error.hpp"

namespace {

using namespace kolsky;

constexpr int kBadInput = 2;

constexpr const char* kAfterHelp = R"(
Strains: 1 microstrain = 1e-6. A shot begins when the attribute `fire` is written, or each --period.

Fault script, one fault a line, # begins a comment:
  shot 3 at 120 lose 250       at sample 120 of the third shot
  time 2.5s drop 1s            2.5 s of the converter's time after its start
Faults act when the block that holds that sample is read:
  short N          the reply ends after N samples, the rest comes with the next
  late DURATION    the block is sent so much later
  timeout          the read is answered with a time-out, the block comes with the next
  hang [DURATION]  no connection is answered for so long, or for ever
  drop DURATION    every connection is closed, and new ones for so long
  lose N           N samples are never delivered; the overflow flag rises
  extra-channel    the reply holds a channel that was not asked for
  overflow         the overflow flag rises, nothing is lost
  clip N           N samples stand at the converter's upper end
Attribute injected_lost_samples says how many samples the script has made clients miss.
)";

struct Options {
  std::string listen = "127.0.0.1:30431";
  std::string scenario = "core";
  std::string play;
  std::string faults;
  std::string truth;
  bool list = false;
  bool print_bench = false;
  bool json = false;
  bool no_counter = false;
  double speed = 1.0;
  double period_s = 0.0;
  std::optional<int> bits;
  std::optional<double> noise_microstrain;
  std::optional<double> hum_microstrain;
  std::optional<double> drift_microstrain;
  std::optional<double> offset_microstrain;
  std::optional<double> range_microstrain;
  std::optional<std::int32_t> offset_codes;
  std::uint64_t seed = 1;
  bool listen_given = false;
};

void declare(CLI::App& app, Options& o) {
  app.footer(kAfterHelp);
  app.set_version_flag("--version", std::string("kolsky-digitiser ") + KOLSKY_VERSION);
  auto* listen = app.add_option("--listen", o.listen, "ADDRESS:PORT; port 0 chooses a free one");
  listen->capture_default_str();
  listen->each([&o](const std::string&) { o.listen_given = true; });
  auto* scenario =
      app.add_option("--scenario", o.scenario, "bench to play, see --list")->capture_default_str();
  app.add_option("--play", o.play, "capture, or folder of captures, to play instead of a scenario")
      ->excludes(scenario);
  app.add_option("--speed", o.speed, "factor on real time; 0: as fast as the client reads")
      ->capture_default_str();
  app.add_option("--period", o.period_s, "seconds from shot to shot; 0: on demand only")
      ->capture_default_str();
  app.add_option("--faults", o.faults, "fault script, see below");
  app.add_option("--seed", o.seed, "of the noise")
      ->check([](const std::string& seed) {
        return seed.starts_with("-") ? "a seed is a whole number from 0 up" : std::string();
      })
      ->capture_default_str();
  app.add_option("--bits", o.bits, "resolution, 12 to 24");
  app.add_option("--noise-microstrain", o.noise_microstrain, "white noise, rms");
  app.add_option("--hum-microstrain", o.hum_microstrain, "mains hum, amplitude");
  app.add_option("--drift-microstrain", o.drift_microstrain, "slow wander, amplitude");
  app.add_option("--offset-microstrain,--offset", o.offset_microstrain,
                 "unbalance of the bridges, with alternating sign");
  app.add_option("--range-microstrain", o.range_microstrain, "strain at the converter's ends");
  app.add_option("--offset-codes", o.offset_codes, "codes below 0 at which 0 V reads");
  app.add_flag("--no-counter", o.no_counter, "leave out the sample counter channel count0");
  app.add_flag("--list", o.list, "print the scenarios, name<TAB>text, and leave");
  app.add_flag("--print-bench", o.print_bench, "print the bench file that fits, and leave");
  app.add_option(
      "--truth", o.truth,
      "write what the model knows of the specimen or the ball as CSV, and leave unless --listen");
  app.add_flag("--json", o.json, "print the address as a JSON object");
}

Scenario chosen_scenario(const Options& o) {
  Scenario scenario = find_scenario(o.scenario);
  FrontEndSettings& f = scenario.front_end;
  f.bits = o.bits.value_or(f.bits);
  f.noise_microstrain = o.noise_microstrain.value_or(f.noise_microstrain);
  f.hum_microstrain = o.hum_microstrain.value_or(f.hum_microstrain);
  f.drift_microstrain = o.drift_microstrain.value_or(f.drift_microstrain);
  f.offset_microstrain = o.offset_microstrain.value_or(f.offset_microstrain);
  f.range_microstrain = o.range_microstrain.value_or(f.range_microstrain);
  f.offset_codes = o.offset_codes.value_or(f.offset_codes);
  f.seed = o.seed;
  check(f);
  return scenario;
}

void refuse_front_end_options(const Options& o) {
  if (o.bits || o.noise_microstrain || o.hum_microstrain || o.drift_microstrain ||
      o.offset_microstrain || o.range_microstrain || o.offset_codes || !o.truth.empty()) {
    throw InputError("--play", "a capture's codes are played as they are",
                     "leave out --truth and what sets bits, range, noise, hum, drift or offset");
  }
}

void check_truth_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) {
    throw InputError(path, "is there already", "give another name: nothing is overwritten");
  }
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw InputError(path, "cannot be written: there is no folder " + folder.string(),
                     "give a file in a folder that is there");
  }
}

void write_truth_file(const Scenario& scenario, const BenchHistory& shot, const std::string& path) {
  std::ofstream file(path);
  write_truth(scenario, shot, file);
  if (!file.flush()) {
    throw InputError(path, "cannot be written", "give a file in a folder that can be");
  }
}

std::vector<Fault> read_faults(const std::string& path) {
  if (path.empty()) {
    return {};
  }
  std::ifstream file(path);
  if (std::error_code ignored; !file || std::filesystem::is_directory(path, ignored)) {
    throw InputError(path, "cannot be read", "give a fault script, see --help");
  }
  return parse_fault_script(file, path);
}

/// What is played, and the converter's settings that follow from it.
struct Programme {
  AdcSettings settings;
  std::unique_ptr<CodeSource> source;
};

/// What the options ask for beyond the programme's own settings.
AdcSettings complete(AdcSettings settings, const Options& o) {
  settings.counter = !o.no_counter;
  settings.speed = o.speed;
  settings.period_s = o.period_s;
  settings.faults = read_faults(o.faults);
  settings.log = [](const std::string& text) { spdlog::info("{}", text); };
  check(settings);
  return settings;
}

Programme play_captures(const Options& o) {
  std::vector<Shot> shots;
  for (const auto& path : captures_in(o.play)) {
    shots.push_back(read_capture(path));
  }
  auto source = std::make_unique<CaptureSource>(std::move(shots), o.seed);
  AdcSettings settings = complete(source->settings(), o);
  return {std::move(settings), std::move(source)};
}

Programme play_scenario(const Options& o) {
  const Scenario scenario = chosen_scenario(o);
  AdcSettings settings = complete(adc_settings(scenario), o);
  if (!o.truth.empty()) {
    check_truth_file(o.truth);
  }
  const auto start = std::chrono::steady_clock::now();
  BenchHistory shot = run_shot(scenario);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  spdlog::info("scenario {}: computed in {:.2f} s", scenario.name, took.count());
  if (!o.truth.empty()) {
    write_truth_file(scenario, shot, o.truth);
  }
  return {std::move(settings), std::make_unique<ScenarioSource>(scenario, std::move(shot))};
}

void print_bench(const Options& o) {
  if (o.play.empty()) {
    std::cout << bench_toml(chosen_scenario(o));
    return;
  }
  std::cout << read_capture(captures_in(o.play).front()).bench_toml;
}

void print_address(const Options& o, const IiodServer& server, const SimulatedAdc& adc) {
  if (o.json) {
    std::cout << R"({"uri": ")" << server.uri() << R"(", "channels": )"
              << adc.settings().channels.size() << R"(, "sampling_frequency_Hz": )"
              << number_text(adc.settings().rate.Hz()) << "}" << std::endl;
  } else {
    std::cout << server.uri() << std::endl;
  }
}

void serve(const Options& o, sigset_t& leave) {
  IiodServer::check_address(o.listen);  // before anything is computed
  Programme programme = o.play.empty() ? play_scenario(o) : play_captures(o);
  if (!o.truth.empty() && !o.listen_given) {
    return;
  }
  SimulatedAdc adc(std::move(programme.settings), std::move(programme.source));
  IiodServer server(o.listen, adc);
  server.start();
  print_address(o, server, adc);
  int signal = 0;
  sigwait(&leave, &signal);
}

int run(const Options& o) {
  // Threads inherit the mask, so the signals wait for sigwait.
  sigset_t leave;
  sigemptyset(&leave);
  sigaddset(&leave, SIGINT);
  sigaddset(&leave, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &leave, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit of the shell is an error code here
  if (o.list) {
    for (const Scenario& scenario : scenarios()) {
      std::cout << scenario.name << '\t' << scenario.text << '\n';
    }
    return 0;
  }
  if (!o.play.empty()) {
    refuse_front_end_options(o);
  }
  if (o.print_bench) {
    print_bench(o);
    return 0;
  }
  serve(o, leave);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("kolsky-digitiser"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %n %l: %v");
  CLI::App app("A simulated digitiser at a simulated Hopkinson bar: an IIOD server for libiio");
  Options options;
  declare(app, options);
  try {
    app.parse(argc, argv);
    return run(options);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& wrong) {
    std::cerr << "kolsky-digitiser: " << wrong.what() << "; see --help\n";
  } catch (const InputError& wrong) {
    std::cerr << "kolsky-digitiser: " << wrong.what() << '\n';
  } catch (const std::exception& failure) {
    std::cerr << "kolsky-digitiser: " << failure.what() << '\n';
    return 1;
  }
  return kBadInput;
}
