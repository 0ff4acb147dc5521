// Pulses that rise before their foot is seen, of shots whose noise hides it one by one.
#include "processing/criticism/records/soft_foot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kolsky {
namespace {

constexpr double kPeriod_s = 1e-6;
constexpr double kNoise = 3e-6;
constexpr std::size_t kQuiet = 290;

/// Shots of 500 to 2500 microstrain.
/// @param before  what the pulse is at so many samples before the quiet ends, over its height
template <typename Before>
std::vector<CampaignShot> shots_with(unsigned seed, const Before& before) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<CampaignShot> shots(6);
  for (std::size_t n = 0; n < shots.size(); ++n) {
    const double height = 5e-4 + 4e-4 * static_cast<double>(n);
    std::vector<double> strain(600, height);
    for (std::size_t k = 0; k < kQuiet; ++k) {
      strain[k] = height * before(static_cast<double>(kQuiet - 1 - k)) + noise(random);
    }
    shots[n].quiet_samples = kQuiet;
    shots[n].strain = {strain};
  }
  return shots;
}

TEST(SoftFoot, IsSeenInAllShotsTogether) {
  // 9 microstrain at the quiet's end in the mean of the shots, within 8 us three times one's noise.
  const auto before = [](double samples) { return 6e-3 * std::exp(-samples / 8.0); };
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::size_t found = soft_foot_samples(shots_with(seed, before), 0, kPeriod_s);
    EXPECT_GE(found, 15U) << seed;
    EXPECT_LE(found, kQuiet / 3) << seed;
  }
}

// A wave that comes back larger and of the other sign changes nothing.
TEST(SoftFoot, IsOfTheFirstPulse) {
  const auto before = [](double samples) { return 6e-3 * std::exp(-samples / 8.0); };
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<CampaignShot> shots = shots_with(seed, before);
    for (std::size_t n = 0; n < shots.size(); n += 2) {
      std::vector<double>& strain = shots[n].strain.front();
      strain.insert(strain.end(), 600, -1.2 * strain.back());
    }
    EXPECT_GE(soft_foot_samples(shots, 0, kPeriod_s), 15U) << seed;
  }
}

// Of noise alone, and of what drifts or hums as much before as at the end, hardly anything is
// taken.
TEST(SoftFoot, IsNeitherNoiseNorADriftNorAHum) {
  const auto hum = [](double samples) { return 5e-3 * std::sin(1.0 - 3.14e-4 * samples); };
  std::size_t taken = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    taken += soft_foot_samples(shots_with(seed, [](double) { return 0.0; }), 0, kPeriod_s);
    taken += soft_foot_samples(shots_with(seed, [](double samples) { return -2e-5 * samples; }), 0,
                               kPeriod_s);
    taken += soft_foot_samples(shots_with(seed, hum), 0, kPeriod_s);
  }
  constexpr std::size_t kFew = 6;  // of 150
  EXPECT_LT(taken, kFew * 2 * kQuiet / 30);
}

// A quiet of one code has nothing to tell.
TEST(SoftFoot, IsNotSeenInAQuietWithoutNoise) {
  std::vector<CampaignShot> shots = shots_with(1, [](double) { return 0.0; });
  for (CampaignShot& shot : shots) {
    std::fill_n(shot.strain.front().begin(), kQuiet, 0.0);
  }
  EXPECT_EQ(soft_foot_samples(shots, 0, kPeriod_s), 0U);
}

}  // namespace
}  // namespace kolsky
