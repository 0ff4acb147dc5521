#include "processing/criticism/search/quiet_slopes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace kolsky {
namespace {

constexpr double kPeriod_s = 1e-6;
constexpr std::size_t kQuiet = 400;
constexpr double kNoise = 1e-5;

Campaign silent(std::size_t shots, std::size_t gauges) {
  Campaign campaign;
  campaign.period_s = kPeriod_s;
  campaign.bench.gauges.resize(gauges);
  for (std::size_t n = 0; n < shots; ++n) {
    CampaignShot& shot = campaign.shots.emplace_back();
    shot.quiet_samples = kQuiet;
    for (std::size_t i = 0; i < kQuiet; ++i) {
      shot.facts.time_s.push_back(kPeriod_s * static_cast<double>(i));
    }
    shot.strain.assign(gauges, std::vector<double>(kQuiet, 0.0));
  }
  return campaign;
}

/// Noise that keeps so much from one sample to the next, and a part that all gauges share.
void add_noise(Campaign& campaign, double keep, double shared, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, kNoise);
  for (CampaignShot& shot : campaign.shots) {
    std::vector<double> common(kQuiet);
    for (double& value : common) {
      value = std::sqrt(shared) * normal(random);
    }
    for (auto& record : shot.strain) {
      double last = normal(random);
      for (std::size_t i = 0; i < kQuiet; ++i) {
        last = keep * last + std::sqrt(1.0 - keep * keep) * normal(random);
        record[i] += std::sqrt(1.0 - shared) * last + common[i];
      }
    }
  }
}

/// A hum of 50 Hz with a phase of its own in every shot. @param alike  the same at all gauges
void add_hum(Campaign& campaign, double amplitude, bool alike, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(0.0, 2.0 * std::numbers::pi);
  for (CampaignShot& shot : campaign.shots) {
    double phase = any(random);
    for (auto& record : shot.strain) {
      phase = alike ? phase : any(random);
      for (std::size_t i = 0; i < kQuiet; ++i) {
        record[i] +=
            amplitude * std::cos(2.0 * std::numbers::pi * 50.0 * shot.facts.time_s[i] + phase);
      }
    }
  }
}

/// Of so many campaigns, those in which common slopes would come by chance less than once in a
/// hundred.
int seldom(int campaigns, std::size_t gauges,
           const std::function<void(Campaign&, std::mt19937_64&)>& fill) {
  std::mt19937_64 random(7);
  int count = 0;
  for (int n = 0; n < campaigns; ++n) {
    Campaign campaign = silent(5, gauges);
    fill(campaign, random);
    count += log_chance_of_common_slopes(campaign) < std::log(0.01) ? 1 : 0;
  }
  return count;
}

// One in a hundred, and three deviations of the count of 400.
constexpr int kCampaigns = 400;
constexpr int kMost = 10;

TEST(CommonSlopes, OfNoiseComeAsSeldomAsStated) {
  for (const std::size_t gauges : {2U, 4U}) {
    for (const double keep : {0.0, 0.9, 0.98}) {
      EXPECT_LE(seldom(kCampaigns, gauges,
                       [&](Campaign& campaign, std::mt19937_64& random) {
                         add_noise(campaign, keep, 0.0, random);
                       }),
                kMost)
          << gauges << " gauges, " << keep;
    }
  }
}

TEST(CommonSlopes, AreNotThoseOfNoiseThatGaugesShare) {
  for (const double shared : {0.3, 0.8}) {
    EXPECT_LE(seldom(kCampaigns, 4,
                     [&](Campaign& campaign, std::mt19937_64& random) {
                       add_noise(campaign, 0.0, shared, random);
                     }),
              kMost)
        << shared;
  }
}

/// A walk at random that all gauges take together, an eighth of the noise a sample.
void add_walk(Campaign& campaign, std::mt19937_64& random) {
  std::normal_distribution<double> step(0.0, kNoise / 8.0);
  for (CampaignShot& shot : campaign.shots) {
    double at = 0.0;
    for (std::size_t i = 0; i < kQuiet; ++i) {
      at += step(random);
      for (auto& record : shot.strain) {
        record[i] += at;
      }
    }
  }
}

// About its slopes it turns, by which it is told from what only slopes.
TEST(CommonSlopes, AreNotThoseOfAWalkThatGaugesTakeTogether) {
  EXPECT_LE(seldom(kCampaigns, 4,
                   [&](Campaign& campaign, std::mt19937_64& random) {
                     add_noise(campaign, 0.0, 0.0, random);
                     add_walk(campaign, random);
                   }),
            kMost);
}

TEST(CommonWander, IsSeenOfAWalkAndOfNothingElse) {
  std::mt19937_64 random(8);
  int seen_without = 0;
  int seen_of_hum = 0;
  int seen_of_walk = 0;
  for (int n = 0; n < kCampaigns; ++n) {
    Campaign campaign = silent(5, 4);
    add_noise(campaign, n % 2 == 0 ? 0.0 : 0.9, 0.0, random);
    seen_without += wanders_in_common(campaign) ? 1 : 0;
    Campaign humming = campaign;
    add_hum(humming, 6e-5, true, random);
    seen_of_hum += wanders_in_common(humming) ? 1 : 0;
    add_walk(campaign, random);
    seen_of_walk += wanders_in_common(campaign) ? 1 : 0;
  }
  EXPECT_LE(seen_without, kMost);
  EXPECT_LE(seen_of_hum, kMost);
  EXPECT_GE(seen_of_walk, 9 * kCampaigns / 10);
}

TEST(CommonSlopes, AreNotThoseThatEachGaugeHasOfItsOwn) {
  EXPECT_LE(seldom(kCampaigns, 4,
                   [&](Campaign& campaign, std::mt19937_64& random) {
                     add_noise(campaign, 0.0, 0.0, random);
                     add_hum(campaign, 2e-4, false, random);
                   }),
            kMost);
}

// Slopes have a deviation of sqrt(12 / 400) sd / 400 us = 4.3e-3 /s; the mean of four gauges half
// of it; a hum of 60 microstrain rises by 2 pi 50 Hz 60e-6 / sqrt(2) = 13e-3 /s rms.
TEST(CommonSlopes, OfAHumStandOut) {
  EXPECT_GE(seldom(100, 4,
                   [&](Campaign& campaign, std::mt19937_64& random) {
                     add_noise(campaign, 0.0, 0.0, random);
                     add_hum(campaign, 6e-5, true, random);
                   }),
            99);
}

TEST(CommonSlopes, OfOneGaugeSayNothing) {
  EXPECT_EQ(seldom(10, 1,
                   [&](Campaign& campaign, std::mt19937_64& random) {
                     add_noise(campaign, 0.0, 0.0, random);
                     add_hum(campaign, 1e-3, true, random);
                   }),
            0);
}

}  // namespace
}  // namespace kolsky
