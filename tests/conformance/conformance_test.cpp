#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <thread>

#include "processing/base/error.hpp"
#include "tests/conformance/allocation_count.hpp"
#include "tests/conformance/pattern.hpp"
#include "tests/conformance/reading.hpp"
#include "tests/conformance/rig.hpp"

namespace kolsky {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return duration<double>(Clock::now() - start).count();
}

/// Checks each block against the pattern and the contract, whatever is lost in between.
class StreamCheck {
 public:
  explicit StreamCheck(const StreamInfo& info) : info_(info) {}

  void operator()(const Block& block) {
    ASSERT_GT(block.samples, 0U);
    ASSERT_LE(block.samples, info_.max_block_samples);
    ASSERT_EQ(block.channels.size(), info_.channels.size());
    if (block.missing_before.kind == Missing::Kind::known) {
      missing_ += block.missing_before.samples;
      EXPECT_GT(block.missing_before.samples, 0);
    } else {
      EXPECT_EQ(block.missing_before.samples, 0);
    }
    unknown_ += block.missing_before.kind == Missing::Kind::unknown ? 1 : 0;
    EXPECT_EQ(block.first_tick, next_tick_ + block.missing_before.samples);
    EXPECT_GE(block.monotonic_ns, last_ns_);
    check_codes(block);
    next_tick_ = block.first_tick + static_cast<Tick>(block.samples);
    last_ns_ = block.monotonic_ns;
  }

  [[nodiscard]] Tick next_tick() const { return next_tick_; }
  [[nodiscard]] Tick missing() const { return missing_; }
  [[nodiscard]] int unknown() const { return unknown_; }

 private:
  void check_codes(const Block& block) {
    if (!anchor_) {
      anchor_ = pattern_tick(code_at(info_, block, 0, 0)) - block.first_tick;
    }
    std::size_t wrong = 0;
    for (std::size_t channel = 0; channel < block.channels.size(); ++channel) {
      ASSERT_EQ(block.channels[channel].size(), block.samples * sample_bytes(info_.format));
      for (std::size_t i = 0; i < block.samples; ++i) {
        const Tick tick = *anchor_ + block.first_tick + static_cast<Tick>(i);
        wrong += code_at(info_, block, channel, i) == pattern_code(channel, tick) ? 0 : 1;
      }
    }
    EXPECT_EQ(wrong, 0U) << "in the block at tick " << block.first_tick;
  }

  StreamInfo info_;
  std::optional<Tick> anchor_;
  Tick next_tick_ = 0;
  Tick missing_ = 0;
  int unknown_ = 0;
  std::int64_t last_ns_ = 0;
};

struct Driver {
  const char* name;
  std::unique_ptr<Rig> (*make)();
};

class DigitiserContract : public testing::TestWithParam<Driver> {
 protected:
  std::unique_ptr<Rig> rig_ = GetParam().make();
};

TEST_P(DigitiserContract, TellsWhatItIs) {
  const auto digitiser = rig_->open(1.0);
  const StreamInfo& info = digitiser->info();
  EXPECT_FALSE(info.uri.empty());
  EXPECT_FALSE(info.description.empty());
  EXPECT_EQ(info.rate, (SampleRate{1'000'000, 1}));
  EXPECT_EQ(info.format, SampleFormat::int16);
  EXPECT_EQ(info.max_block_samples, Rig::kBlockSamples);
  EXPECT_EQ(info.simulated, rig_->simulated());
  EXPECT_EQ(info.ends, !rig_->simulated());
  ASSERT_EQ(info.channels.size(), Rig::kChannels);
  for (std::size_t i = 0; i < Rig::kChannels; ++i) {
    EXPECT_FALSE(info.channels[i].name.empty());
    EXPECT_EQ(info.channels[i].unit, "V");
    EXPECT_EQ(info.channels[i].bits, 16);
    EXPECT_EQ(info.channels[i].code_min, -32768);
    EXPECT_EQ(info.channels[i].code_max, 32767);
  }
}

