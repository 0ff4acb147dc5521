#include "processing/separation/separation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "processing/base/error.hpp"
#include "tests/generators/bar_shots.hpp"

namespace kolsky {
namespace {

Bar steel(double length_m, double diameter_m) {
  Bar bar;
  bar.length_m = {length_m};
  bar.diameter_m = {diameter_m};
  bar.density_kg_m3 = {7850.0};
  bar.poisson_ratio = {0.3};
  bar.youngs_modulus_Pa = Measured{206e9};
  return bar;
}

std::map<std::string, std::vector<double>> table(const std::filesystem::path& path) {
  std::map<std::string, std::vector<double>> columns;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) {
    names.push_back(name);
  }
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::size_t i = 0;
    for (std::string cell; std::getline(cells, cell, ',') && i < names.size(); ++i) {
      columns[names[i]].push_back(std::stod(cell));
    }
  }
  return columns;
}

/// At even steps, by straight lines.
std::vector<double> resampled(const std::vector<double>& time_s, const std::vector<double>& value,
                              double step_s) {
  std::vector<double> even;
  std::size_t n = 0;
  for (double t = time_s.front(); t <= time_s.back(); t += step_s) {
    while (n + 2 < time_s.size() && time_s[n + 1] < t) {
      ++n;
    }
    const double share = (t - time_s[n]) / (time_s[n + 1] - time_s[n]);
    even.push_back(value[n] + share * (value[n + 1] - value[n]));
  }
  return even;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> left;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
    left.push_back(a[n] - b[n]);
  }
  return rms(left);
}

struct FiniteElements {
  const char* folder;
  double length_m, diameter_m, specimen_diameter_m, step_s, band_Hz;
  double loaded_s;
  double velocity_share, stress_share;  ///< allowed, rms over rms
};

class OutputBar : public ::testing::TestWithParam<FiniteElements> {};

/// One gauge, a free end behind it, several passes over each other: the specimen's side of the
/// output bar against what the finite elements had there.
TEST_P(OutputBar, MovesAndCarriesAsTheFiniteElementsHadIt) {
  const FiniteElements& set = GetParam();
  const auto file = std::filesystem::path(KOLSKY_SHARED_DATA) / "fe/wave-separation" / set.folder /
                    "gauge_strain_records.csv";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "no " << file;
  }
  const auto columns = table(file);
  const auto& time = columns.at("time_s");
  const auto strain = resampled(time, columns.at("gauge2_transmission_bar_strain"), set.step_s);
  const Bar bar = steel(set.length_m, set.diameter_m);
  const ElasticSolid solid(*bar.youngs_modulus_Pa);
  const WaveSeparation separation(bar, solid, WaveTheory::exact, {{0.25, strain, 0.0}},
                                  {.start = false, .end = true}, set.step_s, set.band_Hz);
  const SeparatedWaves face = separation.at(0.0);
  auto velocity = resampled(time, columns.at("transmitted_end_mean_v3_mm_per_s"), set.step_s);
  for (double& value : velocity) {
    value *= 1e-3;
  }
  // The last passage to the gauge is not in its record.
  const auto seen = static_cast<std::size_t>(0.25 / 5122.0 / set.step_s) + 5;
  auto known = face.velocity_m_per_s;
  known.resize(known.size() - seen);
  EXPECT_LT(rms_difference(known, velocity), set.velocity_share * rms(velocity));
  std::printf("%s: velocity off by %.2f %% rms\n", set.folder,
              100.0 * rms_difference(known, velocity) / rms(velocity));

  auto stress = resampled(time, columns.at("specimen_mean_compressive_s33_MPa"), set.step_s);
  const auto log_strain = resampled(time, columns.at("specimen_mean_compressive_le33"), set.step_s);
  const double area_ratio = std::pow(set.diameter_m / set.specimen_diameter_m, 2);
  auto force_based = face.stress_Pa;
  force_based.resize(known.size());
  for (std::size_t n = 0; n < force_based.size(); ++n) {
    force_based[n] *= area_ratio * 1e-6;
    if (std::string(set.folder) == "copper") {
      stress[n] *= std::exp(log_strain[n]);  // Cauchy, of a specimen that keeps its volume
    }
  }
  // Afterwards the specimen is loose between the bars.
  force_based.resize(static_cast<std::size_t>(set.loaded_s / set.step_s));
  stress.resize(force_based.size());
  std::printf("%s: stress off by %.2f %% rms\n", set.folder,
              100.0 * rms_difference(force_based, stress) / rms(stress));
  EXPECT_LT(rms_difference(force_based, stress), set.stress_share * rms(stress));
}

