#include "processing/criticism/noise/gauge_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "processing/criticism/noise/quiet_scatter.hpp"
#include "processing/criticism/records/judged_band.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

Campaign small() {
  testing::CampaignWishes wishes{.seed = 11, .shots = 4, .gauges = 4};
  return read_campaign(testing::shots_of(testing::draw_campaign(wishes)));
}

/// Quiet samples of first order that keep so much from one to the next, and a part that all gauges
/// have alike.
void draw_quiet(Campaign& campaign, double keep, double shared, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 4e-6);
  for (CampaignShot& shot : campaign.shots) {
    std::vector<double> common(shot.quiet_samples);
    for (double& value : common) {
      value = std::sqrt(shared) * normal(random);
    }
    for (auto& record : shot.strain) {
      double last = normal(random);
      for (std::size_t n = 0; n < shot.quiet_samples; ++n) {
        last = keep * last + std::sqrt(1.0 - keep * keep) * normal(random);
        record[n] = std::sqrt(1.0 - shared) * last + common[n];
      }
    }
  }
}

int pairs_that_share(const Campaign& campaign) {
  Eigen::MatrixXd noise;
  GaugeNoise(campaign, judged_band(campaign, 0.0)).put_covariance(0, noise);
  int count = 0;
  for (Eigen::Index a = 0; a < noise.rows(); ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      count += noise(a, b) != 0.0 ? 1 : 0;
    }
  }
  return count;
}

// Samples that hang together make independent gauges look alike by chance.
TEST(GaugeNoise, IsNotSharedForBeingSlow) {
  Campaign campaign = small();
  for (const double keep : {0.0, 0.9, 0.97}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      draw_quiet(campaign, keep, 0.0, seed);
      EXPECT_EQ(pairs_that_share(campaign), 0) << keep << " " << seed;
    }
  }
}

TEST(GaugeNoise, IsSharedWhereGaugesHaveAPartInCommon) {
  Campaign campaign = small();
  for (const double keep : {0.0, 0.9}) {
    draw_quiet(campaign, keep, 0.5, 3);
    EXPECT_EQ(pairs_that_share(campaign), 6) << keep;
  }
}

double slowest_power(const Campaign& campaign) {
  return GaugeNoise(campaign, judged_band(campaign, 0.0)).power(1, 0);
}

/// As a hum or a drift does that every shot triggers at the same phase of.
void slope_alike(Campaign& campaign) {
  constexpr double kPerSample = 4e-8;
  for (CampaignShot& shot : campaign.shots) {
    for (std::size_t n = 0; n < shot.quiet_samples; ++n) {
      shot.strain[1][n] += kPerSample * static_cast<double>(n);
    }
  }
}

// What comes again in every shot is what there is to find, and passed for slow noise: a hundred
// times as much as there was.
TEST(GaugeNoise, IsNotWhatAllShotsHaveAlikeBeforeThePulse) {
  Campaign campaign = small();
  draw_quiet(campaign, 0.0, 0.0, 5);
  const double without = slowest_power(campaign);
  slope_alike(campaign);
  const double with = slowest_power(campaign);
  EXPECT_NEAR(with / without, 1.0, 1e-9);
}

// Three shots have much slow noise alike by chance.
TEST(GaugeNoise, OfThreeShotsIsAllOfIt) {
  Campaign campaign = small();
  draw_quiet(campaign, 0.0, 0.0, 5);
  campaign.shots.pop_back();
  const double without = slowest_power(campaign);
  slope_alike(campaign);
  EXPECT_GT(slowest_power(campaign), 2.0 * without);
}

TEST(QuietScatter, IsThatOfIndependentNoise) {
  Campaign campaign = small();
  draw_quiet(campaign, 0.0, 0.0, 5);
  double squares = 0.0;
  double samples = 0.0;
  for (const std::vector<double>& own : quiet_scatter(campaign, 1)) {
    for (const double value : own) {
      squares += value * value;
      samples += 1.0;
    }
  }
  // Three of four degrees of freedom, six deviations.
  EXPECT_NEAR(squares / samples / 16e-12, 1.0, 6.0 * std::sqrt(2.0 / (0.75 * samples)));
}

// A shot whose pulse comes early tells as long as it is quiet.
TEST(QuietScatter, GoesAsFarAsFourShotsAreQuiet) {
  Campaign campaign = read_campaign(
      testing::shots_of(testing::draw_campaign({.seed = 11, .shots = 5, .gauges = 2})));
  const std::size_t quiet = campaign.shots[0].quiet_samples;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    campaign.shots[n].quiet_samples = quiet - 10 * n;
  }
  const auto scatter = quiet_scatter(campaign, 0);
  ASSERT_EQ(scatter.size(), 5U);
  EXPECT_EQ(scatter[0].size(), quiet - 30);
  EXPECT_EQ(scatter[3].size(), quiet - 30);
  EXPECT_EQ(scatter[4].size(), quiet - 40);
}

}  // namespace
}  // namespace kolsky
