// One gauge on a bar with a free end: the pulse and its return, made by solvers in the time domain.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/identification/bar_identification.hpp"
#include "tests/generators/bar_response.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/table4.hpp"

namespace kolsky {
namespace {

using testing::BarShots;
using testing::kTable4;

BarShots::Setup one_gauge(double position_m = 1.0) {
  BarShots::Setup setup;
  setup.material = kTable4[0].material;
  setup.position_m = {position_m};
  setup.post_samples = 2400;
  return setup;
}

std::vector<Shot> draw(const BarShots::Setup& setup, std::size_t count, unsigned seed,
                       const BarShots::Recording& recording = {}) {
  std::mt19937_64 random(seed);
  return BarShots(setup).draw(count, recording, random);
}

void file_length(std::vector<Shot>& shots, const Measured& length_m) {
  for (Shot& shot : shots) {
    shot.bench.input.length_m = length_m;
  }
}

bool mentions(const std::vector<std::string>& texts, const std::string& words) {
  return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
    return text.find(words) != std::string::npos;
  });
}

/// What a refusal says; empty where there is none.
std::string refusal(const std::vector<Shot>& shots, const BarIdentificationOptions& options = {}) {
  try {
    (void)identify_bar(shots, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TwoPasses, OneGaugeIdentifiesABar) {
  const auto setup = one_gauge();
  const auto result = identify_bar(draw(setup, 5, 1), {.compare_solids = false});
  EXPECT_TRUE(result.two_passes);
  EXPECT_EQ(result.three_element.theory, WaveTheory::elementary);
  EXPECT_TRUE(result.wave_theory.told_apart);
  EXPECT_EQ(result.three_element.far_end, FarEndReturn::free);
  EXPECT_NEAR(result.three_element.chi2_reduced, 1.0, 0.15);
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
  const RodMaterial& m = setup.material;
  const double truth[3] = {m.E1_Pa, m.E2_Pa, m.eta2_Pa_s};
  for (std::size_t i = 0; i < 3; ++i) {
    const FittedNumber& p = result.three_element.parameters[i];
    EXPECT_NEAR(p.value, truth[i], 4.0 * p.sd) << p.name;
    EXPECT_LT(p.sd, 3e-3 * truth[i]) << p.name;
    ASSERT_EQ(result.paper.size(), 3U);
    EXPECT_NEAR(result.paper[i].value / truth[i], 1.0, i == 0 ? 0.01 : 0.1) << p.name;
  }
}

TEST(TwoPasses, AttenuationAndWavenumberComeFromIncidentAndReturn) {
  const auto setup = one_gauge();
  const auto result = identify_bar(draw(setup, 5, 2), {.compare_solids = false});
  const RodMaterial& m = setup.material;
  for (const BarSpectrum* spectrum : {&result.spectrum, &result.straight_lines}) {
    double chi2 = 0.0;
    double count = 0.0;
    for (std::size_t k = 0; k < spectrum->frequency_Hz.size(); ++k) {
      const double w = 2.0 * std::numbers::pi * spectrum->frequency_Hz[k];
      if (w > 2.0 * std::numbers::pi * 15e3) {
        break;
      }
      const Complex J = 1.0 / m.E1_Pa + 1.0 / Complex(m.E2_Pa, w * m.eta2_Pa_s);
      const Complex gamma = Complex(0.0, w) * std::sqrt(m.density_kg_m3 * J);
      const auto off = [&](const SpectrumLine& line, double truth) {
        return (line.mean[k] - truth) / line.sd_of_mean[k];
      };
      const double alpha = off(spectrum->alpha_per_m, gamma.real());
      const double wavenumber = off(spectrum->wavenumber_per_m, gamma.imag());
      EXPECT_LT(std::abs(alpha), 4.5) << spectrum->frequency_Hz[k];
      EXPECT_LT(std::abs(wavenumber), 4.5) << spectrum->frequency_Hz[k];
      chi2 += alpha * alpha + wavenumber * wavenumber;
      count += 2.0;
    }
    EXPECT_GT(count, 20.0);
    EXPECT_GT(chi2 / count, 0.4);
    EXPECT_LT(chi2 / count, 2.0);
  }
}

TEST(TwoPasses, CoversWhatItStatesWithTheBarsLengthOff) {
  constexpr int kRepeats = 30;
  constexpr Measured kLength{2.0, 0.5e-3};
  for (const std::size_t row : {0U, 1U}) {
    auto setup = one_gauge();
    setup.material = kTable4[row].material;
    const BarShots bar(setup);
    BarShots::Recording recording;
    recording.gain_sd = 0.01;
    recording.position_sd_m = 0.2e-3;
    const RodMaterial& m = setup.material;
    const double truth[3] = {m.E1_Pa, m.E2_Pa, m.eta2_Pa_s};
    std::mt19937_64 random(17);
    std::normal_distribution<double> normal(0.0, 1.0);
    int inside = 0;
    double squares = 0.0;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      auto shots = bar.draw(3, recording, random);
      file_length(shots, {kLength.value + kLength.sd * normal(random), kLength.sd});
      const BarFit fit = fit_bar(shots, {.theory = WaveTheory::elementary});
      for (std::size_t i = 0; i < 3; ++i) {
        const double z = (fit.parameters[i].value - truth[i]) / fit.parameters[i].sd;
        inside += std::abs(z) < 1.96 ? 1 : 0;
        squares += z * z;
      }
      // What the length and the place leave open of the way of 2 m, twice over in the modulus.
      EXPECT_GT(fit.parameters[0].sd / truth[0], 0.99 * 2.0 * std::hypot(0.5e-3, 0.2e-3));
    }
    // 90 intervals of 95 %: fewer than 76 inside once in ten thousand, if they were independent.
    EXPECT_GE(inside, 76) << row;
    EXPECT_LT(squares / (3.0 * kRepeats), 1.8) << row;
    EXPECT_GT(squares / (3.0 * kRepeats), 0.5) << row;
  }
}

/// A loss that is not there makes up no tail that would be refused.
TEST(TwoPasses, AnElasticBarServes) {
  auto setup = one_gauge();
  setup.material = {.density_kg_m3 = 2700.0, .E1_Pa = 70e9, .E2_Pa = 0.0, .eta2_Pa_s = 0.0};
  setup.post_samples = 1200;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto result = identify_bar(draw(setup, 2, seed), {.compare_solids = false});
    const FittedNumber& E1 = result.three_element.parameters[0];
    EXPECT_NEAR(E1.value, 70e9, 4.0 * E1.sd);
    EXPECT_LT(E1.sd, 1e-4 * 70e9);
    EXPECT_TRUE(mentions(result.warnings, "elastic"));
  }
}

