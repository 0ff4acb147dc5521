#include "processing/trigger/run_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace kolsky {
namespace {

struct Reference {
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  std::int32_t minimum = std::numeric_limits<std::int32_t>::max();
  std::int32_t maximum = std::numeric_limits<std::int32_t>::min();
};

template <class Code>
Reference one_by_one(const std::vector<Code>& codes, std::int64_t pivot = 0) {
  Reference r;
  for (const Code code : codes) {
    r.sum += code - pivot;
    r.squares += (code - pivot) * (code - pivot);
    r.minimum = std::min<std::int32_t>(r.minimum, code);
    r.maximum = std::max<std::int32_t>(r.maximum, code);
  }
  return r;
}

template <class Code>
std::vector<Code> random_codes(std::size_t size, Code low, Code high, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> code(low, high);
  std::vector<Code> codes(size);
  for (Code& c : codes) c = static_cast<Code>(code(random));
  return codes;
}

template <class Code>
void expect_like(const RunStatistics& got, const std::vector<Code>& codes) {
  const Reference want = one_by_one(codes);
  EXPECT_EQ(got.count, static_cast<std::int64_t>(codes.size()));
  EXPECT_EQ(got.sum, static_cast<double>(want.sum));
  const auto squares = static_cast<double>(want.squares);
  EXPECT_NEAR(got.sum_of_squares, squares, sizeof(Code) == 2 ? 0.0 : 1e-13 * squares);
  EXPECT_EQ(got.minimum, want.minimum);
  EXPECT_EQ(got.maximum, want.maximum);
}

TEST(RunStatistics, AreThoseOfEverySampleAtEveryLength) {
  for (std::size_t size = 1; size < 300; ++size) {
    const auto narrow =
        random_codes<std::int16_t>(size, -32768, 32767, static_cast<unsigned>(size));
    const auto wide =
        random_codes<std::int32_t>(size, -8388608, 8388607, static_cast<unsigned>(size));
    expect_like(run_statistics(narrow), narrow);
    expect_like(run_statistics(wide), wide);
  }
}

TEST(RunStatistics, DoNotOverflowOnLongRunsAtTheRail) {
  for (const std::int16_t rail : {std::int16_t{-32768}, std::int16_t{32767}}) {
    const std::vector<std::int16_t> codes(70'000, rail);
    expect_like(run_statistics(codes), codes);
  }
}

TEST(RunStatistics, OfNothingAreZero) {
  EXPECT_EQ(run_statistics(std::span<const std::int16_t>{}), RunStatistics{});
  EXPECT_EQ(run_statistics(std::span<const std::int32_t>{}), RunStatistics{});
}

template <class Code>
void expect_copied(const std::vector<Code>& codes) {
  constexpr Code kGuard = 77;
  std::vector<Code> to(codes.size() + 2, kGuard);
  const RunStatistics got =
      copy_with_statistics(codes, std::span<Code>(to).subspan(1, codes.size()));
  expect_like(got, codes);
  EXPECT_TRUE(std::equal(codes.begin(), codes.end(), to.begin() + 1));
  EXPECT_EQ(to.front(), kGuard);
  EXPECT_EQ(to.back(), kGuard);
}

// Copies count from the first code while the others are near it: up to 1023 at any length, here at
// that limit, just beyond it and at the rails.
TEST(RunStatistics, WhileCopyingHoldAboutEveryFirstCode) {
  for (const int first : {-32768, -32000, 0, 31744, 32767}) {
    for (const int reach : {1, 1023, 1024, 2047, 32767}) {
      for (const std::size_t size : {2U, 16U, 2047U, 2048U, 2049U, 5000U}) {
        for (const int side : {-1, 1}) {
          const int other = std::clamp(first + side * reach, -32768, 32767);
          std::vector<std::int16_t> codes(size, static_cast<std::int16_t>(other));
          codes[0] = static_cast<std::int16_t>(first);
          std::vector<std::int16_t> to(size);
          expect_like(copy_with_statistics(codes, std::span<std::int16_t>(to)), codes);
          EXPECT_EQ(to, codes);
        }
      }
    }
  }
}

TEST(RunStatistics, ComeWithTheCopyAndNothingBesideItIsTouched) {
  for (const std::size_t size : {1UL, 7UL, 64UL, 129UL, 4096UL, 10'001UL}) {
    expect_copied(random_codes<std::int16_t>(size, -32768, 32767));
    expect_copied(random_codes<std::int32_t>(size, -8388608, 8388607));
  }
}

TEST(RunStatistics, JoinAsIfTheRunsWereOne) {
  const auto all = random_codes<std::int16_t>(1000, -500, 900);
  const std::span<const std::int16_t> span(all);
  for (const std::size_t cut : {0UL, 1UL, 500UL, 1000UL}) {
    const auto joined = run_statistics(span.first(cut)).joined(run_statistics(span.subspan(cut)));
    EXPECT_EQ(joined, run_statistics(span)) << "cut at " << cut;
  }
}

TEST(DeviationSums, AreExactAboutAnyPivot) {
  for (const std::int32_t pivot : {-40'000, -1, 0, 12'345}) {
    for (const std::size_t size : {1UL, 5UL, 128UL, 512UL}) {
      const auto narrow = random_codes<std::int16_t>(size, -32768, 32767);
      const auto wide = random_codes<std::int32_t>(size, -8388608, 8388607);
      for (const auto& [got, want] :
           {std::pair(deviation_sums(narrow, pivot), one_by_one(narrow, pivot)),
            std::pair(deviation_sums(wide, pivot), one_by_one(wide, pivot))}) {
        EXPECT_EQ(got.count, static_cast<std::int64_t>(size));
        EXPECT_EQ(got.sum, want.sum);
        EXPECT_EQ(got.sum_of_squares, want.squares);
      }
    }
  }
}

TEST(NearSums, AreTheSameOfCodesNearThePivot) {
  constexpr std::int32_t kPivot = 32'000;  // some of the codes' range is beyond 16 bits from here
  for (const std::size_t size : {1UL, 5UL, 128UL, 512UL}) {
    const auto narrow = random_codes<std::int16_t>(size, kPivot - kNear, 32767);
    const auto wide = random_codes<std::int32_t>(size, kPivot - kNear, kPivot + kNear);
    for (const auto& [near, any] :
         {std::pair(near_sums(narrow, kPivot), deviation_sums(narrow, kPivot)),
          std::pair(near_sums(wide, kPivot), deviation_sums(wide, kPivot))}) {
      EXPECT_EQ(near.sum, any.sum);
      EXPECT_EQ(near.sum_of_squares, any.sum_of_squares);
    }
  }
  for (const std::int32_t edge : {-kNear, kNear}) {
    const NearSums sums =
        near_sums(std::vector<std::int16_t>(512, static_cast<std::int16_t>(edge)), 0);
    EXPECT_EQ(sums.sum, 512 * edge);
    EXPECT_EQ(sums.sum_of_squares, 512 * kNear * kNear);
  }
}

TEST(Extremes, AreFoundWhereverTheyAre) {
  for (std::size_t at = 0; at < 200; ++at) {
    std::vector<std::int16_t> narrow(200, 5);
    std::vector<std::int32_t> wide(200, 5);
    narrow[at] = -32768;
    wide[at] = std::numeric_limits<std::int32_t>::max();
    EXPECT_EQ(extremes(narrow).minimum, -32768);
    EXPECT_EQ(extremes(narrow).maximum, 5);
    EXPECT_EQ(extremes(wide).minimum, 5);
    EXPECT_EQ(extremes(wide).maximum, std::numeric_limits<std::int32_t>::max());
  }
}

TEST(DeviationSums, OfFullScaleThirtyTwoBitCodesAreHeldInRange) {
  const std::vector<std::int32_t> codes = {std::numeric_limits<std::int32_t>::min(),
                                           std::numeric_limits<std::int32_t>::max()};
  const DeviationSums sums = deviation_sums(codes, 5);
  EXPECT_EQ(sums.sum, 0);
  EXPECT_EQ(sums.sum_of_squares, std::int64_t{1} << 55);
}

}  // namespace
}  // namespace kolsky
