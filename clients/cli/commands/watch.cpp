#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/daemon_shot.hpp"
#include "clients/cli/live/live_view.hpp"
#include "clients/cli/reports/daemon_text.hpp"
#include "clients/connection/subscriber.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kJoinPatience{3000};
constexpr milliseconds kListen{40};
constexpr milliseconds kRedraw{100};
constexpr milliseconds kHeardBeforeOnce{1500};  // longer than a heartbeat
constexpr std::size_t kListedShots = 16;
constexpr int kPageRows = 40;  // of --once into a file

struct Settings {
  bool once = false;
  std::optional<std::uint64_t> count;
  std::optional<double> seconds;
  std::optional<std::string> results;
  std::optional<std::string> preview;
};

volatile std::sig_atomic_t interrupted = 0;

// For as long as it lives, Ctrl-C ends the watching and not the program.
class InterruptGuard {
 public:
  InterruptGuard() {
    struct sigaction action {};
    action.sa_handler = [](int) { interrupted = 1; };
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
  }
  ~InterruptGuard() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction old_int_ {};
  struct sigaction old_term_ {};
};

// The whole terminal while it lives; what was there before comes back.
class Screen {
 public:
  explicit Screen(std::ostream& out) : out_(out) { out_ << "\x1b[?1049h\x1b[?25l" << std::flush; }
  ~Screen() { out_ << "\x1b[?25h\x1b[?1049l" << std::flush; }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void show(const std::string& text) {
    std::string lines;
    for (const char character : text) {
      lines += character == '\n' ? std::string("\x1b[K\n") : std::string(1, character);
    }
    out_ << "\x1b[H" << lines << "\x1b[J" << std::flush;
  }

 private:
  std::ostream& out_;
};

Subscriber subscribe(const std::string& endpoint, std::vector<std::string> topics) {
  SubscriberOptions options;
  options.endpoint = endpoint;
  options.topics = std::move(topics);
  return Subscriber(options);
}

// "tcp://0.0.0.0:5600" with the host of "tcp://lab:5602" is "tcp://lab:5600"; other transports and
// addresses stay as they are.
std::string with_host_of(const std::string& bound, const std::string& control) {
  const std::size_t port = bound.rfind(':');
  for (const std::string_view anywhere : {"tcp://*", "tcp://0.0.0.0", "tcp://[::]"}) {
    if (bound.substr(0, port) == anywhere && control.starts_with("tcp://")) {
      return control.substr(0, control.rfind(':')) + bound.substr(port);
    }
  }
  return bound;
}

class Watch {
 public:
  Watch(const Settings& settings, Context& context)
      : settings_(settings),
        context_(context),
        control_(connect(context.endpoint)),
        told_(control_.status()),
        results_(subscribe(
            endpoint(settings.results, told_.results_endpoint(), wire::kDefaultResultsEndpoint),
            SubscriberOptions{}.topics)),
        preview_(subscribe(
            endpoint(settings.preview, told_.preview_endpoint(), wire::kDefaultPreviewEndpoint),
            {wire::kPreviewTopic})) {
    const v1::Snapshot snapshot = results_.join(control_, kJoinPatience);
    view_.begin(snapshot, control_.list_shots(kListedShots));
  }

  // Listens until it is time to end. @return whether what was waited for came
  bool run() {
    std::optional<Screen> screen;
    if (context_.terminal.interactive && !settings_.once && !context_.json) {
      screen.emplace(context_.out);
    }
    const Clock::time_point begin = Clock::now();
    Clock::time_point drawn{};
    while (interrupted == 0 && !over(begin)) {
      listen(screen.has_value());
      if (screen.has_value() && Clock::now() - drawn >= kRedraw) {
        screen->show(view_.screen(terminal_of(STDOUT_FILENO)));
        drawn = Clock::now();
      }
    }
    return !settings_.count.has_value() || view_.results() >= *settings_.count;
  }

