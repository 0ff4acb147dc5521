#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <thread>

#include "drivers/digitiser/open.hpp"
#include "drivers/files/captures/capture.hpp"
#include "processing/base/error.hpp"
#include "tests/conformance/pattern.hpp"
#include "tests/conformance/pattern_capture.hpp"
#include "tests/conformance/reading.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using Clock = std::chrono::steady_clock;

class Replay : public ::testing::Test {
 protected:
  void store(const Shot& shot, const std::string& name) {
    write_capture(shot, folder_.path() / name);
  }

  [[nodiscard]] std::unique_ptr<Digitiser> play(DigitiserOptions options = {}) const {
    options.block_samples = 100;
    auto digitiser = open_digitiser("replay:" + folder_.path().string(), options);
    digitiser->start();
    return digitiser;
  }

  void expect_refused(const DigitiserOptions& options,
                      const std::vector<std::string>& parts) const {
    try {
      (void)play(options);
      FAIL() << "not refused: " << parts.back();
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_TRUE(line.starts_with("replay:")) << line;
      for (const std::string& part : parts) {
        EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" is not in: " << line;
      }
    }
  }

  testing::ScratchFolder folder_;
};

/// A block's facts that outlive the next read.
struct Seen {
  Tick first_tick;
  std::size_t samples;
  Missing missing;
  bool starts_capture;
  std::optional<TriggerEvent> mark;
  std::vector<std::int32_t> codes;  ///< of channel 1
};

std::vector<Seen> play_all(Digitiser& digitiser) {
  std::vector<Seen> seen;
  const ReadStatus end = read_while(digitiser, [&](const Block& block) {
    Seen one{block.first_tick,     block.samples, block.missing_before,
             block.starts_capture, block.mark,    {}};
    for (std::size_t i = 0; i < block.samples; ++i) {
      one.codes.push_back(code_at(digitiser.info(), block, 1, i));
    }
    seen.push_back(one);
    return true;
  });
  EXPECT_EQ(end, ReadStatus::end_of_capture);
  return seen;
}

TEST_F(Replay, PlaysAFolderByNameAndSaysWhereEachCaptureBegins) {
  store(pattern_shot(250, 150), "b.h5");
  store(pattern_shot(0, 250), "a.h5");
  store(pattern_shot(9000, 80), "c.h5");
  const auto digitiser = play();
  const std::vector<Seen> seen = play_all(*digitiser);
  const std::vector<Tick> first{0, 100, 200, 250, 350, 400};
  const std::vector<std::size_t> samples{100, 100, 50, 100, 50, 80};
  ASSERT_EQ(seen.size(), first.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].first_tick, first[i]);
    EXPECT_EQ(seen[i].samples, samples[i]);
    const bool begins = i == 0 || i == 3 || i == 5;
    EXPECT_EQ(seen[i].starts_capture, begins);
    EXPECT_EQ(seen[i].missing.kind, begins && i > 0 ? Missing::Kind::unknown : Missing::Kind::none);
    EXPECT_FALSE(seen[i].mark);
  }
  EXPECT_EQ(seen[3].codes.front(), pattern_code(1, 250));
  EXPECT_EQ(seen[5].codes.back(), pattern_code(1, 9079));
}

TEST_F(Replay, ACaptureThatHasGoneIsWaitedForThenPassedOver) {
  store(pattern_shot(0, 250), "a.h5");
  store(pattern_shot(250, 150), "b.h5");
  store(pattern_shot(9000, 80), "c.h5");
  std::vector<std::string> told;
  DigitiserOptions options;
  options.replay_patience = std::chrono::milliseconds(30);
  options.tell = [&](const std::string& text) { told.push_back(text); };
  const auto digitiser = play(options);
  std::filesystem::remove(folder_.path() / "b.h5");
  Tick end = 0;
  const auto follow = [&](const Block& block) {
    end = block.first_tick + static_cast<Tick>(block.samples);
    return true;
  };
  EXPECT_EQ(read_while(*digitiser, follow), ReadStatus::disconnected);
  EXPECT_EQ(end, 250);
  EXPECT_FALSE(digitiser->reconnect());
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  EXPECT_TRUE(digitiser->reconnect());
  const std::vector<Seen> seen = play_all(*digitiser);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].first_tick, 400);  // where the list of captures has it
  EXPECT_EQ(seen[0].codes.back(), pattern_code(1, 9079));
  ASSERT_EQ(told.size(), 2U);
  EXPECT_NE(told[0].find("b.h5"), std::string::npos);
  EXPECT_NE(told[1].find("passed over"), std::string::npos);
}

TEST_F(Replay, ASubFolderAndOtherFilesAreNotPlayed) {
  store(pattern_shot(0, 10), "a.h5");
  std::filesystem::create_directory(folder_.path() / "more");
  write_capture(pattern_shot(0, 10), folder_.path() / "more" / "b.h5");
  std::filesystem::copy(folder_.path() / "a.h5", folder_.path() / "a.h5.part");
  EXPECT_EQ(play_all(*play()).size(), 1U);
}

