#include "processing/criticism/records/judged_band.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/base/error.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr double kBand_Hz = 30e3;

Campaign two_shots() {
  const testing::CampaignWishes wishes{.seed = 11, .shots = 2, .gauges = 3};
  return read_campaign(testing::shots_of(testing::draw_campaign(wishes)));
}

void cut_off(Campaign& campaign, std::size_t samples) {
  for (CampaignShot& shot : campaign.shots) {
    for (auto& record : shot.strain) {
      record.resize(record.size() - samples);
    }
  }
}

/// The same, with pulses from the first sample on.
JudgedBand without_quiet(Campaign campaign) {
  for (CampaignShot& shot : campaign.shots) {
    shot.quiet_samples = 0;
  }
  return judged_band(campaign, kBand_Hz);
}

std::size_t largest_prime_factor(std::size_t n) {
  std::size_t largest = 1;
  for (std::size_t factor = 2; n > 1; ++factor) {
    for (; n % factor == 0; n /= factor) {
      largest = factor;
    }
  }
  return largest;
}

std::size_t end_of(const JudgedBand& band) {
  return band.begin + band.judged * band.decimation;
}

TEST(JudgedBand, GoesNoFurtherThanTheRecords) {
  const Campaign campaign = two_shots();
  EXPECT_THROW((void)judged_band(campaign, 0.6 / campaign.period_s), InputError);
}

// Of 1 ms in a bar of 40 mm exact waves foretold three times the pulse: a transform as short as the
// record damps them by a seventh within a radius, where the first mode is hardly itself any more.
TEST(JudgedBand, IsTransformedForLongEnoughThatExactWavesOfThickBarsAreDampedLittle) {
  Campaign campaign = two_shots();
  cut_off(campaign, campaign.shots.front().strain.front().size() - 1000);
  const auto damped_within_radius = [&](double diameter_m) {
    campaign.bench.input.diameter_m.value = diameter_m;
    const JudgedBand band = judged_band(campaign, kBand_Hz);
    const double transformed_s = static_cast<double>(band.transformed) * campaign.period_s;
    constexpr double kPmma_m_per_s = 2200.0;
    return -std::log(kWrapDamping) / transformed_s * diameter_m / 2.0 / kPmma_m_per_s;
  };
  for (const double diameter_m : {0.01, 0.02, 0.04, 0.1}) {
    EXPECT_LT(damped_within_radius(diameter_m), 0.1) << diameter_m;
  }
}

// A transform of a length with a large prime factor takes six times as long.
TEST(JudgedBand, TakesWhatAQuickTransformNeedsOfTheQuietBeforeThePulses) {
  Campaign campaign = two_shots();
  int slow_as_it_was = 0;
  int slow = 0;
  for (int cut = 0; cut < 40; ++cut) {
    cut_off(campaign, 3);
    const JudgedBand band = judged_band(campaign, kBand_Hz);
    const JudgedBand plain = without_quiet(campaign);
    EXPECT_EQ(end_of(band), end_of(plain)) << "what comes last may hold the whole of an effect";
    EXPECT_GE(band.judged, plain.judged);
    EXPECT_GE(5 * band.begin, 2 * plain.begin) << "what the filter smears over the record's start";
    EXPECT_EQ(band.begin % band.decimation, 0U);
    slow_as_it_was += largest_prime_factor(plain.judged) > 13 ? 1 : 0;
    slow += largest_prime_factor(band.judged) > 13 ? 1 : 0;
  }
  EXPECT_GT(slow_as_it_was, 15);
  EXPECT_LE(4 * slow, slow_as_it_was);
}

}  // namespace
}  // namespace kolsky
