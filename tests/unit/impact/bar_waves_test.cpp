#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "processing/base/material.hpp"
#include "tests/generators/impact_bar.hpp"
#include "tests/unit/impact/fine_meshes.hpp"

namespace kolsky::testing {
namespace {

constexpr double kTitanium_Pa = 113e9;
const double kTitanium_m_per_s = std::sqrt(kTitanium_Pa / 4420.0);

PressedBar titanium(std::size_t across) {
  PressedBar bar;
  bar.diameter_m = 0.027;
  bar.length_m = 1.3;
  bar.solid = impact::elastic_solid(4420.0, kTitanium_Pa, 0.33);
  bar.across = across;
  bar.gauges_m = {0.25, 0.55};
  bar.duration_s = 3.2e-4;
  bar.pressure_Pa = bell(15e-6, 1e6);
  return bar;
}

// Pochhammer and Chree, nu 0.33, a 13.5 mm.
constexpr std::array<std::pair<double, double>, 7> kTitaniumPhase = {{{10e3, 0.99923},
                                                                      {20e3, 0.99687},
                                                                      {30e3, 0.99275},
                                                                      {50e3, 0.97785},
                                                                      {60e3, 0.96573},
                                                                      {80e3, 0.92503},
                                                                      {100e3, 0.84124}}};

TEST(TitaniumBar, PhaseVelocityIsPochhammersAndChrees) {
  const BarRecords records = press(titanium(fine_meshes() ? 20 : 12));
  for (const auto& [frequency_Hz, expected] : kTitaniumPhase) {
    if (frequency_Hz > 60e3 && !fine_meshes()) {
      continue;
    }
    const double ratio =
        wave_between(records, 0.3, frequency_Hz, expected * kTitanium_m_per_s).speed_m_per_s /
        kTitanium_m_per_s;
    const double bound = !fine_meshes() ? 5e-4 : frequency_Hz > 60e3 ? 1.5e-3 : 2e-4;
    EXPECT_NEAR(ratio, expected, bound * expected) << frequency_Hz;
  }
}

TEST(TitaniumBar, BehindAStepOfPressureTheStrainIsPressureOverModulus) {
  PressedBar bar = titanium(4);
  bar.length_m = 0.8;
  bar.gauges_m = {0.2};
  bar.duration_s = 1.9e-4;
  bar.pressure_Pa = [](double) { return 20e6; };
  const BarRecords records = press(bar);
  double sum = 0.0;
  int count = 0;
  for (std::size_t n = 0; n < records.strain[0].size(); ++n) {
    const double after_s = static_cast<double>(n) * records.interval_s - 0.2 / kTitanium_m_per_s;
    if (after_s > 60e-6) {
      sum += records.strain[0][n];
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 20e6 / kTitanium_Pa, 2e-3 * 20e6 / kTitanium_Pa);
}

struct PmmaRow {
  double frequency_Hz;
  double speed_m_per_s;
  double attenuation_per_m;
};

// Exact, 20 mm in diameter, paper's Table 4 row 1, full relaxation with one Poisson's ratio.
constexpr std::array<PmmaRow, 3> kPmma = {
    {{10e3, 2167.8, 0.6461}, {15e3, 2168.7, 0.6926}, {20e3, 2160.8, 0.7192}}};

PressedBar pmma(std::size_t across) {
  PressedBar bar;
  bar.diameter_m = 0.020;
  bar.length_m = 1.0;
  bar.solid = impact::solid_of(paper_pmma(), impact::Reading::full);
  bar.across = across;
  bar.gauges_m = {0.15, 0.45};
  bar.duration_s = 6.5e-4;
  bar.pressure_Pa = bell(40e-6, 1e6);
  return bar;
}

TEST(PmmaBar, PhaseVelocityAndAttenuationAreTheExactOnes) {
  const BarRecords records = press(pmma(fine_meshes() ? 16 : 8));
  for (const PmmaRow& row : kPmma) {
    const BarWave wave = wave_between(records, 0.3, row.frequency_Hz, row.speed_m_per_s);
    EXPECT_NEAR(wave.speed_m_per_s, row.speed_m_per_s, 2e-4 * row.speed_m_per_s);
    EXPECT_NEAR(wave.attenuation_per_m, row.attenuation_per_m, 2e-3 * row.attenuation_per_m);
  }
}

}  // namespace
}  // namespace kolsky::testing
