#include "daemon/shots/recorder.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "daemon/config.hpp"
#include "daemon/shots/shot_context.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "tests/scratch_folder.hpp"
#include "tests/unit/daemon/scripted_digitiser.hpp"
#include "tests/unit/daemon/strain_bench.hpp"

namespace kolsky {
namespace {

PublisherOptions free_ports() {
  PublisherOptions options;
  options.results_endpoint = "tcp://127.0.0.1:*";
  options.preview_endpoint = "tcp://127.0.0.1:*";
  return options;
}

StoreLayout store_in(const std::filesystem::path& folder) {
  StoreLayout store{folder};
  store.create();
  return store;
}

/// The recorder with all its real neighbours; the test writes the ring and the events itself.
class RecorderTest : public ::testing::Test {
 protected:
  explicit RecorderTest(std::uint64_t journal_limit_bytes = 1U << 30U)
      : journal_(store_, publisher_.boot_id(), journal_limit_bytes) {
    Apparatus apparatus;
    apparatus.bench_toml = kStrainBench;
    apparatus.bench = parse_bench(kStrainBench, "bench.toml");
    DaemonConfig config;
    config.bench = "bench.toml";
    auto settings = std::make_shared<ShotSettings>();
    settings->blank = blank_shot(config, apparatus, digitiser_.info());
    settings->pre_samples = 100;
    settings->post_samples = 900;
    recorder_ =
        std::make_unique<ShotRecorder>(ShotRecorder::Parts{ring_, events_, acquirer_, journal_,
                                                           archivist_, publisher_, store_, false},
                                       settings);
    archivist_.start();
    recorder_->start();
  }
  ~RecorderTest() override { finish(); }

  void finish() {
    events_.close();
    recorder_->stop();
    archivist_.stop();
  }
  /// Codes from the scripted digitiser into the ring.
  void fill(std::size_t samples) {
    digitiser_.deliver(samples);
    std::vector<RunStatistics> statistics(ScriptedDigitiser::kChannels);
    Block block;
    for (std::size_t done = 0; done < samples; done += block.samples) {
      ASSERT_EQ(digitiser_.read(block), ReadStatus::samples);
      ring_.write(block, statistics);
    }
  }
  void window(Tick first, Tick end) {
    AcquisitionEvent event;
    event.kind = AcquisitionEvent::Kind::window;
    event.window.trigger.tick = first + 100;
    event.window.first_tick = first;
    event.window.end_tick = end;
    ASSERT_TRUE(events_.push(event));
  }
  [[nodiscard]] v1::Snapshot snapshot() const {
    v1::Snapshot snapshot;
    publisher_.snapshot(snapshot);
    return snapshot;
  }