  [[nodiscard]] const LiveView& view() const { return view_; }

 private:
  // Told by hand (a tunnel), or what the daemon binds as seen from here: by the host that control
  // was reached by.
  [[nodiscard]] std::string endpoint(const std::optional<std::string>& by_hand,
                                     const std::string& bound, const std::string& otherwise) const {
    if (by_hand.has_value()) {
      return *by_hand;
    }
    return bound.empty() ? otherwise : with_host_of(bound, context_.endpoint);
  }

  [[nodiscard]] bool over(Clock::time_point begin) const {
    if (settings_.count.has_value() && view_.results() >= *settings_.count) {
      return true;
    }
    const auto elapsed = Clock::now() - begin;
    if (settings_.seconds.has_value()) {
      return elapsed >= std::chrono::duration<double>(*settings_.seconds);
    }
    return settings_.once && elapsed >= kHeardBeforeOnce;
  }

  void listen(bool on_screen) {
    // The preview first: it never waits, so that results cannot be held up by it.
    while (true) {
      const SubscriberEvent event = preview_.next(milliseconds(0));
      if (std::holds_alternative<Silence>(event)) {
        break;
      }
      static_cast<void>(view_.take(event));
    }
    const std::string line = view_.take(results_.next(kListen));
    if (!line.empty() && !on_screen && !settings_.once && !context_.json) {
      context_.out << line << std::endl;
    }
  }

  const Settings& settings_;
  Context& context_;
  ControlClient control_;
  v1::Status told_;
  Subscriber results_;
  Subscriber preview_;
  LiveView view_;
};

void refuse_endless_json(const Settings& settings) {
  if (!settings.once && !settings.count.has_value() && !settings.seconds.has_value()) {
    throw InputError("kolsky watch: --json", "would never end",
                     "say how long with --count N, --for SECONDS or --once");
  }
}

void refuse_nothing(const Settings& settings) {
  if (settings.count == 0U) {
    throw InputError("kolsky watch: --count", "0 results are there already", "give 1 or more");
  }
  if (settings.seconds.has_value() && !(*settings.seconds > 0.0)) {
    throw InputError("kolsky watch: --for", "is not a time to listen", "give more than 0 seconds");
  }
}

int run(const Settings& settings, Context& context) {
  refuse_nothing(settings);
  if (context.json) {
    refuse_endless_json(settings);
  }
  const InterruptGuard guard;
  Watch watch(settings, context);
  const bool complete = watch.run();
  if (context.json) {
    context.out << to_text(JsonObject{{"events", watch.view().events()},
                                      {"results", watch.view().results()},
                                      {"lost_messages", watch.view().lost_messages()},
                                      {"complete", complete},
                                      {"status", describe(watch.view().status())}})
                << "\n";
  } else if (settings.once) {
    Terminal page = context.terminal;
    page.rows = page.interactive ? page.rows : kPageRows;
    context.out << watch.view().screen(page);
  }
  return complete ? kDone : kUnexpected;
}

}  // namespace

Command watch_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "watch";
  command.purpose =
      "the daemon live: traces, state, noise, shots and the last loop as they come\n"
      "On a terminal a screen until Ctrl-C; into a file or pipe a line for everything that "
      "happens.\n"
      "Messages lost on the way are counted and shown. Exit code 1: --for ended before --count.";
  command.examples =
      "  kolsky watch\n"
      "  kolsky watch --once\n"
      "  kolsky watch --json --count 1 --for 30\n";
  command.uses_daemon = true;
  command.arguments = {
      flag("--once", "listen for a moment, print the screen once and end", &s.once),
      option("--count", "N", "end after so many results", &s.count),
      option("--for", "SECONDS", "end after so many seconds", &s.seconds),
      option("--results", "TCP", "where to hear results; else where the daemon says", &s.results),
      option("--preview", "TCP", "where to hear the preview; else where the daemon says",
             &s.preview)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