TEST(TwoPasses, GainDoesNotMatter) {
  auto shots = draw(one_gauge(), 2, 4);
  const BarFit as_filed = fit_bar(shots, {.theory = WaveTheory::elementary});
  for (Shot& shot : shots) {
    shot.bench.gauges.front().strain_per_V = Measured{-1.3e-3, 0.1e-3};
  }
  const BarFit other = fit_bar(shots, {.theory = WaveTheory::elementary});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(other.parameters[i].value, as_filed.parameters[i].value,
                1e-3 * as_filed.parameters[i].sd);
    EXPECT_NEAR(other.parameters[i].sd, as_filed.parameters[i].sd,
                1e-3 * as_filed.parameters[i].sd);
  }
}

TEST(TwoPasses, WhatOneGaugeCannotServeIsRefusedWithWhatWouldBeNeeded) {
  auto setup = one_gauge();
  setup.pulse_s = 900e-6;
  EXPECT_NE(refusal(draw(setup, 1, 5)).find("still sees the pulse"), std::string::npos);
  const std::string near_end = refusal(draw(one_gauge(1.95), 1, 5));
  EXPECT_NE(near_end.find("before the far end"), std::string::npos) << near_end;
  const std::string near_start = refusal(draw(one_gauge(0.05), 1, 5));
  EXPECT_NE(near_start.find("behind that end"), std::string::npos) << near_start;
  setup = one_gauge();
  setup.post_samples = 1430;
  EXPECT_NE(refusal(draw(setup, 1, 5)).find("longer"), std::string::npos);
  setup.post_samples = 800;
  EXPECT_NE(refusal(draw(setup, 1, 5)).find("no inverted return"), std::string::npos);
  EXPECT_NE(refusal(draw(one_gauge(), 1, 5), {.far_end = FarEndReturn::none}).find("second gauge"),
            std::string::npos);
}