  ScriptedDigitiser digitiser_;
  SampleRing ring_{SampleFormat::int16, ScriptedDigitiser::kChannels, 4096};
  AcquisitionQueue events_;
  AcquisitionPlan plan_{.trigger = TriggerOptions::for_rate(1e6)};
  Acquirer acquirer_{digitiser_, ring_, events_, plan_};
  testing::ScratchFolder folder_;
  StoreLayout store_ = store_in(folder_.path());
  Publisher publisher_{free_ports()};
  SharedJournal journal_;
  std::vector<std::string> faults_;
  Archivist archivist_{store_, journal_,
                       [this](const std::string& text) { faults_.push_back(text); }};
  std::unique_ptr<ShotRecorder> recorder_;
};

TEST_F(RecorderTest, RecordsAWindow) {
  fill(2048);
  window(512, 1512);
  finish();
  EXPECT_EQ(recorder_->counters().shots_journaled, 1U);
  EXPECT_EQ(archivist_.stored(), 1U);
  const Shot shot = read_capture(store_.capture_of(recorder_->last_shot_id()));
  ASSERT_EQ(shot.samples(), 1000U);
  for (std::size_t k = 0; k < 1000; ++k) {
    ASSERT_EQ(shot.channels[1].codes[k], digitiser_.code(1, static_cast<Tick>(512 + k)));
  }
  EXPECT_EQ(snapshot().last_shot().id(), shot.id);
  EXPECT_EQ(snapshot().last_result().shot_id(), shot.id);
  EXPECT_TRUE(faults_.empty());
}

TEST_F(RecorderTest, CountsAndTellsAWindowThatTheRingHasLost) {
  fill(8192);
  window(512, 1512);
  window(6000, 7000);
  finish();
  EXPECT_EQ(recorder_->counters().ring_overruns, 1U);
  EXPECT_EQ(recorder_->counters().shots_journaled, 1U);
  EXPECT_EQ(archivist_.stored(), 1U);
  EXPECT_EQ(snapshot().last_fault().kind(), "ring-overrun");
  EXPECT_EQ(snapshot().last_fault().tick(), 612);
}

TEST_F(RecorderTest, PutsTheHolesOfTheWindowIntoTheShot) {
  fill(2048);
  AcquisitionEvent hole;
  hole.kind = AcquisitionEvent::Kind::gap;
  hole.gap = {.first_tick = 600, .samples = 7, .known = true};
  ASSERT_TRUE(events_.push(hole));
  window(512, 1512);
  window(1000, 2000);
  finish();
  const std::vector<std::filesystem::path> captures = captures_in(store_.shots());
  ASSERT_EQ(captures.size(), 2U);
  EXPECT_EQ(read_capture(captures[0]).gaps, std::vector<Gap>{hole.gap});
  EXPECT_TRUE(read_capture(captures[1]).gaps.empty());
}

/// Files of this process end at a size, as on a disk that is nearly full.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

/// A record has 17 kB here: a journal takes three.
class ShortJournalTest : public RecorderTest {
 protected:
  static constexpr std::uint64_t kLimit_bytes = 50'000;
  ShortJournalTest() : RecorderTest(kLimit_bytes) {}
};

TEST_F(ShortJournalTest, RemovesJournalsWhoseShotsAreStored) {
  constexpr std::size_t kShots = 40;
  fill(4096);
  for (std::size_t i = 0; i < kShots; ++i) {
    window(0, 4096);
  }
  finish();
  EXPECT_EQ(archivist_.stored(), kShots);
  EXPECT_TRUE(faults_.empty()) << faults_.front();
  const StoreReport report = verify_store(store_);
  EXPECT_TRUE(report.problems.empty());
  EXPECT_EQ(report.captures, kShots);
  EXPECT_EQ(report.journals, 1U) << "the one that is open";
  EXPECT_LE(report.journaled_shots, 3U);
}

TEST_F(ShortJournalTest, KeepsTheJournalOfAShotThatCouldNotBeStored) {
  fill(4096);
  std::filesystem::rename(store_.shots(), store_.root / "elsewhere");
  for (std::size_t i = 0; i < 10; ++i) {
    window(0, 4096);
  }
  finish();
  EXPECT_EQ(archivist_.failed(), 10U);
  std::filesystem::rename(store_.root / "elsewhere", store_.shots());
  EXPECT_EQ(recover_store(store_, DoneJournals::keep).recovered.size(), 10U);
}

class FullJournalTest : public RecorderTest {
 protected:
  static constexpr std::uint64_t kShots = 90;

  /// Records more shots than the journal takes: a record has 17 kB, so that it is past this size
  /// after 70 shots. A capture is written in steps of a megabyte.
  void record_beyond_the_limit() {
    const FileSizeLimit limit(1'200'000);
    for (std::uint64_t i = 0; i < kShots; ++i) {
      window(0, 4096);
    }
    finish();
  }
};

TEST_F(FullJournalTest, GoesOnInAnotherJournal) {
  fill(4096);
  record_beyond_the_limit();
  EXPECT_EQ(recorder_->counters().shots_journaled, kShots);
  EXPECT_EQ(recorder_->counters().journal_failures, 0U);
  std::size_t journaled = 0;
  std::size_t journals = 0;
  for (const auto& file : std::filesystem::directory_iterator(store_.journals())) {
    const JournalContents contents = read_journal(file.path());
    journaled += contents.shots.size();
    EXPECT_TRUE(contents.problems.empty());
    ++journals;
  }
  EXPECT_EQ(journaled, kShots);
  EXPECT_EQ(journals, 2U);
}

TEST_F(FullJournalTest, PublishesNothingThatIsNotDurableAndStillTriesToFileIt) {
  fill(4096);
  // No other journal can be made either.
  std::filesystem::rename(store_.journals(), store_.root / "elsewhere");
  record_beyond_the_limit();
  const ShotRecorder::Counters counters = recorder_->counters();
  EXPECT_GT(counters.shots_journaled, 1U);
  EXPECT_GT(counters.journal_failures, 1U);
  EXPECT_EQ(counters.shots_journaled + counters.journal_failures, kShots);
  EXPECT_EQ(archivist_.stored(), kShots);
  EXPECT_EQ(captures_in(store_.shots()).size(), kShots);
  EXPECT_EQ(snapshot().last_fault().kind(), "store");
  EXPECT_EQ(snapshot().last_sequence().at("shot"), counters.shots_journaled);
  EXPECT_EQ(snapshot().last_sequence().at("result"), counters.shots_journaled);
}

}  // namespace
}  // namespace kolsky
