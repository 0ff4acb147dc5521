// Bars by a time-domain method, with lines in the noise that are of another phase in every record.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "processing/criticism/fitting/study.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

/// Nothing hidden.
Campaign between_lines(std::uint64_t seed) {
  const testing::Campaign campaign = testing::draw_campaign(
      {.seed = seed, .shots = 6, .gauges = 2, .noise_strain = 2e-6, .bits = 0, .rate_Hz = 1e6});
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  for (auto& shot : readings) {
    for (std::vector<double>& reading : shot) {
      for (const double line_Hz : {11e3, 23e3}) {
        const double begins = phase(random);
        for (std::size_t n = 0; n < reading.size(); ++n) {
          reading[n] +=
              3e-6 *
              std::cos(2.0 * std::numbers::pi * line_Hz * 1e-6 * static_cast<double>(n) + begins);
        }
      }
    }
  }
  return read_campaign(testing::shots_of(campaign, readings));
}

// Against the mean over all frequencies what chance makes of a line came back beyond all noise.
TEST(UnevenNoise, DoesNotRepeat) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Campaign campaign = between_lines(seed);
    Study study(campaign, 0.0, Workers{});
    const Studied studied = study.fit(paper_model(BenchKind::bar, false));
    EXPECT_GT(studied.misfit.repeatable_log_p, std::log(1e-3)) << seed;
  }
}

}  // namespace
}  // namespace kolsky