/// A hundredth of the pulse again, 650 us later: a striker that has not let go.
TEST(TwoPasses, WhatTheBarsCreepDoesNotExplainBeforeTheReturnIsRefused) {
  auto shots = draw(one_gauge(), 2, 6);
  for (Shot& shot : shots) {
    auto& codes = shot.channels.front().codes;
    for (std::size_t n = codes.size(); n-- > 650;) {
      codes[n] += static_cast<std::int32_t>(std::lround(0.01 * codes[n - 650]));
    }
  }
  const std::string said = refusal(shots);
  EXPECT_NE(said.find("beyond what the bar's own creep leaves"), std::string::npos) << said;
}

/// Of a bar whose far end returns -1 + r of the stress.
std::vector<Shot> shots_with_end(double r) {
  const RodMaterial& m = kTable4[0].material;
  testing::BarProblem problem;
  problem.material = testing::three_element(m.E1_Pa, m.E2_Pa, m.eta2_Pa_s);
  problem.stations_m = {1.0};
  problem.far_end = testing::FarEndReturn{2.0, r};
  problem.window_s = 2.2e-3;
  const testing::UnitSource source;
  const testing::Responses responses = testing::bar_response(problem, source);
  std::vector<double> push(22);
  for (std::size_t i = 0; i < push.size(); ++i) {
    push[i] = std::pow(std::sin(std::numbers::pi * static_cast<double>(i + 1) / 23.0), 2);
  }
  std::vector<double> strain =
      testing::superpose(responses.strain.front(), responses.step_s, push, 4, 1e-6, 0.0, 2200);
  const double peak = *std::max_element(strain.begin(), strain.end());
  for (double& value : strain) {
    value *= 2e-3 / peak;
  }
  strain.insert(strain.begin(), 300, 0.0);
  BarShots::Setup setup = one_gauge();
  BarShots::Setup small = setup;
  small.post_samples = 10;
  Bench bench = BarShots(small).bench({});
  bench.gauges.front().unit = "strain";
  bench.gauges.front().strain_per_V.reset();
  std::vector<Shot> shots;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    shots.push_back(testing::digitise(bench, {strain}, 4e-6, 16, 0.01, seed));
  }
  return shots;
}

TEST(TwoPasses, AnEndThatIsNotFreeIsFound) {
  const auto free = identify_bar(shots_with_end(0.0), {.compare_solids = false});
  EXPECT_EQ(free.three_element.far_end, FarEndReturn::free);
  EXPECT_FALSE(mentions(free.warnings, "far end"));
  const auto partial = identify_bar(shots_with_end(0.2), {.compare_solids = false});
  ASSERT_EQ(partial.three_element.far_end, FarEndReturn::partial);
  EXPECT_TRUE(mentions(partial.warnings, "far end"));
  const FittedNumber& R = *partial.three_element.reflection;
  EXPECT_NEAR(R.value, -0.8, 4.0 * R.sd);
  EXPECT_LT(R.sd, 0.02);
  EXPECT_NE(refusal(shots_with_end(2.0)).find("no inverted return"), std::string::npos);
}

}  // namespace
}  // namespace kolsky