INSTANTIATE_TEST_SUITE_P(Sets, OutputBar,
                         ::testing::Values(FiniteElements{"copper", 1.0, 0.016, 0.008, 2.5e-6, 80e3,
                                                          740e-6, 0.03, 0.012},
                                           FiniteElements{"aluminum_foam", 1.6, 0.050, 0.030, 10e-6,
                                                          20e3, 8.2e-3, 0.004, 0.033}));

/// A viscoelastic bar that rings for two passages: two gauges give what a third one saw.
TEST(WaveSeparation, TwoGaugesForetellAThird) {
  testing::BarShots::Setup setup;
  setup.material = {1180.0, 5.66e9, 37.0e9, 1.81e6};
  setup.length_m = 1.0;
  setup.position_m = {0.2, 0.5, 0.65};
  const testing::BarShots shots(setup);
  Bar bar;
  bar.length_m = {1.0};
  bar.diameter_m = {0.02};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  const ThreeElementSolid pmma(5.66e9, 37.0e9, 1.81e6);
  const WaveSeparation separation(bar, pmma, WaveTheory::elementary,
                                  {{0.2, shots.strain(0), 1.0}, {0.65, shots.strain(2), 1.0}}, {},
                                  1e-6, 60e3);
  const SeparatedWaves there = separation.at(0.5);
  std::vector<double> sum(there.right_going);
  for (std::size_t n = 0; n < sum.size(); ++n) {
    sum[n] += there.left_going[n];
  }
  std::vector<double> truth = shots.strain(1);
  sum.resize(sum.size() - 400);
  truth.resize(sum.size());
  EXPECT_LT(rms_difference(sum, truth), 5e-3 * rms(truth));
  // Blind where they tell the waves' sum alone, and where half a wave fits between them.
  const auto blind =
      blind_frequencies(bar, pmma, WaveTheory::elementary,
                        {{0.2, shots.strain(0), 1.0}, {0.65, shots.strain(2), 1.0}}, {}, 60e3);
  ASSERT_GE(blind.size(), 2U);
  EXPECT_LT(blind[0].frequency_Hz, 100.0);
  EXPECT_NEAR(blind[1].frequency_Hz, 2160.0 / 2.0 / 0.45, 100.0);
}

/// One gauge and the force at the far end, as a specimen passes it to the other bar: the same waves
/// as two gauges give, against records of a solver that knows neither.
TEST(WaveSeparation, AKnownStressAtAnEndServesLikeAGauge) {
  testing::BarShots::Setup setup;
  setup.material = {1180.0, 5.66e9, 37.0e9, 1.81e6};
  setup.length_m = 1.0;
  setup.position_m = {0.2, 0.5};
  const testing::BarShots shots(setup);
  Bar bar;
  bar.length_m = {1.0};
  bar.diameter_m = {0.02};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  const ThreeElementSolid pmma(5.66e9, 37.0e9, 1.81e6);
  // The far end of these shots is free: no stress there, at any time.
  const std::vector<double> none(shots.strain(0).size(), 0.0);
  const auto off_at_second = [&](double end_m) {
    const WaveSeparation separation(
        bar, pmma, WaveTheory::elementary,
        {{0.2, shots.strain(0), 0.0}, {end_m, none, 0.0, SeparationRecord::mean_stress_Pa}}, {},
        1e-6, 60e3);
    const SeparatedWaves there = separation.at(0.5);
    std::vector<double> sum(there.right_going);
    for (std::size_t n = 0; n < sum.size(); ++n) {
      sum[n] += there.left_going[n];
    }
    std::vector<double> truth = shots.strain(1);
    sum.resize(sum.size() - 400);
    truth.resize(sum.size());
    return rms_difference(sum, truth) / rms(truth);
  };
  EXPECT_LT(off_at_second(1.0), 5e-3);
  EXPECT_GT(off_at_second(0.99), 2e-2);
}

