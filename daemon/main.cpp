#include <fmt/format.h>
#include <signal.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "daemon/check_report.hpp"
#include "daemon/config.hpp"
#include "daemon/critic/active_model.hpp"
#include "daemon/daemon.hpp"
#include "daemon/live/sd_notify.hpp"
#include "daemon/log.hpp"
#include "drivers/digitiser/library_messages.hpp"
#include "drivers/memory/kept_memory.hpp"
#include "processing/base/error.hpp"

namespace {

constexpr int kBadInput = 2;

constexpr const char* kAbout =
    "Reads strain gauges through a digitiser, catches shots and publishes their stress-strain "
    "result.\n"
    "\n"
    "KOLSKYD.toml says what to read and where to keep it; the least it needs:\n"
    "  bench = \"bench.toml\"                  # the apparatus\n"
    "  [digitiser]\n"
    "  uri = \"ip:127.0.0.1:30431\"            # any libiio URI, or replay:CAPTURE-OR-FOLDER\n"
    "  [trigger]\n"
    "  channel = \"g1\"                        # the gauge that sees the incident pulse\n"
    "  [store]\n"
    "  folder = \"store\"\n"
    "And, where shots are to be reduced otherwise than `kolsky reduce` does by itself:\n"
    "  [reduction]\n"
    "  dispersion = \"exact\"                 # keys are the options of `kolsky reduce`\n"
    "Paths in it are relative to the file. docs/operation.md has the rest.";

constexpr const char* kGoOn =
    "Then: `kolsky status`, `kolsky arm`, `kolsky watch`. SIGINT and SIGTERM end the daemon after\n"
    "everything in hand is stored. Exit codes: 0 done, 2 something given is wrong (one line says "
    "what),\n"
    "1 a failure.";

struct Arguments {
  std::string config;
  bool check = false;
  bool exit_at_end = false;
  bool verbose = false;
  bool quiet = false;
};

sigset_t end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

/// Waits for a tenth of a second at most. @return whether the process was asked to end
bool signalled() {
  const sigset_t signals = end_signals();
  const timespec patience{.tv_sec = 0, .tv_nsec = 100'000'000};
  return sigtimedwait(&signals, nullptr, &patience) > 0;
}

void run(const Arguments& arguments) {
  kolsky::DaemonConfig config = kolsky::read_config(arguments.config);
  if (arguments.check) {
    const kolsky::Apparatus apparatus = kolsky::read_apparatus(config);
    static_cast<void>(kolsky::read_active_model(config, apparatus.bench));
    std::fputs(kolsky::check_report(config, apparatus).c_str(), stdout);
    return;
  }
  if (arguments.exit_at_end && !config.digitiser.uri.starts_with("replay:")) {
    throw kolsky::InputError("--exit-at-end", "the digitiser is not a replay and has no end",
                             "leave it out, or give a replay: URI");
  }
  kolsky::Daemon daemon(config);
  daemon.start();
  const kolsky::EndpointConfig endpoints = daemon.endpoints();
  kolsky::log::info(fmt::format("reading {}; results {}, preview {}, control {}",
                                config.digitiser.uri, endpoints.results, endpoints.preview,
                                endpoints.control));
  kolsky::sd_notify("READY=1");
  while (!signalled() && !daemon.stop_requested() &&
         !(arguments.exit_at_end && daemon.finished())) {
  }
  kolsky::sd_notify("STOPPING=1");
  kolsky::log::info("stopping");
  daemon.stop();
}

int guarded_run(const Arguments& arguments) {
  try {
    run(arguments);
    return 0;
  } catch (const kolsky::InputError& error) {
    kolsky::log::stop();
    std::fprintf(stderr, "kolskyd: %s\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    kolsky::log::stop();
    std::fprintf(stderr, "kolskyd: %s\n", error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  kolsky::keep_freed_memory();
  CLI::App app(kAbout, "kolskyd");
  app.footer(kGoOn);
  app.set_version_flag("--version", "kolskyd " KOLSKY_VERSION);
  Arguments arguments;
  app.add_option("--config", arguments.config, "the daemon's settings (TOML)")
      ->required()
      ->type_name("KOLSKYD.toml");
  app.add_flag("--check", arguments.check,
               "read the settings and the bench, say what would be done, open nothing");
  app.add_flag("--exit-at-end", arguments.exit_at_end,
               "end when a replay is over and all its shots are stored");
  app.add_flag("--verbose", arguments.verbose, "log more");
  app.add_flag("--quiet", arguments.quiet, "log only what went wrong");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "kolskyd: %s; see kolskyd --help\n", error.what());
    return kBadInput;
  }

  // Blocked before any thread begins, so that only the wait in `signalled` sees them.
  const sigset_t signals = end_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGXFSZ, SIG_IGN);  // so is a file beyond the limit of the shell
  signal(SIGPIPE, SIG_IGN);  // a digitiser or client that drops its socket is an error code here

  kolsky::leave_out_libiio_messages();
  using kolsky::log::Level;
  kolsky::log::start(arguments.quiet     ? Level::quiet
                     : arguments.verbose ? Level::verbose
                                         : Level::normal);
  const int code = guarded_run(arguments);
  kolsky::log::stop();
  return code;
}
