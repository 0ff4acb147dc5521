// Fires shots at a simulated digitiser with scripted faults, kills the daemon at random moments,
// and accounts for every shot and every sample that was lost.
//
// usage: soak [--shots N] [--seed S] [--kill SHARE]
// Each shot must end in one of these, or the program fails:
//   stored     a capture whose reduction is what the shot's fault lets it be
//   cut        the daemon was killed after the shot was fired and had not announced it
//   in a hole  the digitiser's queue ran over by itself where the pulse was, and the hole is
//   counted
// and where it was not killed, samples counted as missing are those that the digitiser says it
// withheld.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <thread>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/store.hpp"
#include "processing/base/error.hpp"
#include "tests/end_to_end/daemon_process.hpp"
#include "tests/end_to_end/scene.hpp"

namespace {

using namespace kolsky;
using scene::DaemonProcess;
using scene::eventually;
using scene::Installation;
using scene::Lab;
using std::chrono::milliseconds;

struct Options {
  int shots = 10;
  std::uint64_t seed = 1;
  double kill_share = 0.25;
};

/// What is to happen to one shot.
struct Planned {
  std::string fault;  ///< line of the script without its moment; empty: none
  int at_sample = 0;
  std::int64_t lost_in_window = 0;
  bool reducible = true;
  bool killed = false;
  milliseconds kill_after{0};
  bool killed_at_start = false;  ///< and once more while it recovers
  milliseconds start_lasts{0};
};

Planned plan_shot(std::mt19937_64& random, double kill_share) {
  const auto within = [&](int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random);
  };
  Planned shot;
  const int kind = within(0, 99);
  shot.at_sample = within(600, 3000);  // inside the window, which ends near sample 3800 of the shot
  if (kind < 40) {
    shot.fault = "";
  } else if (kind < 58) {
    shot.lost_in_window = within(1, 400);
    shot.fault = "lose " + std::to_string(shot.lost_in_window);
    shot.reducible = false;
  } else if (kind < 66) {
    shot.at_sample = within(5500, 7500);  // after the window
    shot.fault = "lose " + std::to_string(within(1, 400));
  } else if (kind < 74) {
    shot.fault = "clip " + std::to_string(within(3, 60));
    shot.reducible = false;
  } else if (kind < 80) {
    shot.fault = "short " + std::to_string(within(1, 1000));
  } else if (kind < 86) {
    shot.fault = "late 1ms";
  } else if (kind < 90) {
    shot.fault = "timeout";
  } else if (kind < 94) {
    shot.fault = "overflow";
  } else {
    // The whole block that holds this sample is gone; the pulse must have been seen before it.
    shot.at_sample = within(1900, 3000);
    shot.fault = "drop " + std::to_string(within(50, 300)) + "ms";
    shot.reducible = false;
  }
  shot.killed = std::uniform_real_distribution<double>(0.0, 1.0)(random) < kill_share;
  shot.kill_after = milliseconds(within(0, 25));
  shot.killed_at_start = within(0, 3) == 0;
  shot.start_lasts = milliseconds(within(0, 150));
  return shot;
}

std::string fault_script(const std::vector<Planned>& shots) {
  std::string script;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (!shots[i].fault.empty()) {
      script += "shot " + std::to_string(i + 1) + " at " + std::to_string(shots[i].at_sample) +
                " " + shots[i].fault + "\n";
    }
  }
  return script;
}

/// What has been lost so far, as the digitiser and as the daemon say.
struct Losses {
  std::int64_t withheld = 0;
  std::int64_t counted = 0;
  std::int64_t unknown_gaps = 0;
};

class Soak {
 public:
  explicit Soak(const Options& options)
      : shots_(planned(options)),
        lab_({.faults = fault_script(shots_)}),
        installation_(lab_.uri(), lab_.bench()) {
    // A journal takes a shot or two: they turn over within each life, not only from life to life.
    installation_.set("store", "journal_limit_bytes = 40000");
    installation_.write();
  }

  bool run() {
    for (std::size_t i = 0; i < shots_.size(); ++i) {
      number_ = i + 1;
      be_ready();
      fire();
      if (shots_[i].killed) {
        kill_and_recover(shots_[i]);
      } else {
        follow(shots_[i]);
      }
      // Until the bars are quiet and the trigger's hold-off is over.
      std::this_thread::sleep_for(milliseconds(40));
    }
    finish();
    report();
    return failures_ == 0;
  }

 private:
  static std::vector<Planned> planned(const Options& options) {
    std::mt19937_64 random(options.seed);
    std::vector<Planned> shots;
    shots.reserve(static_cast<std::size_t>(options.shots));
    for (int i = 0; i < options.shots; ++i) {
      shots.push_back(plan_shot(random, options.kill_share));
    }
    return shots;
  }