/// The stress that one separation finds at a place, given to another, serves like the gauge that
/// was there: units and stiffness.
TEST(WaveSeparation, StressAndStrainOfOnePlaceTellTheSame) {
  testing::BarShots::Setup setup;
  setup.material = {1180.0, 5.66e9, 37.0e9, 1.81e6};
  setup.length_m = 1.0;
  setup.position_m = {0.2, 0.65};
  const testing::BarShots shots(setup);
  Bar bar;
  bar.length_m = {1.0};
  bar.diameter_m = {0.02};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  const ThreeElementSolid pmma(5.66e9, 37.0e9, 1.81e6);
  const SeparationGauge first{0.2, shots.strain(0), 0.0};
  const WaveSeparation strains(bar, pmma, WaveTheory::exact, {first, {0.65, shots.strain(1), 0.0}},
                               {}, 1e-6, 60e3);
  const SeparatedWaves known = strains.at(0.65);
  const WaveSeparation stresses(
      bar, pmma, WaveTheory::exact,
      {first, {0.65, known.stress_Pa, 0.0, SeparationRecord::mean_stress_Pa}}, {}, 1e-6, 60e3);
  const SeparatedWaves again = stresses.at(0.4);
  const SeparatedWaves once = strains.at(0.4);
  const std::size_t quarter = known.stress_Pa.size() / 4;
  const std::vector<double> a(once.right_going.begin(), once.right_going.end() - quarter);
  const std::vector<double> b(again.right_going.begin(), again.right_going.end() - quarter);
  EXPECT_LT(rms_difference(b, a), 0.01 * rms(a));
}

/// A band's flank reaches to where Love's waves stand still (182 kHz) and on: what is beyond what
/// is seen must not spoil what the records hold, which is all within either band.
TEST(WaveSeparation, LovesWavesAreHeldBeyondWhatIsSeen) {
  testing::BarShots::Setup setup;
  setup.material = {1180.0, 5.66e9, 37.0e9, 1.81e6};
  setup.length_m = 1.0;
  setup.position_m = {0.2, 0.5, 0.65};
  setup.pulse_s = 200e-6;
  setup.ramp_s = 100e-6;
  const testing::BarShots shots(setup);
  Bar bar;
  bar.length_m = {1.0};
  bar.diameter_m = {0.015};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  const ThreeElementSolid pmma(5.66e9, 37.0e9, 1.81e6);
  const std::vector<SeparationGauge> gauges = {{0.2, shots.strain(0), 1.0},
                                               {0.65, shots.strain(2), 1.0}};
  const auto strain_up_to = [&](double band_limit_Hz) {
    const WaveSeparation separation(bar, pmma, WaveTheory::love, gauges, {}, 1e-6, band_limit_Hz);
    const SeparatedWaves there = separation.at(0.5);
    std::vector<double> sum(there.right_going);
    for (std::size_t n = 0; n < sum.size(); ++n) {
      sum[n] += there.left_going[n];
    }
    sum.resize(sum.size() - 400);
    return sum;
  };
  const std::vector<double> below = strain_up_to(40e3);
  ASSERT_GT(rms(below), 0.0);
  EXPECT_LT(rms_difference(strain_up_to(90e3), below), 5e-3 * rms(below));
  for (const BlindFrequency& blind :
       blind_frequencies(bar, pmma, WaveTheory::love, gauges, {}, 300e3)) {
    EXPECT_TRUE(std::isfinite(blind.noise_gain)) << blind.frequency_Hz;
  }
}

TEST(WaveSeparation, BlindFrequenciesOfOneGaugeBeforeAFreeEnd) {
  const Bar bar = steel(1.0, 0.016);
  const ElasticSolid solid(206e9);
  const std::vector<double> silence(2000, 0.0);
  const auto blind = blind_frequencies(bar, solid, WaveTheory::elementary, {{0.25, silence, 0.0}},
                                       {.start = false, .end = true}, 12e3);
  // Nodes of strain: n c / (2 (L - x)).
  const double c = std::sqrt(206e9 / 7850.0);
  ASSERT_GE(blind.size(), 3U);
  EXPECT_NEAR(blind[1].frequency_Hz, c / 1.5, 5.0);
  EXPECT_NEAR(blind[2].frequency_Hz, 2.0 * c / 1.5, 5.0);
}

TEST(WaveSeparation, WhatDoesNotSufficeIsRefused) {
  const Bar bar = steel(1.0, 0.016);
  const ElasticSolid solid(206e9);
  const std::vector<double> silence(500, 0.0);
  const auto separate = [&](const std::vector<SeparationGauge>& gauges, FreeEnds ends) {
    (void)WaveSeparation(bar, solid, WaveTheory::exact, gauges, ends, 1e-6, 20e3);
  };
  EXPECT_THROW(separate({{0.2, silence, 0.0}}, {}), InputError);
  EXPECT_THROW(separate({{0.2, silence, 0.0}, {0.2, silence, 0.0}}, {}), InputError);
  EXPECT_THROW(separate({{1.2, silence, 0.0}}, {.start = false, .end = true}), InputError);
  EXPECT_THROW(separate({}, {.start = true, .end = false}), InputError);
  EXPECT_THROW(separate({{0.2, silence, 0.0}}, {.start = true, .end = true}), InputError);
}

}  // namespace
}  // namespace kolsky
