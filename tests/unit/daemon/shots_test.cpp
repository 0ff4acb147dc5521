#include <gtest/gtest.h>

#include <algorithm>

#include <filesystem>

#include "daemon/shots/gap_log.hpp"
#include "daemon/shots/loss_rate.hpp"
#include "daemon/shots/reducing_thread.hpp"
#include "daemon/shots/shared_journal.hpp"
#include "daemon/shots/shot_context.hpp"
#include "daemon/shots/shot_id.hpp"
#include "daemon/shots/store_lock.hpp"
#include "daemon/shots/summary.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/error.hpp"
#include "processing/reduction/reducer.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/daemon/strain_bench.hpp"

namespace kolsky {
namespace {

// date -u -d @1737109530 +%Y%m%dT%H%M%S
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMoment_ns = 1'737'109'530 * kSecond_ns + 123'456'789;

TEST(ShotId, TellsDateBootAndCount) {
  ShotIdSource ids(0xABCD'0123'4567'89EFULL);
  EXPECT_EQ(ids.next(kMoment_ns), "20250117T102530123Z-89ef-0001");
  EXPECT_EQ(ids.next(kMoment_ns), "20250117T102530123Z-89ef-0002");
}

TEST(ShotId, GivesItsTimeBack) {
  ShotIdSource ids(1);
  EXPECT_EQ(utc_of_shot_id(ids.next(kMoment_ns)), kMoment_ns / 1'000'000 * 1'000'000);
  EXPECT_EQ(utc_of_shot_id("20251317T102530123Z-89ef-0001"), std::nullopt) << "month 13";
  EXPECT_EQ(utc_of_shot_id("steel-7"), std::nullopt);
  EXPECT_EQ(utc_of_shot_id(""), std::nullopt);
}

TEST(ShotId, SortsByTimeAcrossBoots) {
  ShotIdSource early(0xFFFF);
  ShotIdSource late(0x0001);
  EXPECT_LT(early.next(kMoment_ns), late.next(kMoment_ns + kSecond_ns / 100));
}

TEST(ShotId, WritesMomentsBeforeTheEpoch) {
  EXPECT_EQ(format_utc_compact(0), "19700101T000000000Z");
  EXPECT_EQ(format_utc_compact(-1'000'000), "19691231T235959999Z");
}

TEST(GapLog, FindsTheHolesThatTouchAWindow) {
  const Gap before{.first_tick = 90, .samples = 10, .known = true};
  const Gap across_begin{.first_tick = 195, .samples = 6, .known = true};
  const Gap inside{.first_tick = 250, .samples = 0, .known = false};
  const Gap across_end{.first_tick = 299, .samples = 50, .known = true};
  const Gap after{.first_tick = 400, .samples = 1, .known = true};
  GapLog log;
  for (const Gap& gap : {before, across_begin, inside, across_end, after}) {
    log.add(gap);
  }
  EXPECT_EQ(log.within(200, 300), (std::vector{across_begin, inside, across_end}));
  EXPECT_EQ(log.within(100, 195), std::vector<Gap>{});
  log.forget_before(260);
  EXPECT_EQ(log.within(0, 1000), (std::vector{across_end, after}));
}

TEST(GapLog, CountsAHoleOfUnknownLengthOnlyBetweenSamplesOfTheWindow) {
  GapLog log;
  log.add({.first_tick = 100, .samples = 0, .known = false});
  EXPECT_TRUE(log.within(100, 200).empty());
  EXPECT_TRUE(log.within(0, 100).empty());
  EXPECT_EQ(log.within(99, 101).size(), 1U);
}

TEST(GapLog, TakesHolesOffTheEndsOfAWindow) {
  const Window window{.trigger = {.tick = 250}, .first_tick = 200, .end_tick = 300};
  const auto fitted = [&](const Gap& gap) {
    GapLog log;
    log.add(gap);
    return log.without_holes_at_ends(window);
  };
  const auto known = [](Tick first, std::int64_t samples) {
    return Gap{.first_tick = first, .samples = samples, .known = true};
  };
  EXPECT_EQ(fitted(known(195, 10)).first_tick, 205);
  EXPECT_EQ(fitted(known(195, 5)).first_tick, 200);
  EXPECT_EQ(fitted(known(200, 1)).first_tick, 201);
  EXPECT_EQ(fitted(known(201, 1)).first_tick, 200);

  EXPECT_EQ(fitted(known(290, 9)).end_tick, 300);
  EXPECT_EQ(fitted(known(290, 9)).end, WindowEnd::full);
  EXPECT_EQ(fitted(known(290, 10)).end_tick, 290);
  EXPECT_EQ(fitted(known(290, 1000)).end, WindowEnd::interrupted);
  EXPECT_EQ(fitted(known(300, 1000)).end_tick, 300);
  EXPECT_EQ(fitted({.first_tick = 290, .samples = 0, .known = false}).end_tick, 300);
}

TEST(Interruption, IsAHoleBeforeOneRepeatedSample) {
  Shot shot;
  shot.first_tick = 100;
  shot.channels.resize(2);
  shot.channels[0].codes = {1, 2, 3};
  shot.channels[1].codes = {4, 5, 6};
  mark_interrupted(shot);
  EXPECT_EQ(shot.channels[0].codes, (std::vector<std::int32_t>{1, 2, 3, 3}));
  EXPECT_EQ(shot.channels[1].codes, (std::vector<std::int32_t>{4, 5, 6, 6}));
  EXPECT_EQ(shot.gaps, (std::vector{Gap{.first_tick = 103, .samples = 0, .known = false}}));
}

TEST(StoreLock, KeepsASecondDaemonOut) {
  const testing::ScratchFolder folder;
  {
    const StoreLock first(folder.path());
    EXPECT_THROW(StoreLock second(folder.path()), InputError);
  }
  EXPECT_NO_THROW(StoreLock again(folder.path()));
}

TEST(StoreLock, NamesAFolderItCannotWrite) {
  EXPECT_THROW(StoreLock lock("/nowhere/at/all"), InputError);
}

DaemonConfig some_config() {
  DaemonConfig config;
  config.file = "kolskyd.toml";
  config.bench = "bench.toml";
  config.meta["specimen"] = "a";
  return config;
}

Apparatus pmma_bench() {
  Apparatus apparatus;
  apparatus.bench_toml = kStrainBench;
  apparatus.bench = parse_bench(kStrainBench, "bench.toml");
  return apparatus;
}

StreamInfo strain_stream() {
  StreamInfo stream;
  stream.uri = "ip:somewhere";
  stream.rate = {1'000'000, 1};
  stream.channels = {{.name = "voltage0", .unit = "strain", .scale = 1e-7, .offset = -3.0},
                     {.name = "voltage1", .unit = "strain", .scale = 2e-7}};
  return stream;
}

TEST(BlankShot, JoinsBenchAndStream) {
  const Apparatus apparatus = pmma_bench();
  const Shot blank = blank_shot(some_config(), apparatus, strain_stream());
  ASSERT_EQ(blank.channels.size(), 2U);
  EXPECT_EQ(blank.channels[0].gauge, "g1");
  EXPECT_EQ(blank.channels[0].scale, 1e-7);
  EXPECT_EQ(blank.channels[0].offset, -3.0);
  EXPECT_EQ(blank.channels[1].scale, 2e-7);
  EXPECT_EQ(blank.meta.at("specimen"), "a");
  EXPECT_EQ(blank.rate, (SampleRate{1'000'000, 1}));
}

TEST(BlankShot, RefusesAStreamThatIsNotTheBenchs) {
  const Apparatus apparatus = pmma_bench();
  const DaemonConfig config = some_config();
  StreamInfo volts = strain_stream();
  volts.channels[1].unit = "V";
  EXPECT_THROW(static_cast<void>(blank_shot(config, apparatus, volts)), InputError);
  StreamInfo narrow = strain_stream();
  narrow.channels.pop_back();
  EXPECT_THROW(static_cast<void>(blank_shot(config, apparatus, narrow)), InputError);
}

TEST(RehearsalShot, TakesTheWayOfARealOne) {
  const Apparatus apparatus = pmma_bench();
  const Shot blank = blank_shot(some_config(), apparatus, strain_stream());
  const Shot shot = rehearsal_shot(blank, 400, 3600);
  EXPECT_EQ(shot.samples(), 4000U);
  for (const ChannelRecord& channel : shot.channels) {
    EXPECT_TRUE(clipped_samples(channel).empty());
  }
  const Reduction reduction = Reducer().reduce(shot);
  EXPECT_TRUE(reduction.quality.reducible) << reduction.quality.reason;
  EXPECT_FALSE(reduction.stress_Pa.empty());
}

TEST(SharedJournal, HoldsShotsAndWhatBecameOfThem) {
  const testing::ScratchFolder folder;
  const StoreLayout store{folder.path()};
  store.create();
  const Apparatus apparatus = pmma_bench();
  Shot shot = rehearsal_shot(blank_shot(some_config(), apparatus, strain_stream()), 400, 3600);
  shot.id = "one";
  SharedJournal journal(store, 0x12, 1 << 20);
  journal.write_shot(shot);
  journal.make_durable(shot);
  shot.id = "two";
  journal.write_shot(shot);
  EXPECT_FALSE(journal.holds("two")) << "a power cut could still take it";
  journal.make_durable(shot);
  EXPECT_TRUE(journal.holds("two"));
  journal.append_stored("one", store.capture_of("one"));
  const JournalContents contents = read_journal(store.journals() / "0000000000000012.kj");
  ASSERT_EQ(contents.shots.size(), 2U);
  EXPECT_EQ(contents.shots[1].id, "two");
  EXPECT_EQ(contents.shots[1].channels, shot.channels);
  ASSERT_EQ(contents.stored.size(), 1U);
  EXPECT_EQ(contents.stored[0].shot_id, "one");
}

/// Journals of a store that take one shot each.
class TurningOver : public ::testing::Test {
 protected:
  void append(const std::string& id) {
    shot_.id = id;
    journal_.write_shot(shot_);
    journal_.make_durable(shot_);
  }
  [[nodiscard]] std::vector<std::string> ids_in(const std::string& journal) const {
    std::vector<std::string> ids;
    for (const Shot& shot : read_journal(store_.journals() / journal).shots) {
      ids.push_back(shot.id);
    }
    return ids;
  }

  const testing::ScratchFolder folder_;
  const StoreLayout store_{folder_.path()};
  SharedJournal journal_{created(store_), 0x12, 1000};
  Shot shot_ = rehearsal_shot(blank_shot(some_config(), pmma_bench(), strain_stream()), 400, 3600);

 private:
  static const StoreLayout& created(const StoreLayout& store) {
    store.create();
    return store;
  }
};

TEST_F(TurningOver, BeginsAnotherFileAtTheLimit) {
  journal_.turn_over();
  append("one");
  append("two");
  journal_.turn_over();
  append("three");
  EXPECT_EQ(ids_in("0000000000000012.kj"), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(ids_in("0000000000000012-1.kj"), std::vector<std::string>{"three"});
}

TEST_F(TurningOver, NamesAJournalOnceAllOfItIsStored) {
  append("one");
  append("two");
  EXPECT_TRUE(journal_.take_done().empty()) << "it is open";
  journal_.turn_over();
  EXPECT_TRUE(journal_.take_done().empty());
  journal_.append_stored("two", store_.capture_of("two"));
  EXPECT_TRUE(journal_.take_done().empty()) << "one is not stored";
  journal_.append_stored("one", store_.capture_of("one"));
  EXPECT_EQ(journal_.take_done(), std::vector{store_.journals() / "0000000000000012.kj"});
  EXPECT_TRUE(journal_.take_done().empty());
}

TEST_F(TurningOver, KeepsAJournalWithAShotOnItsWay) {
  shot_.id = "one";
  journal_.write_shot(shot_);
  EXPECT_EQ(ids_in("0000000000000012.kj"), std::vector<std::string>{"one"})
      << "a crash from here on loses it";
  journal_.turn_over();
  EXPECT_TRUE(journal_.take_done().empty());
  journal_.make_durable(shot_);
  EXPECT_TRUE(journal_.take_done().empty());
  journal_.append_stored("one", store_.capture_of("one"));
  EXPECT_EQ(journal_.take_done(), std::vector{store_.journals() / "0000000000000012.kj"});
}

TEST_F(TurningOver, GoesOnInTheOldFileWhereNoNewOneCanBeMade) {
  append("one");
  const auto elsewhere = store_.root / "elsewhere";
  std::filesystem::rename(store_.journals(), elsewhere);
  EXPECT_THROW(journal_.turn_over(), InputError);
  append("two");
  std::filesystem::rename(elsewhere, store_.journals());
  EXPECT_EQ(ids_in("0000000000000012.kj"), (std::vector<std::string>{"one", "two"}));
}

TEST(LossRate, TellsAFloodInOneLineASecond) {
  LossRate rate;
  int told = 0;
  for (int i = 0; i < 500; ++i) {
    told += rate.tells(i * kSecond_ns / 1000, 16) ? 1 : 0;
  }
  EXPECT_EQ(told, LossRate::kMostPerSecond);
  EXPECT_FALSE(rate.kept_back(kSecond_ns / 2));
  const auto more = rate.kept_back(kSecond_ns);
  ASSERT_TRUE(more);
  EXPECT_EQ(more->losses, 500U - LossRate::kMostPerSecond);
  EXPECT_EQ(more->samples, 16U * (500U - LossRate::kMostPerSecond));
  EXPECT_FALSE(rate.kept_back(2 * kSecond_ns));
  EXPECT_TRUE(rate.tells(2 * kSecond_ns, 16));
}

TEST(CaptureAt, IsTheOneThatHoldsTheTick) {
  const std::vector<PlayedCapture> captures{
      {.id = "a", .first_tick = 0, .samples = 10, .meta = {}, .bench_toml = {}},
      {.id = "b", .first_tick = 10, .samples = 5, .meta = {}, .bench_toml = {}}};
  EXPECT_EQ(capture_at(captures, 0)->id, "a");
  EXPECT_EQ(capture_at(captures, 9)->id, "a");
  EXPECT_EQ(capture_at(captures, 10)->id, "b");
  EXPECT_EQ(capture_at({}, 10), nullptr);
}

TEST(ReducingThread, GivesEachShotItsReductionWhoeverComesFirst) {
  const Shot blank = blank_shot(some_config(), pmma_bench(), strain_stream());
  const auto whole = std::make_shared<const Shot>(rehearsal_shot(blank, 400, 3600));
  Shot cut_short = *whole;
  cut_short.channels.pop_back();
  const auto not_reducible = std::make_shared<const Shot>(cut_short);
  const std::vector<double> expected_Pa = Reducer().reduce(*whole).stress_Pa;
  ReducingThread reducing;
  for (int i = 0; i < 60; ++i) {
    reducing.begin(i % 2 == 0 ? whole : not_reducible);
    if (i % 3 == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));  // the thread comes first
    }
    const Reduction reduction = reducing.finish();
    EXPECT_EQ(reduction.quality.reducible, i % 2 == 0) << i;
    EXPECT_EQ(reduction.stress_Pa, i % 2 == 0 ? expected_Pa : std::vector<double>{}) << i;
  }
}

TEST(Summary, TakesPeaksAndVerdict) {
  Shot shot;
  shot.id = "one";
  shot.utc_ns = 5;
  Reduction reduction;
  reduction.time_s = {0.0, 1e-6, 2e-6};
  reduction.stress_Pa = {0.0, 3e6, 1e6};
  reduction.strain = {0.0, 0.01, 0.02};
  reduction.quality.reducible = true;
  const CatalogueEntry entry = summarise(shot, reduction, "one.h5");
  EXPECT_EQ(entry.verdict, "pass");
  EXPECT_EQ(entry.peak_stress_Pa, 3e6);
  EXPECT_EQ(entry.peak_strain, 0.02);
  EXPECT_EQ(entry.capture, "one.h5");
  for (std::vector<double>* history : {&reduction.stress_Pa, &reduction.strain}) {
    std::ranges::for_each(*history, [](double& value) { value = -value; });
  }
  const CatalogueEntry pulled = summarise(shot, reduction, "");
  EXPECT_EQ(pulled.peak_stress_Pa, -3e6);
  EXPECT_EQ(pulled.peak_strain, -0.02);
  const CatalogueEntry failed = summarise(shot, Reduction{}, "");
  EXPECT_EQ(failed.verdict, "fail");
  EXPECT_EQ(failed.peak_stress_Pa, 0.0);
}

}  // namespace
}  // namespace kolsky
