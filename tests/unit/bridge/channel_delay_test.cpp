#include "processing/bridge/channel_delay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace kolsky {
namespace {

constexpr double kRate_Hz = 1e6;

/// A tone that is recorded late, sampled where the definition puts it.
std::vector<double> tone(double frequency_Hz, double delay_s, std::size_t samples) {
  std::vector<double> record(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / kRate_Hz - delay_s;
    record[n] = std::sin(2.0 * std::numbers::pi * frequency_Hz * t);
  }
  return record;
}

TEST(ChannelDelay, IsTakenOutOfATone) {
  for (const double frequency_Hz : {5e3, 120e3, 300e3, 420e3}) {
    for (const double delay_s : {-7.3e-6, -0.5e-6, 0.25e-6, 3.6e-6, 17.9e-6}) {
      std::vector<double> record = tone(frequency_Hz, delay_s, 400);
      const std::vector<double> on_time = tone(frequency_Hz, 0.0, 400);
      take_out_delay(delay_s, kRate_Hz, record);
      for (std::size_t n = 40; n < 360; ++n) {
        ASSERT_NEAR(record[n], on_time[n], 1e-4) << frequency_Hz << " Hz, " << delay_s << " s";
      }
    }
  }
}

TEST(ChannelDelay, OfWholeSamplesMovesThemAsTheyAre) {
  std::vector<double> record = {0.0, 1.0, 4.0, 9.0, 16.0};
  take_out_delay(2e-6, kRate_Hz, record);
  const std::vector<double> early = {4.0, 9.0, 16.0, 16.0, 16.0};
  for (std::size_t n = 0; n < record.size(); ++n) {
    EXPECT_NEAR(record[n], early[n], 1e-12);
  }
  take_out_delay(-1e-6, kRate_Hz, record);
  EXPECT_NEAR(record[0], 4.0, 1e-12);
  EXPECT_NEAR(record[1], 4.0, 1e-12);
  EXPECT_NEAR(record[2], 9.0, 1e-12);
}

TEST(ChannelDelay, LeavesALevelAndAnEmptyRecordAlone) {
  std::vector<double> level(50, 3.0);
  take_out_delay(4.4e-6, kRate_Hz, level);
  for (const double value : level) {
    EXPECT_NEAR(value, 3.0, 1e-12);
  }
  std::vector<double> none;
  take_out_delay(4.4e-6, kRate_Hz, none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace kolsky
