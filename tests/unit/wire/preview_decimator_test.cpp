#include "daemon/publish/preview_decimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "kolsky/v1/kolsky.pb.h"
#include "proto/waveform.hpp"

namespace kolsky {
namespace {

constexpr SampleRate kRate{1'000'000, 1};

ChannelRecord channel(const std::string& gauge, int bits) {
  return {gauge, "V", 0.5, -2.0, bits, -(1 << (bits - 1)), (1 << (bits - 1)) - 1, {}};
}

using Codes = std::vector<std::vector<std::int32_t>>;

Codes random_codes(std::size_t channels, std::size_t samples) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> code(-32768, 32767);
  Codes codes(channels, std::vector<std::int32_t>(samples));
  for (auto& one : codes) {
    std::ranges::generate(one, [&] { return code(random); });
  }
  return codes;
}

/// Feeds [first, last) of the codes, that start at tick 0, in one call after another until all is
/// taken.
void feed(PreviewDecimator& decimator, const Codes& codes, std::size_t first, std::size_t last,
          std::vector<v1::Preview>& previews) {
  while (first < last) {
    std::vector<std::span<const std::int32_t>> spans;
    for (const auto& one : codes) {
      spans.push_back(std::span(one).subspan(first, last - first));
    }
    first += decimator.feed(static_cast<Tick>(first), spans);
    if (decimator.complete()) {
      decimator.take(previews.emplace_back());
    }
  }
}

std::vector<std::int32_t> codes_of(const v1::Waveform& waveform) {
  return wire::unpack_codes(waveform, "test").codes;
}

TEST(PreviewDecimator, GivesTheExtremesOfEveryStepHoweverItIsFed) {
  constexpr std::size_t kStep = 7;
  constexpr std::size_t kSteps = 5;
  constexpr std::size_t kMessages = 4;
  const Codes codes = random_codes(2, kStep * kSteps * kMessages);
  for (const std::size_t chunk : {1UL, 3UL, 7UL, 36UL, 1000UL}) {
    PreviewDecimator decimator({channel("g1", 16), channel("g2", 24)}, kRate, kStep, kSteps);
    std::vector<v1::Preview> previews;
    for (std::size_t at = 0; at < codes[0].size(); at += chunk) {
      feed(decimator, codes, at, std::min(at + chunk, codes[0].size()), previews);
    }
    ASSERT_EQ(previews.size(), kMessages) << chunk;
    for (std::size_t m = 0; m < kMessages; ++m) {
      EXPECT_EQ(previews[m].first().tick(), static_cast<Tick>(m * kStep * kSteps));
      EXPECT_EQ(previews[m].missing_samples(), 0U);
      for (int c = 0; c < 2; ++c) {
        const auto minimum = codes_of(previews[m].channels(c).minimum());
        const auto maximum = codes_of(previews[m].channels(c).maximum());
        ASSERT_EQ(minimum.size(), kSteps);
        for (std::size_t s = 0; s < kSteps; ++s) {
          const auto begin = codes[c].begin() + static_cast<long>((m * kSteps + s) * kStep);
          EXPECT_EQ(minimum[s], *std::min_element(begin, begin + kStep));
          EXPECT_EQ(maximum[s], *std::max_element(begin, begin + kStep));
        }
      }
    }
  }
}

TEST(PreviewDecimator, SaysWhatTheCodesMean) {
  PreviewDecimator decimator({channel("g1", 16), channel("g2", 24)}, {3'000'000, 2}, 3, 1);
  std::vector<v1::Preview> previews;
  feed(decimator, {{1, -5, 3}, {70'000, 2, 3}}, 0, 3, previews);
  ASSERT_EQ(previews.size(), 1U);
  const v1::Preview& preview = previews[0];
  EXPECT_DOUBLE_EQ(preview.step_s(), 3 / 1.5e6);
  EXPECT_EQ(preview.first().rate_numerator(), 3'000'000);
  EXPECT_EQ(preview.first().rate_denominator(), 2);
  EXPECT_EQ(preview.channels(0).gauge(), "g1");
  EXPECT_EQ(preview.channels(0).minimum().dtype(), v1::Waveform::INT16);
  EXPECT_EQ(preview.channels(1).maximum().dtype(), v1::Waveform::INT32);
  const ChannelRecord minimum = wire::unpack_codes(preview.channels(0).minimum(), "test");
  EXPECT_EQ(minimum.codes, (std::vector<std::int32_t>{-5}));
  EXPECT_EQ(minimum.value(-5), -3.5);
  EXPECT_EQ(minimum.unit, "V");
  EXPECT_EQ(codes_of(preview.channels(1).maximum()), (std::vector<std::int32_t>{70'000}));
}

TEST(PreviewDecimator, AJumpEndsTheMessageAndIsCounted) {
  PreviewDecimator decimator({channel("g1", 16)}, kRate, 4, 10);
  const Codes codes = random_codes(1, 200);
  std::vector<v1::Preview> previews;
  feed(decimator, codes, 0, 6, previews);
  EXPECT_TRUE(previews.empty());
  feed(decimator, codes, 106, 110, previews);  // 6 to 105 never came
  ASSERT_EQ(previews.size(), 1U);
  EXPECT_EQ(previews[0].first().tick(), 0);
  const auto maximum = codes_of(previews[0].channels(0).maximum());
  ASSERT_EQ(maximum.size(), 2U);
  EXPECT_EQ(maximum[1], std::max(codes[0][4], codes[0][5]));
  feed(decimator, codes, 110, 146, previews);
  ASSERT_EQ(previews.size(), 2U);
  EXPECT_EQ(previews[1].first().tick(), 106);
  EXPECT_EQ(previews[1].missing_samples(), 100U);
  feed(decimator, codes, 146, 186, previews);
  ASSERT_EQ(previews.size(), 3U);
  EXPECT_EQ(previews[2].missing_samples(), 0U);
}

TEST(PreviewDecimator, BeginsWhereItIsFirstFed) {
  PreviewDecimator decimator({channel("g1", 16)}, kRate, 2, 2);
  const Codes codes = random_codes(1, 50);
  std::vector<v1::Preview> previews;
  feed(decimator, codes, 30, 34, previews);
  ASSERT_EQ(previews.size(), 1U);
  EXPECT_EQ(previews[0].first().tick(), 30);
  EXPECT_EQ(previews[0].missing_samples(), 0U);
}

TEST(PreviewDecimator, NothingFedIsNothingTaken) {
  PreviewDecimator decimator({channel("g1", 16)}, kRate, 2, 2);
  EXPECT_EQ(decimator.feed(0, {}), 0U);
  const std::vector<std::span<const std::int32_t>> empty(1);
  EXPECT_EQ(decimator.feed(5, empty), 0U);
  EXPECT_FALSE(decimator.complete());
}

}  // namespace
}  // namespace kolsky