TEST_P(DigitiserContract, CodesBecomeTheVoltsThatWereThere) {
  const auto digitiser = rig_->open(0.0);
  const StreamInfo info = digitiser->info();
  digitiser->start();
  Block block;
  ASSERT_TRUE(next_block(*digitiser, block));
  const Tick anchor = pattern_tick(code_at(info, block, 0, 0));
  for (std::size_t channel = 0; channel < Rig::kChannels; ++channel) {
    const ChannelInfo& how = info.channels[channel];
    for (std::size_t i = 0; i < block.samples; ++i) {
      const double volts = (code_at(info, block, channel, i) + how.offset) * how.scale;
      const double there =
          (pattern_code(channel, anchor + static_cast<Tick>(i)) + Rig::kOffset[channel]) *
          Rig::kScale_V[channel];
      ASSERT_DOUBLE_EQ(volts, there);
    }
  }
}

TEST_P(DigitiserContract, TicksRunOnFromZeroInBlocksOfAtMostTheSizeAnnounced) {
  const auto digitiser = rig_->open(0.0);
  StreamCheck check(digitiser->info());
  digitiser->start();
  read_while(*digitiser, [&](const Block& block) {
    check(block);
    return check.next_tick() < 200'000;
  });
  EXPECT_GE(check.next_tick(), 200'000);
  EXPECT_EQ(check.missing(), 0);
}

TEST_P(DigitiserContract, TwoSecondsAtTheRealRateLoseNothing) {
#ifdef KOLSKY_SANITIZED
  GTEST_SKIP() << "a sanitizer's program is too slow for real time";
#endif
  const auto digitiser = rig_->open(1.0, 2'000'000);
  StreamCheck check(digitiser->info());
  const auto begin = Clock::now();
  digitiser->start();
  const ReadStatus end = read_while(*digitiser, [&](const Block& block) {
    check(block);
    return check.next_tick() < 2'000'000;
  });
  const double took_s = seconds_since(begin);
  EXPECT_EQ(end, ReadStatus::samples);
  EXPECT_EQ(check.missing(), 0);
  EXPECT_GT(took_s, 1.99);
  EXPECT_LT(took_s, 2.3);
}

TEST_P(DigitiserContract, ReadAllocatesNothing) {
  const auto digitiser = rig_->open(0.0);
  digitiser->start();
  Block block;
  block.channels.reserve(Rig::kChannels);
  const std::uint64_t before = allocations_of_this_thread();
  for (int i = 0; i < 90; ++i) {  // within a capture: opening the next one does allocate
    ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  }
  EXPECT_EQ(allocations_of_this_thread() - before, 0U);
}

TEST_P(DigitiserContract, TimesOutWithinASecondOrSoAndCanBeReadAgain) {
  const auto digitiser = rig_->open(1e-7);
  digitiser->start();
  Block block;
  for (int i = 0; i < 2; ++i) {
    const auto begin = Clock::now();
    EXPECT_EQ(digitiser->read(block), ReadStatus::timeout);
    EXPECT_LT(seconds_since(begin), 1.5);
    EXPECT_GT(seconds_since(begin), 0.05) << "a caller that reads again must not spin";
  }
}

TEST_P(DigitiserContract, CancelEndsAWaitingReadSoonAndForGood) {
  const auto digitiser = rig_->open(1e-7);
  digitiser->start();
  Clock::time_point cancelled;
  std::thread canceller([&] {
    std::this_thread::sleep_for(milliseconds(100));
    cancelled = Clock::now();
    digitiser->cancel();
  });
  Block block;
  const ReadStatus status = digitiser->read(block);
  const auto returned = Clock::now();
  canceller.join();
  EXPECT_EQ(status, ReadStatus::disconnected);
  EXPECT_GE(returned, cancelled);
  // A reader may have to be woken on a machine that is busy; its own timeout is a second.
  EXPECT_LT(duration<double>(returned - cancelled).count(), 0.4);
  EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected);
  EXPECT_FALSE(digitiser->reconnect());
  EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected);
}