TEST_F(Replay, TheStoredTriggerMarksTheBlockThatHoldsIt) {
  store(pattern_shot(0, 250), "a.h5");
  Shot second = pattern_shot(0, 300);
  second.trigger = TriggerEvent{second.first_tick + 200, 0.25, 0.125, TriggerKind::incident};
  store(second, "b.h5");
  const std::vector<Seen> seen = play_all(*play());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].mark.has_value(), i == 5);
  }
  EXPECT_EQ(seen.at(5).first_tick, 450);
  EXPECT_EQ(*seen.at(5).mark, (TriggerEvent{450, 0.25, 0.125, TriggerKind::marked}));
}

TEST_F(Replay, KnownGapsAreSkippedAndCounted) {
  Shot shot = pattern_shot(0, 300);
  make_gap(shot, shot.first_tick + 30, 20);
  make_gap(shot, shot.first_tick + 50, 5);  // follows at once
  make_gap(shot, shot.first_tick + 290, 10);
  store(shot, "a.h5");
  const std::vector<Seen> seen = play_all(*play());
  const std::vector<Tick> first{0, 55, 155, 255};
  const std::vector<std::size_t> samples{30, 100, 100, 35};
  ASSERT_EQ(seen.size(), first.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].first_tick, first[i]);
    EXPECT_EQ(seen[i].samples, samples[i]);
    EXPECT_EQ(seen[i].missing.samples, i == 1 ? 25 : 0);
    EXPECT_EQ(seen[i].missing.kind, i == 1 ? Missing::Kind::known : Missing::Kind::none);
    for (std::size_t k = 0; k < seen[i].samples; ++k) {
      ASSERT_EQ(seen[i].codes[k], pattern_code(1, seen[i].first_tick + static_cast<Tick>(k)));
    }
  }
}

TEST_F(Replay, UnknownGapsAreToldAndTakeNoTime) {
  Shot shot = pattern_shot(0, 200);
  shot.gaps.push_back({shot.first_tick + 60, 0, false});
  store(shot, "a.h5");
  const std::vector<Seen> seen = play_all(*play());
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[1].first_tick, 60);
  EXPECT_EQ(seen[1].missing.kind, Missing::Kind::unknown);
  EXPECT_EQ(seen[1].missing.samples, 0);
  EXPECT_EQ(seen[2].missing.kind, Missing::Kind::none);
}

TEST_F(Replay, AMarkInAGapComesWithTheNextBlock) {
  Shot shot = pattern_shot(0, 200);
  make_gap(shot, shot.first_tick + 40, 20);
  shot.trigger = TriggerEvent{shot.first_tick + 50, 0.0, 0.5, TriggerKind::forced};
  store(shot, "a.h5");
  const std::vector<Seen> seen = play_all(*play());
  EXPECT_FALSE(seen.at(0).mark);
  ASSERT_TRUE(seen.at(1).mark);
  EXPECT_EQ(seen[1].mark->tick, 50);
}

