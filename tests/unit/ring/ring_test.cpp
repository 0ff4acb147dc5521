#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "daemon/acquisition/sample_ring.hpp"
#include "processing/base/error.hpp"
#include "tests/unit/trigger/counted_allocations.hpp"

namespace kolsky {
namespace {

using CopyStatus = SampleRing::CopyStatus;

template <class Code>
constexpr SampleFormat kFormat = sizeof(Code) == 2 ? SampleFormat::int16 : SampleFormat::int32;

/// A code that tells channel and tick apart from their neighbours.
template <class Code>
Code code_at(std::size_t channel, Tick tick) {
  const auto mixed = (static_cast<std::uint64_t>(tick) + 977 * channel) * 0x9E3779B97F4A7C15ULL;
  return static_cast<Code>(mixed >> 40);
}

template <class Code>
struct Stream {
  explicit Stream(std::size_t channel_count) : codes(channel_count), statistics(channel_count) {
    block.channels.resize(channel_count);
  }
  const Block& next(Tick first, std::size_t samples) {
    block.first_tick = first;
    block.samples = samples;
    for (std::size_t channel = 0; channel < codes.size(); ++channel) {
      codes[channel].resize(samples);
      for (std::size_t i = 0; i < samples; ++i) {
        codes[channel][i] = code_at<Code>(channel, first + static_cast<Tick>(i));
      }
      block.channels[channel] = std::as_bytes(std::span<const Code>(codes[channel]));
    }
    return block;
  }
  void write(SampleRing& ring, Tick first, std::size_t samples) {
    ring.write(next(first, samples), statistics);
  }
  Block block;
  std::vector<std::vector<Code>> codes;
  std::vector<RunStatistics> statistics;
};

template <class Code>
void expect_stream(const SampleRing& ring, Tick first, Tick end) {
  std::vector<std::int32_t> got(static_cast<std::size_t>(end - first));
  for (std::size_t channel = 0; channel < ring.channels(); ++channel) {
    ASSERT_EQ(ring.copy(channel, first, got), CopyStatus::copied);
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_EQ(got[i], code_at<Code>(channel, first + static_cast<Tick>(i)))
          << "channel " << channel << ", tick " << first + static_cast<Tick>(i);
    }
  }
}

// To the last digit but one: squares of 32-bit codes are rounded, in the order they came.
void expect_statistics(const RunStatistics& got, const RunStatistics& want) {
  EXPECT_EQ(got.count, want.count);
  EXPECT_EQ(got.sum, want.sum);
  EXPECT_NEAR(got.sum_of_squares, want.sum_of_squares, 1e-14 * want.sum_of_squares);
  EXPECT_EQ(got.minimum, want.minimum);
  EXPECT_EQ(got.maximum, want.maximum);
}

template <class Code>
class SampleRingOf : public testing::Test {};
using Codes = testing::Types<std::int16_t, std::int32_t>;
TYPED_TEST_SUITE(SampleRingOf, Codes);

TYPED_TEST(SampleRingOf, HoldsTheLastCapacityOfEveryChannel) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 3, 1000);
  ASSERT_EQ(ring.capacity_samples(), 1024U);
  Stream<Code> stream(3);
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> size(1, 700);
  const Tick begin = 12'345;
  for (Tick tick = begin; tick < begin + 20'000;) {
    const std::size_t samples = size(random);
    stream.write(ring, tick, samples);
    tick += static_cast<Tick>(samples);
    EXPECT_EQ(ring.end_tick(), tick);
    expect_stream<Code>(ring, std::max(begin, tick - 1024), tick);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      expect_statistics(stream.statistics[channel], run_statistics(stream.codes[channel]));
    }
  }
}

TYPED_TEST(SampleRingOf, SaysWhatIsNotThere) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 1, 256);
  Stream<Code> stream(1);
  std::vector<std::int32_t> one(1);
  EXPECT_EQ(ring.copy(0, 0, one), CopyStatus::not_yet);
  stream.write(ring, 1000, 100);
  EXPECT_EQ(ring.copy(0, 999, one), CopyStatus::overwritten) << "before the ring began";
  EXPECT_EQ(ring.copy(0, 1000, one), CopyStatus::copied);
  EXPECT_EQ(ring.copy(0, 1099, one), CopyStatus::copied);
  EXPECT_EQ(ring.copy(0, 1100, one), CopyStatus::not_yet);
  std::vector<std::int32_t> across(2);
  EXPECT_EQ(ring.copy(0, 1099, across), CopyStatus::not_yet);

  stream.write(ring, 1100, 200);
  EXPECT_EQ(ring.copy(0, 1300 - 257, one), CopyStatus::overwritten);
  EXPECT_EQ(ring.copy(0, 1300 - 256, one), CopyStatus::copied);
  std::vector<std::int32_t> all(256);
  EXPECT_EQ(ring.copy(0, 1300 - 256, all), CopyStatus::copied);
  std::vector<std::int32_t> more(257);
  EXPECT_EQ(ring.copy(0, 1300 - 257, more), CopyStatus::overwritten);
  EXPECT_EQ(ring.copy(0, 1300, std::span<std::int32_t>{}), CopyStatus::copied);
}

