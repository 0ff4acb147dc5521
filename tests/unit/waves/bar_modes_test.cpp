#include "processing/waves/bar_modes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

Bar pmma_bar() {
  Bar bar;
  bar.diameter_m = {0.020};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  return bar;
}

/// gamma at each frequency, reached from 50 Hz in small steps.
std::vector<Complex> gammas(WaveTheory theory, const std::vector<double>& frequencies_Hz) {
  const ThreeElementSolid pmma(paper_pmma());
  std::vector<Complex> path;
  for (int step = 1; step <= 2000; ++step) {
    path.emplace_back(0.0, kTwoPi * 50.0 * step);
  }
  const auto modes = bar_modes(theory, pmma_bar(), pmma, path);
  std::vector<Complex> found;
  for (const double frequency_Hz : frequencies_Hz) {
    found.push_back(modes[static_cast<std::size_t>(frequency_Hz / 50.0) - 1].gamma);
  }
  return found;
}

struct Published {
  double frequency_Hz;
  double alpha_per_m;
  double speed_m_per_s;
};

// The paper's PMMA, 20 mm diameter: values checked in high precision outside this project.
class PublishedWaves
    : public ::testing::TestWithParam<std::pair<WaveTheory, std::vector<Published>>> {};

TEST_P(PublishedWaves, AgreeToTheDigitsGiven) {
  const auto& [theory, rows] = GetParam();
  for (const Published& row : rows) {
    const Complex gamma = gammas(theory, {row.frequency_Hz}).front();
    EXPECT_NEAR(gamma.real(), row.alpha_per_m, 5e-6) << row.frequency_Hz;
    EXPECT_NEAR(kTwoPi * row.frequency_Hz / gamma.imag(), row.speed_m_per_s, 5e-3)
        << row.frequency_Hz;
  }
}

INSTANTIATE_TEST_SUITE_P(
    EachTheory, PublishedWaves,
    ::testing::Values(
        std::pair{WaveTheory::elementary, std::vector<Published>{{10e3, 0.64074, 2173.72},
                                                                 {20e3, 0.69408, 2185.65},
                                                                 {40e3, 0.70884, 2188.97}}},
        std::pair{WaveTheory::love, std::vector<Published>{{10e3, 0.64598, 2167.84},
                                                           {20e3, 0.71700, 2162.13},
                                                           {40e3, 0.81044, 2093.41}}},
        std::pair{WaveTheory::exact, std::vector<Published>{{10e3, 0.64610, 2167.76},
                                                            {20e3, 0.71924, 2160.79},
                                                            {40e3, 0.86723, 2066.61}}}));

TEST(ElementaryWaves, ObeyEquationNine) {
  for (const double frequency_Hz : {50.0, 1e3, 4e3, 50e3}) {
    const double omega = kTwoPi * frequency_Hz;
    const Complex gamma = gammas(WaveTheory::elementary, {frequency_Hz}).front();
    // J1 and J2 of eq. (A3), written out.
    const double d = 37.0e9 * 37.0e9 + omega * 1.81e6 * omega * 1.81e6;
    const double J1 = 1.0 / 5.66e9 + 37.0e9 / d;
    const double J2 = omega * 1.81e6 / d;
    const double alpha = gamma.real();
    const double k = gamma.imag();
    EXPECT_NEAR(k * k - alpha * alpha, 1180.0 * omega * omega * J1, 1e-9 * k * k);
    EXPECT_NEAR(2.0 * alpha * k, 1180.0 * omega * omega * J2, 1e-9 * k * k);
  }
}

TEST(ElementaryWaves, DecayEverywhereInTheRightHalfPlane) {
  const ThreeElementSolid pmma(paper_pmma());
  for (const double eta : {1.0, 1e3, 1e5}) {
    for (const BarMode& mode : bar_modes(WaveTheory::elementary, pmma_bar(), pmma,
                                         {{eta, 0.0}, {eta, 1e2}, {eta, 1e4}, {eta, 1e7}})) {
      EXPECT_GT(mode.gamma.real(), 0.0);
    }
  }
}

TEST(ElementaryWaves, AnElasticBarOnlyDelays) {
  const ElasticSolid steel(206e9);
  Bar bar;
  bar.density_kg_m3 = {7850.0};
  const Complex gamma = bar_modes(WaveTheory::elementary, bar, steel, {{0.0, 1e5}}).front().gamma;
  EXPECT_EQ(gamma.real(), 0.0);
  EXPECT_NEAR(gamma.imag(), 1e5 / std::sqrt(206e9 / 7850.0), 1e-9);
  EXPECT_NEAR(front_speed_m_per_s(bar, steel), std::sqrt(206e9 / 7850.0), 1e-9);
}

TEST(BlindFrom, IsNearTheKnownFrequencyOfSurfaceGauges) {
  // Surface gauges read nothing near f a / c0 = 0.30.
  const ElasticSolid unit(1.0);
  Bar bar;
  bar.diameter_m = {2.0};
  bar.density_kg_m3 = {1.0};
  bar.poisson_ratio = {0.30};
  std::vector<Complex> path;
  for (int step = 1; step <= 400; ++step) {
    path.emplace_back(0.0, kTwoPi * 0.001 * step);
  }
  const auto modes = bar_modes(WaveTheory::exact, bar, unit, path);
  EXPECT_NEAR(blind_from_Hz(modes, path), 0.26, 0.03);
  const auto thin = bar_modes(WaveTheory::elementary, bar, unit, path);
  EXPECT_EQ(blind_from_Hz(thin, path), std::numeric_limits<double>::infinity());
}

// A band that a user gives is not beyond what it is itself.
TEST(BlindFrom, IsNotBelowABandInWhichNothingIsBlind) {
  const ThreeElementSolid pmma(paper_pmma());
  for (const double highest_Hz : {52208.24682190047, 7930.420743478792, 56123.07}) {
    EXPECT_GE(blind_from_Hz(WaveTheory::elementary, pmma_bar(), pmma, highest_Hz), highest_Hz);
  }
}

TEST(WaveTheoryName, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(wave_theory("love"), WaveTheory::love);
  EXPECT_THROW((void)wave_theory("Rayleigh"), InputError);
}

TEST(ComplianceOf, TheBenchDecidesWhetherABarIsElastic) {
  Bar bar;
  EXPECT_NEAR(compliance_of(bar, paper_pmma())->instantaneous(), 1.0 / 5.66e9, 1e-20);
  bar.youngs_modulus_Pa = Measured{113e9};
  EXPECT_NEAR(compliance_of(bar, paper_pmma())->instantaneous(), 1.0 / 113e9, 1e-20);
}

}  // namespace
}  // namespace kolsky
