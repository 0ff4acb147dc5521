#include "processing/trigger/channel_level.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace kolsky {
namespace {

constexpr std::size_t kRun = 128;

class Channel : public testing::Test {
 protected:
  /// Feeds so many runs of normal noise.
  void feed(int runs, double mean, double sigma) {
    std::normal_distribution<double> noise(mean, sigma);
    for (int run = 0; run < runs; ++run) {
      std::vector<std::int16_t> codes(kRun);
      for (std::int16_t& code : codes) code = static_cast<std::int16_t>(std::lround(noise(random)));
      level.take(run_statistics(codes));
    }
  }
  void feed_pulse() {
    std::vector<std::int16_t> codes(kRun, 5000);
    level.take(run_statistics(codes));
  }

  std::mt19937_64 random{11};
  ChannelLevel level{TriggerOptions::for_rate(1e6)};
};

TEST_F(Channel, KnowsBaselineAndNoise) {
  feed(400, -321.0, 20.0);
  ASSERT_TRUE(level.learned());
  // 20 000 remembered samples: the mean to 20 / sqrt(20 000) = 0.14, the deviation to 0.1.
  EXPECT_NEAR(level.baseline_codes(), -321.0, 4 * 0.14);
  EXPECT_NEAR(level.noise_codes(), 20.0, 4 * 0.1 + 1e-2);
}

TEST_F(Channel, HasLearnedAfterAsManySamplesAsTheTrigger) {
  feed(1, 0.0, 5.0);
  EXPECT_FALSE(level.learned());
  feed(1, 0.0, 5.0);
  EXPECT_TRUE(level.learned());
}

TEST_F(Channel, LeavesAPulseOut) {
  feed(400, 100.0, 20.0);
  const double baseline = level.baseline_codes();
  const double noise = level.noise_codes();
  for (int run = 0; run < 60; ++run) feed_pulse();  // 8 ms, as a shot and its echoes last
  EXPECT_EQ(level.baseline_codes(), baseline);
  EXPECT_EQ(level.noise_codes(), noise);
}

TEST_F(Channel, FollowsAStepThatStays) {
  feed(400, 100.0, 20.0);
  feed(200, 3000.0, 20.0);
  EXPECT_NEAR(level.baseline_codes(), 3000.0, 4 * 0.3);
  EXPECT_NEAR(level.noise_codes(), 20.0, 1.0);
}

TEST_F(Channel, ForgetsWhenTold) {
  feed(400, 100.0, 20.0);
  level.forget();
  EXPECT_FALSE(level.learned());
  EXPECT_EQ(level.baseline_codes(), 0.0);
}

TEST_F(Channel, OfAConstantHasTheLeastNoise) {
  for (int run = 0; run < 10; ++run) feed_pulse();
  EXPECT_EQ(level.baseline_codes(), 5000.0);
  EXPECT_EQ(level.noise_codes(), TriggerOptions{}.minimum_noise_codes);
}

TEST_F(Channel, MakesNothingOfRunsWithoutNoise) {
  const std::vector<std::int16_t> one{7};
  level.take({});
  level.take(run_statistics(one));
  EXPECT_EQ(level.baseline_codes(), 0.0);
  EXPECT_FALSE(level.learned());
}

}  // namespace
}  // namespace kolsky
