#include "processing/criticism/noise/gauge_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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

}  // namespace
}  // namespace kolsky