  void fail(const std::string& what) {
    ++failures_;
    const Planned& shot = shots_[number_ - 1];
    std::printf("shot %zu (%s at %d%s): %s\n", number_,
                shot.fault.empty() ? "no fault" : shot.fault.c_str(), shot.at_sample,
                shot.killed ? ", killed" : "", what.c_str());
    if (daemon_) {
      print_log_end();
    }
  }

  /// What the daemon has said last.
  void print_log_end() {
    constexpr std::size_t kMost = 1500;
    const std::string log = daemon_->process().output();
    const std::size_t from = log.size() > kMost ? log.find('\n', log.size() - kMost) + 1 : 0;
    std::printf("%s\n", log.c_str() + from);
  }

  void be_ready() {
    if (!daemon_) {
      start_daemon();
      daemon_->listener().arm();
    }
    if (!eventually([&] { return status().state() == v1::ARMED; })) {
      fail("the daemon is not armed again");
    }
  }

  /// As systemd does: again, while the digitiser that was dropped refuses connections.
  void start_daemon() {
    for (int attempt = 0; !daemon_; ++attempt) {
      try {
        daemon_ = std::make_unique<DaemonProcess>(installation_);
      } catch (const std::runtime_error&) {
        if (attempt == 10) {
          throw;
        }
      }
    }
  }

  [[nodiscard]] v1::Status status() { return daemon_->listener().control().status(); }

  [[nodiscard]] Losses losses() {
    const v1::Status now = status();
    return {.withheld =
                lab_.attribute("injected_lost_samples") + lab_.attribute("overrun_lost_samples"),
            .counted = static_cast<std::int64_t>(now.samples_missing()),
            .unknown_gaps = static_cast<std::int64_t>(now.gaps_of_unknown_length())};
  }

  void fire() {
    before_ = losses();
    reconnects_before_ = status().reconnects();
    overruns_before_ = lab_.attribute("overrun_lost_samples");
    daemon_->listener().control().fire();
    if (lab_.attribute("shots_fired") != static_cast<std::int64_t>(number_)) {
      fail("was not the shot that was fired");
    }
  }

  void follow(const Planned& plan) {
    const auto result = daemon_->listener().next_message<v1::Result>("result");
    if (!result && lab_.attribute("overrun_lost_samples") != overruns_before_) {
      // The digitiser's own queue ran over on a busy machine; the pulse was in the hole.
      ++in_a_hole_;
      check_losses();
      return;
    }
    if (!result) {
      fail("has no result");
      return;
    }
    known_.insert(result->shot_id());
    ++stored_;
    check_stored(plan, *result);
    if (plan.fault.starts_with("drop")) {
      await_reconnection();
    } else if (status().reconnects() != reconnects_before_) {
      fail("made the digitiser drop out");
    }
    check_losses();
  }

  void check_stored(const Planned& plan, const v1::Result& result) {
    const StoreLayout store{installation_.store()};
    const std::filesystem::path capture = store.capture_of(result.shot_id());
    if (!eventually([&] { return std::filesystem::exists(capture); })) {
      fail("is not stored");
      return;
    }
    const Shot shot = read_capture(capture);
    std::int64_t missing = 0;
    for (const Gap& gap : shot.gaps) {
      missing += gap.samples;
    }
    const bool overrun = lab_.attribute("overrun_lost_samples") != overruns_before_;
    if (!overrun && missing != plan.lost_in_window) {
      fail("has " + std::to_string(missing) + " samples missing, not " +
           std::to_string(plan.lost_in_window));
    }
    if (result.quality().reducible() != plan.reducible && !overrun) {
      fail(plan.reducible ? "is not reducible: " + result.quality().reason()
                          : "should not be reducible");
    }
    if (!result.quality().reducible()) {
      ++not_reducible_;
    }
  }

  void await_reconnection() {
    const auto before = reconnects_before_;
    if (!eventually([&] { return status().reconnects() > before; })) {
      fail("the digitiser was not reached again");
    }
  }

  /// The last of what was withheld may still be on its way.
  void check_losses() {
    Losses now;
    const bool equal = eventually(
        [&] {
          now = losses();
          return now.counted - before_.counted == now.withheld - before_.withheld ||
                 now.unknown_gaps != before_.unknown_gaps;
        },
        milliseconds(3000));
    if (!equal) {
      fail("counted " + std::to_string(now.counted - before_.counted) + " lost samples of " +
           std::to_string(now.withheld - before_.withheld));
    }
    counted_ += now.counted - before_.counted;
    withheld_ += now.withheld - before_.withheld;
    unknown_gaps_ += now.unknown_gaps - before_.unknown_gaps;
  }

