// Delays alone: a trapezoid that passes every gauge of an elastic bar, exact at every sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr double kPeriod_s = 5e-7;
constexpr double kPlateau_s = 150e-6;
constexpr double kRise_s = 16e-6;

double trapezoid(double t_s) {
  const double rises = t_s / kRise_s;
  const double falls = (kPlateau_s + 2.0 * kRise_s - t_s) / kRise_s;
  return std::clamp(std::min(rises, falls), 0.0, 1.0);
}

/// Nothing hidden; the first gauge's noise is twice the others'.
Campaign passing_pulses(std::uint64_t seed) {
  testing::Campaign campaign = testing::draw_campaign({.seed = 5,
                                                       .shots = 8,
                                                       .gauges = 4,
                                                       .noise_strain = 1e-9,
                                                       .bits = 0,
                                                       .samples = 2400,
                                                       .rate_Hz = 1.0 / kPeriod_s,
                                                       .elastic = true});
  Bench& bench = campaign.bench;
  const std::vector<double> positions_m{0.149, 0.604, 1.088, 2.073};
  const double speed_m_s =
      std::sqrt(bench.input.youngs_modulus_Pa->value / bench.input.density_kg_m3.value);
  bench.input.length_m.value = 2.528;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  for (std::size_t n = 0; n < readings.size(); ++n) {
    const double peak = 3e-4 + 4e-5 * static_cast<double>(n);
    for (std::size_t j = 0; j < positions_m.size(); ++j) {
      bench.gauges[j].position_m.value = positions_m[j];
      const double arrives_s = 150e-6 + positions_m[j] / speed_m_s;
      const double noise = j == 0 ? 4e-6 : 2e-6;
      for (std::size_t i = 0; i < readings[n][j].size(); ++i) {
        const double t_s = static_cast<double>(i) * kPeriod_s - arrives_s;
        readings[n][j][i] = peak * trapezoid(t_s) + noise * normal(random);
      }
    }
  }
  return read_campaign(testing::shots_of(campaign, readings));
}

// Of e^2 at every gauge the source leaves nothing there but what is made of the gauges' noise,
// which found itself in the residuals: each of these was unknown.
TEST(BentSignals, AreNotMadeOfTheGaugesNoise) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Campaign campaign = passing_pulses(seed);
    Study study(campaign, 0.0, Workers{});
    const Diagnosis diagnosis = diagnose(study, paper_model(BenchKind::bar, true), {});
    EXPECT_EQ(name_of(diagnosis.verdict), "adequate") << seed;
    EXPECT_GT(diagnosis.unexplained_log_p, std::log(0.01)) << seed;
  }
}

}  // namespace
}  // namespace kolsky
