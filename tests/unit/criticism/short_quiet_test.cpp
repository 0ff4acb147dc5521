// Slow noise of which the quiet before the pulse shows little, and whose slopes weigh in what a
// soft specimen lets through: a slow pulse hardly larger than they are.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

testing::Campaign soft_specimen(std::uint64_t seed) {
  testing::CampaignWishes wishes{.seed = seed, .shots = 6, .gauges = 2, .noise_strain = 0.3e-6};
  wishes.rate_Hz = 1e6;
  wishes.tolerances = testing::Tolerances::filed;
  wishes.split = true;
  testing::Campaign campaign = testing::draw_campaign(wishes);
  testing::TrueSpecimen& specimen = campaign.split->specimen;
  specimen.E1_Pa = 30e6;
  specimen.E2_Pa = 22e6;
  specimen.eta2_Pa_s = 950.0;
  return campaign;
}

/// Of first order, slower than the quiet is long, half of it alike at all gauges.
testing::Readings wandering(const testing::Campaign& campaign, std::uint64_t seed) {
  constexpr double kTime_s = 300e-6;
  constexpr double kDeviation = 1e-6;
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double keeps = std::exp(-campaign.world.timing.period_s() / kTime_s);
  const double fresh = kDeviation * std::sqrt(0.5 * (1.0 - keeps * keeps));
  for (auto& shot : readings) {
    std::vector<double> own(shot.size());
    double common = std::sqrt(0.5) * kDeviation * normal(random);
    for (double& at : own) {
      at = std::sqrt(0.5) * kDeviation * normal(random);
    }
    for (std::size_t n = 0; n < shot.front().size(); ++n) {
      common = keeps * common + fresh * normal(random);
      for (std::size_t j = 0; j < shot.size(); ++j) {
        own[j] = keeps * own[j] + fresh * normal(random);
        shot[j][n] += common + own[j];
      }
    }
  }
  return readings;
}

// Baselines that a short quiet leaves off, and ends that are cut off, put the same shape into all
// frequencies: of these eight four were `unknown`, for gauges that read shots differently or for
// a relaxation whose derivative promised a hundred times what it gains.
TEST(SoftSpecimens, AreAdequateThoughLittleIsKnownOfSlowNoise) {
  constexpr std::size_t kMostQuiet = 150;
  std::size_t asked = 0;
  std::size_t adequate = 0;
  for (std::uint64_t seed = 1; asked < 8; ++seed) {
    const testing::Campaign truth = soft_specimen(seed);
    if (truth.world.timing.pretrigger > kMostQuiet) {
      continue;
    }
    ++asked;
    const Campaign campaign = read_campaign(testing::shots_of(truth, wandering(truth, seed)));
    Study study(campaign, 0.0, Workers{});
    const Diagnosis diagnosis = diagnose(study, filed_split_bar(truth), {});
    EXPECT_TRUE(diagnosis.effects.empty()) << seed;
    adequate += diagnosis.verdict == DiagnosisVerdict::adequate ? 1 : 0;
  }
  EXPECT_GE(adequate, 7U);
}

// A fifth of what the output gauge reads of one shot is lost: slow noise does no such thing, and
// may not pass for as strong as that shot has it.
TEST(SoftSpecimens, ReadDifferentlyInOneShotAreUnknown) {
  for (const std::uint64_t seed : {5U, 23U, 50U}) {
    const testing::Campaign truth = soft_specimen(seed);
    testing::Readings readings = wandering(truth, seed);
    for (double& value : readings.front().at(1)) {
      value *= 0.8;
    }
    const Campaign campaign = read_campaign(testing::shots_of(truth, readings));
    Study study(campaign, 0.0, Workers{});
    EXPECT_EQ(diagnose(study, filed_split_bar(truth), {}).verdict, DiagnosisVerdict::unknown)
        << seed;
  }
}

}  // namespace
}  // namespace kolsky