TEST_P(DigitiserContract, AHoleIsAnnouncedCountedAndTakesItsTime) {
  const auto digitiser = rig_->open_with_hole();
  StreamCheck check(digitiser->info());
  digitiser->start();
  read_while(*digitiser, [&](const Block& block) {
    check(block);
    return check.next_tick() < 20'000;
  });
  ASSERT_EQ(check.missing(), 0);
  rig_->make_hole();
  int overflows = 0;
  Block block;
  for (int i = 0; i < 1000 && check.missing() == 0; ++i) {
    const ReadStatus status = digitiser->read(block);
    overflows += status == ReadStatus::overflow ? 1 : 0;
    if (status == ReadStatus::samples) {
      check(block);
      EXPECT_EQ(overflows > 0, rig_->announces_holes() && check.missing() > 0);
    }
  }
  EXPECT_GT(check.missing(), 0);
  EXPECT_EQ(check.unknown(), 0);
  if (rig_->hole_samples() != 0) {
    EXPECT_EQ(check.missing(), rig_->hole_samples());
  }
  read_while(*digitiser, [&](const Block& after) {
    check(after);
    return check.next_tick() < Rig::kSamples;
  });
}

TEST_P(DigitiserContract, TicksGoOnAfterADisconnection) {
  const auto digitiser = rig_->open_to_break();
  StreamCheck check(digitiser->info());
  digitiser->start();
  read_while(*digitiser, [&](const Block& block) {
    check(block);
    return check.next_tick() < 20'000;
  });
  rig_->break_off();
  const auto take = [&](const Block& block) {
    check(block);
    return true;
  };
  ASSERT_EQ(read_while(*digitiser, take), ReadStatus::disconnected);
  Block block;
  EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected);
  EXPECT_FALSE(digitiser->reconnect());
  EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected);
  rig_->mend();
  ASSERT_TRUE(comes_back(*digitiser));
  const Tick before = check.next_tick();
  ASSERT_TRUE(next_block(*digitiser, block));
  EXPECT_NE(block.missing_before.kind, Missing::Kind::none);
  check(block);
  EXPECT_GT(check.next_tick(), before);
  read_while(*digitiser, [&](const Block& after) {
    check(after);
    return check.next_tick() < before + 20'000;
  });
  EXPECT_GE(check.next_tick(), before + 20'000);
}

TEST_P(DigitiserContract, AnEndIsReachedIfAnnouncedAndStays) {
  const auto digitiser = rig_->open(0.0);
  digitiser->start();
  Tick samples = 0;
  const ReadStatus end = read_while(*digitiser, [&](const Block& block) {
    samples += static_cast<Tick>(block.samples);
    return samples < 2 * Rig::kSamples;
  });
  if (!digitiser->info().ends) {
    EXPECT_EQ(end, ReadStatus::samples);
    return;
  }
  EXPECT_EQ(end, ReadStatus::end_of_capture);
  EXPECT_EQ(samples, Rig::kSamples);
  Block block;
  EXPECT_EQ(digitiser->read(block), ReadStatus::end_of_capture);
  EXPECT_EQ(digitiser->read(block), ReadStatus::end_of_capture);
}

TEST_P(DigitiserContract, OnlyASimulatedDigitiserFires) {
  const auto digitiser = rig_->open(1.0);
  digitiser->start();
  if (rig_->simulated()) {
    EXPECT_NO_THROW(digitiser->fire());
  } else {
    EXPECT_THROW(digitiser->fire(), InputError);
  }
}

TEST_P(DigitiserContract, ReadsNothingBeforeItIsStarted) {
  const auto digitiser = rig_->open(1.0);
  Block block;
  EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected);
}

INSTANTIATE_TEST_SUITE_P(Drivers, DigitiserContract,
                         testing::Values(Driver{"iio", make_iio_rig},
                                         Driver{"replay_of_a_capture", make_capture_rig},
                                         Driver{"replay_of_a_folder", make_folder_rig}),
                         [](const auto& driver) { return std::string(driver.param.name); });

}  // namespace
}  // namespace kolsky
