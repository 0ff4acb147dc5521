// Noise that wanders slowly and alike at all gauges, another way in every shot: in records of a
// fraction of the mains' period nearly all of it is a slope, as of a hum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

testing::Campaign six_shots(std::uint64_t seed) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = 6, .gauges = 3, .samples = 2048, .rate_Hz = 1e6};
  return testing::draw_campaign(wishes);
}

Diagnosis diagnosed(const std::vector<Shot>& shots) {
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

/// 150 to 700 Hz, as strong as the gauges' own noise.
testing::Readings wandering(const testing::Campaign& campaign, std::uint64_t seed) {
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> even;
  constexpr double kAmplitude = 6e-6;
  for (auto& shot : readings) {
    const double per_sample = 2.0 * std::numbers::pi * (150.0 + 550.0 * even(random)) * 1e-6;
    const double phase = 2.0 * std::numbers::pi * even(random);
    for (std::vector<double>& gauge : shot) {
      for (std::size_t n = 0; n < gauge.size(); ++n) {
        gauge[n] += kAmplitude * std::cos(per_sample * static_cast<double>(n) + phase);
      }
    }
  }
  return readings;
}

// Of these eight one is a hum to all that can be seen of it.
TEST(CommonWander, IsNoHum) {
  std::size_t claimed = 0;
  for (std::uint64_t seed = 601; seed < 609; ++seed) {
    const testing::Campaign campaign = six_shots(seed);
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign, wandering(campaign, seed)));
    claimed += diagnosis.effects.empty() ? 0 : 1;
  }
  EXPECT_LE(claimed, 1U);
}

// Nor does what keeps wander from being one keep a hum from being found. Records of a tenth of a
// period do not know whether it is of 50 or 60 Hz, by which amplitudes differ by a third.
TEST(CommonWander, LeavesAHumWhatItIs) {
  constexpr double kAmplitude = 4e-5;
  std::size_t found = 0;
  for (std::uint64_t seed = 601; seed < 609; ++seed) {
    testing::Campaign campaign = six_shots(seed);
    const char* frequency = seed % 2 == 0 ? "50" : "60";
    testing::hide(campaign,
                  testing::parse_effect(std::string("mains-hum=4e-5,frequency=") + frequency));
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    if (diagnosis.effects != std::vector<std::string>{"mains-hum"}) {
      continue;
    }
    ++found;
    const auto hum = std::ranges::find(diagnosis.candidates, "mains-hum", &CandidateResult::effect);
    ASSERT_NE(hum, diagnosis.candidates.end());
    EXPECT_LT(std::abs(hum->strength - kAmplitude), 2.5 * hum->sd) << seed << ": " << hum->strength;
    EXPECT_LT(hum->sd, 0.6 * kAmplitude) << seed;
  }
  EXPECT_GE(found, 7U);
}

}  // namespace
}  // namespace kolsky