  void kill_and_recover(const Planned& plan) {
    std::this_thread::sleep_for(plan.kill_after);
    daemon_->process().signal(SIGKILL);
    daemon_->process().wait(milliseconds(5000));
    ++kills_;
    const bool announced = was_announced();
    daemon_.reset();
    if (plan.killed_at_start) {
      kill_at_start(plan.start_lasts);
    }
    be_ready();
    std::set<std::string> fresh;
    const v1::ShotList list = daemon_->listener().control().list_shots();
    for (const v1::ShotSummary& shot : list.shots()) {
      if (known_.insert(shot.id()).second) {
        fresh.insert(shot.id());
      }
    }
    if (fresh.size() > 1) {
      fail("became " + std::to_string(fresh.size()) + " shots");
    } else if (fresh.size() == 1) {
      ++stored_;
      ++stored_in_spite_;
    } else if (announced) {
      fail("was announced and is not stored");
    } else {
      ++cut_;
    }
  }

  void kill_at_start(milliseconds after) {
    scene::Process recovering(scene::kolskyd({"--config", installation_.write().string()}),
                              installation_.folder() / "output-of-start");
    std::this_thread::sleep_for(after);
    recovering.signal(SIGKILL);
    recovering.wait(milliseconds(5000));
    ++kills_;
  }

  /// Whether the killed daemon has published a shot that was not known before.
  bool was_announced() {
    bool announced = false;
    while (const auto shot = daemon_->listener().next_message<v1::Shot>("shot", milliseconds(50))) {
      announced = announced || !known_.contains(shot->id());
    }
    return announced;
  }

  void finish() {
    daemon_->process().signal(SIGTERM);
    if (daemon_->process().wait(milliseconds(15'000)) != 0) {
      fail("was the last, and the daemon did not end well");
    }
    const StoreReport report = verify_store({installation_.store()});
    for (const StoreReport::Problem& problem : report.problems) {
      fail(problem.file + ": " + problem.text);
    }
    if (report.captures != stored_) {
      fail("was the last: " + std::to_string(stored_) + " shots, " +
           std::to_string(report.captures) + " captures");
    }
    // Journals that were ended have been read back and removed, in the run or at the next start.
    if (report.journals != 1) {
      fail("was the last: " + std::to_string(report.journals) + " journals are left");
    }
  }

  void report() const {
    std::printf(
        "%zu shots fired: %zu stored (%zu of them not reducible, as they should be), "
        "%zu cut by a kill before they were announced\n",
        shots_.size(), stored_, not_reducible_, cut_);
    if (in_a_hole_ != 0) {
      std::printf(
          "%zu fell into samples that the simulated digitiser lost by itself, counted below; "
          "the machine is too busy\n",
          in_a_hole_);
    }
    std::printf("%zu kills, %zu shots stored in spite of one\n", kills_, stored_in_spite_);
    std::printf(
        "samples withheld by the digitiser %lld, counted as missing %lld, gaps of unknown "
        "length %lld\n",
        static_cast<long long>(withheld_), static_cast<long long>(counted_),
        static_cast<long long>(unknown_gaps_));
    std::printf("%zu failures\n", failures_);
  }

  std::vector<Planned> shots_;
  Lab lab_;
  Installation installation_;
  std::unique_ptr<DaemonProcess> daemon_;
  std::set<std::string> known_;
  Losses before_;
  std::int64_t overruns_before_ = 0;
  std::uint64_t reconnects_before_ = 0;
  std::size_t number_ = 0;
  std::size_t stored_ = 0;
  std::size_t stored_in_spite_ = 0;
  std::size_t not_reducible_ = 0;
  std::size_t cut_ = 0;
  std::size_t in_a_hole_ = 0;
  std::size_t kills_ = 0;
  std::size_t failures_ = 0;
  std::int64_t counted_ = 0;
  std::int64_t withheld_ = 0;
  std::int64_t unknown_gaps_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Fires shots at a faulty simulated digitiser, kills the daemon at random, and accounts "
      "for every shot and every lost sample.",
      "soak");
  Options options;
  app.add_option("--shots", options.shots, "how many")->capture_default_str();
  app.add_option("--seed", options.seed, "of faults and kills")->capture_default_str();
  app.add_option("--kill", options.kill_share, "share of the shots at which the daemon is killed")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  signal(SIGPIPE, SIG_IGN);
  return Soak(options).run() ? 0 : 1;
}