TEST_F(Replay, AFactorMakesItFaster) {
  store(pattern_shot(0, 400'000), "a.h5");
  DigitiserOptions options;
  options.replay_speed = 4.0;
  const auto digitiser = play(options);
  const auto begin = Clock::now();
  play_all(*digitiser);
  const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
  EXPECT_GT(took_s, 0.095);
  EXPECT_LT(took_s, 0.25);
}

TEST_F(Replay, WideConvertersAreDeliveredInThirtyTwoBits) {
  Shot shot = pattern_shot(0, 100);
  for (ChannelRecord& channel : shot.channels) {
    channel.bits = 24;
    channel.code_min = -8'388'608;
    channel.code_max = 8'388'607;
  }
  shot.channels[1].codes[7] = -8'000'000;
  store(shot, "a.h5");
  const auto digitiser = play();
  EXPECT_EQ(digitiser->info().format, SampleFormat::int32);
  EXPECT_EQ(play_all(*digitiser)[0].codes[7], -8'000'000);
}

TEST_F(Replay, TellsWhatTheCapturesAre) {
  store(pattern_shot(0, 100), "a.h5");
  const auto digitiser = play();
  const StreamInfo& info = digitiser->info();
  EXPECT_EQ(info.channels.at(0).name, "g1");
  EXPECT_EQ(info.channels.at(1).name, "g2");
  EXPECT_EQ(info.channels.at(1).scale, 2.0 / 4096.0);
  EXPECT_EQ(info.channels.at(1).offset, 4.0);
  EXPECT_EQ(info.rate, (SampleRate{1'000'000, 1}));
  EXPECT_TRUE(info.ends);
  EXPECT_FALSE(info.simulated);
}

TEST_F(Replay, ChannelsAreChosenByGauge) {
  store(pattern_shot(0, 100), "a.h5");
  DigitiserOptions options;
  options.channels = {"g2", "g1"};
  const auto digitiser = play(options);
  EXPECT_EQ(digitiser->info().channels.at(0).name, "g2");
  EXPECT_EQ(play_all(*digitiser)[0].codes[9], pattern_code(0, 9));
  options.channels = {"g3"};
  expect_refused(options, {"a.h5", "g3", "g1, g2"});
  options.channels = {};
  options.channel_count = 3;
  expect_refused(options, {"a.h5", "2 channels", "3 gauges"});
}

TEST_F(Replay, WithoutNamesChannelsFollowTheBenchsGauges) {
  store(pattern_shot(0, 10), "a.h5");
  DigitiserOptions options;
  options.channel_count = 2;
  options.gauges = {"g2", "g1"};
  EXPECT_EQ(play(options)->info().channels.at(0).name, "g2");
  options.gauges = {"in", "out"};  // names that say nothing of each other: by their place
  EXPECT_EQ(play(options)->info().channels.at(0).name, "g1");
  options.gauges = {"g1", "out"};
  expect_refused(options, {"a.h5", "g1, g2", "digitiser.channels"});
}

TEST_F(Replay, TellsWhatIsFiledWithEachCaptureAndWhereItStands) {
  Shot first = pattern_shot(0, 10);
  first.id = "first";
  first.meta = {{"specimen_id", "ball7"}};
  Shot second = pattern_shot(50, 20);
  second.id = "second";
  store(first, "a.h5");
  store(second, "b.h5");
  const std::vector<PlayedCapture> captures = play()->info().captures;
  ASSERT_EQ(captures.size(), 2U);
  EXPECT_EQ(captures[0].id, "first");
  EXPECT_EQ(captures[0].meta, first.meta);
  EXPECT_EQ(captures[0].bench_toml, first.bench_toml);
  EXPECT_EQ(captures[1].id, "second");
  EXPECT_EQ(captures[1].first_tick, 10);
  EXPECT_EQ(captures[1].samples, 20U);
}

TEST_F(Replay, TheOddCaptureOfAFolderIsNamed) {
  store(pattern_shot(0, 100), "a.h5");
  store(pattern_shot(0, 100), "b.h5");
  struct Case {
    std::function<void(Shot&)> change;
    const char* says;
  };
  const Case cases[] = {
      {[](Shot& shot) {
         shot.rate = {1'000'001, 1};
       },
       "rate"},
      {[](Shot& shot) { shot.channels[1].scale *= 1 + 1e-12; }, "scale of channel g2"},
      {[](Shot& shot) { shot.channels[0].offset += 1; }, "scale of channel g1"},
      {[](Shot& shot) { shot.channels[0].code_max = 32766; }, "converter of channel g1"},
  };
  for (const Case& odd : cases) {
    testing::ScratchFolder keep;
    Shot shot = pattern_shot(0, 100);
    odd.change(shot);
    store(shot, "c.h5");
    expect_refused({}, {"c.h5", odd.says, "a.h5"});
    std::filesystem::rename(folder_.path() / "c.h5", keep.path() / "c.h5");
  }
}

TEST_F(Replay, AnotherBenchsUnitOrRateIsRefused) {
  store(pattern_shot(0, 100), "a.h5");
  DigitiserOptions options;
  options.units = {"V", "strain"};
  expect_refused(options, {"a.h5", "g2", "in V", "strain"});
  options.units = {"V", "V"};
  options.sampling_frequency_Hz = 0.98e6;
  expect_refused(options, {"a.h5", "1000000", "980000"});
  options.sampling_frequency_Hz = 0.995e6;  // an import's own rate, as measured
  EXPECT_NO_THROW((void)play(options));
}

TEST_F(Replay, ADamagedCaptureIsRefusedAtOpening) {
  store(pattern_shot(0, 1000), "a.h5");
  store(pattern_shot(0, 1000), "b.h5");
  const auto path = folder_.path() / "b.h5";
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  expect_refused({}, {"b.h5"});
}

TEST_F(Replay, ASpeedThatIsNoneIsRefused) {
  store(pattern_shot(0, 100), "a.h5");
  DigitiserOptions options;
  for (const double speed :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    options.replay_speed = speed;
    expect_refused(options, {"speed"});
  }
}

TEST_F(Replay, AfterTheEndNothingReconnects) {
  store(pattern_shot(0, 100), "a.h5");
  const auto digitiser = play();
  play_all(*digitiser);
  EXPECT_FALSE(digitiser->reconnect());
  Block block;
  EXPECT_EQ(digitiser->read(block), ReadStatus::end_of_capture);
}

}  // namespace
}  // namespace kolsky