TYPED_TEST(SampleRingOf, RepeatsTheLastCodeOverAKnownHole) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 2, 512);
  Stream<Code> stream(2);
  stream.write(ring, 0, 300);
  stream.block.missing_before = {Missing::Kind::known, 150};
  stream.write(ring, 450, 100);
  EXPECT_EQ(ring.end_tick(), 550);
  expect_stream<Code>(ring, 100, 300);
  expect_stream<Code>(ring, 450, 550);
  std::vector<std::int32_t> hole(150);
  for (std::size_t channel = 0; channel < 2; ++channel) {
    ASSERT_EQ(ring.copy(channel, 300, hole), CopyStatus::copied);
    EXPECT_EQ(hole, std::vector<std::int32_t>(150, code_at<Code>(channel, 299)));
    SCOPED_TRACE("of the block, not of the hole");
    expect_statistics(stream.statistics[channel], run_statistics(stream.codes[channel]));
  }
}

TYPED_TEST(SampleRingOf, GoesOnAfterAHoleOfAnyLengthWithoutDelay) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 1, 512);
  Stream<Code> stream(1);
  stream.write(ring, 0, 300);
  const Tick far = Tick{1} << 50;
  const auto start = std::chrono::steady_clock::now();
  stream.block.missing_before = {Missing::Kind::known, far - 300};
  stream.write(ring, far, 100);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  EXPECT_EQ(ring.end_tick(), far + 100);
  std::vector<std::int32_t> hole(412);
  ASSERT_EQ(ring.copy(0, far - 412, hole), CopyStatus::copied);
  EXPECT_EQ(hole, std::vector<std::int32_t>(412, code_at<Code>(0, 299)));
  std::vector<std::int32_t> one(1);
  EXPECT_EQ(ring.copy(0, 299, one), CopyStatus::overwritten);
}

TYPED_TEST(SampleRingOf, TakesABlockLongerThanItself) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 2, 256);
  Stream<Code> stream(2);
  stream.write(ring, 7, 10'000);
  expect_stream<Code>(ring, 10'007 - 256, 10'007);
  expect_statistics(stream.statistics[1], run_statistics(stream.codes[1]));
}

TYPED_TEST(SampleRingOf, LeavesOutWhatItHas) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 1, 256);
  Stream<Code> stream(1);
  stream.write(ring, 0, 100);
  stream.next(50, 100);
  for (std::size_t i = 0; i < 50; ++i)
    stream.codes[0][i] = 0;  // would be seen if it were taken again
  ring.write(stream.block, stream.statistics);
  EXPECT_EQ(ring.end_tick(), 150);
  expect_stream<Code>(ring, 0, 150);
  stream.write(ring, 20, 30);
  EXPECT_EQ(ring.end_tick(), 150);
  expect_stream<Code>(ring, 0, 150);
}

TYPED_TEST(SampleRingOf, WritesWithoutAllocating) {
  using Code = TypeParam;
  SampleRing ring(kFormat<Code>, 2, 4096);
  Stream<Code> stream(2);
  stream.next(0, 3000);
  const long before = counted_allocations();
  for (Tick round = 0; round < 20; ++round) {
    ring.write(stream.block, stream.statistics);
    stream.block.first_tick += 3000 + (round % 5 == 4 ? 10'000 : 0);
  }
  EXPECT_EQ(counted_allocations(), before);
}

TEST(SampleRing, AllocatesDuringConstruction) {
  // The planes come from the C library; what the counter must not count is the ring's own doing
  // later.
  const long before = counted_allocations();
  const auto ring = std::make_unique<SampleRing>(SampleFormat::int16, 1, 16);
  EXPECT_GT(counted_allocations(), before) << "the counter counts nothing";
}

TEST(SampleRing, RefusesSizesThatAreNone) {
  EXPECT_THROW(SampleRing(SampleFormat::int16, 0, 100), InputError);
  EXPECT_THROW(SampleRing(SampleFormat::int16, 2, 0), InputError);
  EXPECT_THROW(SampleRing(SampleFormat::int32, 2, std::numeric_limits<std::size_t>::max()),
               InputError);
  EXPECT_THROW(SampleRing(SampleFormat::int32, 2, std::size_t{1} << 39), InputError)
      << "no machine has 4 TiB to spare";
}

}  // namespace
}  // namespace kolsky
