// The paper's straight lines on waves added up one frequency at a time from a known attenuation and
// wavenumber: no transform, and no wave theory beyond the exponential itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/identification/bar_fit.hpp"
#include "processing/identification/bar_spectrum.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/table4.hpp"

namespace kolsky {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kLine_Hz = 100.0;  ///< between frequencies that are added up
constexpr double kTop_Hz = 60e3;
constexpr double kLead_s = 400e-6;
constexpr std::size_t kSamples = 3200;
constexpr std::size_t kShots = 12;
constexpr double kBar_m = 8.0;  ///< nothing comes back within the records

struct Propagation {
  double alpha_per_m;
  double wavenumber_per_m;
};

Propagation propagation(double frequency_Hz) {
  const RodMaterial& m = testing::kTable4[0].material;
  const double w = kTwoPi * frequency_Hz;
  const double late = 1.0 / (m.E2_Pa * m.E2_Pa + w * w * m.eta2_Pa_s * m.eta2_Pa_s);
  const double J1 = 1.0 / m.E1_Pa + m.E2_Pa * late;
  const double J2 = w * m.eta2_Pa_s * late;
  const double size = std::hypot(J1, J2);
  return {w * std::sqrt(m.density_kg_m3 * (size - J1) / 2.0),
          w * std::sqrt(m.density_kg_m3 * (size + J1) / 2.0)};
}

/// A rectangle of strain with bell-shaped flanks, which begins at 0: spectrum at a frequency.
std::complex<double> rectangle(double frequency_Hz, double length_s) {
  constexpr double kFlank_s = 6e-6;
  const double w = kTwoPi * frequency_Hz;
  const double bell = std::exp(-0.5 * std::pow(w * kFlank_s, 2));
  const double level = frequency_Hz > 0.0 ? 2.0 * std::sin(w * length_s / 2.0) / w : length_s;
  return std::polar(bell, -w * length_s / 2.0) * level;
}

using Source = std::complex<double> (*)(double frequency_Hz);

/// Nothing at 5, 10, 15 kHz and so on.
std::complex<double> with_nulls(double frequency_Hz) {
  return rectangle(frequency_Hz, 200e-6);
}
/// As much pull as push: next to nothing at the lowest frequencies.
std::complex<double> without_lowest(double frequency_Hz) {
  return rectangle(frequency_Hz, 60e-6) * (1.0 - std::polar(1.0, -kTwoPi * frequency_Hz * 60e-6));
}

/// Nothing but noise about 7 kHz, frequency after frequency.
std::complex<double> with_gap(double frequency_Hz) {
  constexpr double kGap_Hz = 7e3;
  const double off = (kGap_Hz - frequency_Hz) * (kGap_Hz + frequency_Hz);
  const std::complex<double> notch = off / std::complex<double>(off, frequency_Hz * kGap_Hz);
  return rectangle(frequency_Hz, 30e-6) * notch * notch;
}

std::vector<double> strain_at(double x_m, Source source) {
  std::vector<double> strain(kSamples, 0.0);
  for (double f = 0.0; f <= kTop_Hz; f += kLine_Hz) {
    const Propagation p = propagation(f);
    const std::complex<double> wave =
        source(f) * std::polar(std::exp(-p.alpha_per_m * x_m), -p.wavenumber_per_m * x_m);
    const std::complex<double> turn = std::polar(1.0, kTwoPi * f * 1e-6);
    std::complex<double> at = wave * std::polar(1.0, -kTwoPi * f * kLead_s);
    for (double& value : strain) {
      value += (f > 0.0 ? 2.0 : 1.0) * kLine_Hz * at.real();
      at *= turn;
    }
  }
  return strain;
}

struct Setup {
  Source source;
  std::vector<double> position_m;
  double peak_strain = 2e-3;
  double noise_strain = 4e-6;
};

Bench bench_of(const std::vector<double>& position_m) {
  const RodMaterial& m = testing::kTable4[0].material;
  Bench bench;
  bench.kind = BenchKind::bar;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {kBar_m};
  bench.input.diameter_m = {0.020};
  bench.input.density_kg_m3 = {m.density_kg_m3};
  bench.input.poisson_ratio = {0.36};
  for (const double x : position_m) {
    Gauge gauge;
    gauge.name = "g" + std::to_string(bench.gauges.size() + 1);
    gauge.bar = "input";
    gauge.position_m = {x};
    gauge.unit = "V";
    gauge.strain_per_V = Measured{1.0};
    bench.gauges.push_back(gauge);
  }
  return bench;
}

std::vector<Shot> draw(const Setup& setup, std::size_t count) {
  std::vector<std::vector<double>> records;
  for (const double x : setup.position_m) {
    records.push_back(strain_at(x, setup.source));
    for (double& value : records.back()) {
      value *= setup.peak_strain;
    }
  }
  std::vector<Shot> shots;
  for (unsigned seed = 1; seed <= count; ++seed) {
    shots.push_back(
        testing::digitise(bench_of(setup.position_m), records, setup.noise_strain, 16, 0.01, seed));
  }
  return shots;
}

/// Where the pulse has something to say. In its nulls the logarithm of noise is what it is.
bool told(Source source, double frequency_Hz) {
  double largest = 0.0;
  for (double f = 0.0; f < 15e3; f += kLine_Hz) {
    largest = std::max(largest, std::abs(source(f)));
  }
  return std::abs(source(frequency_Hz)) > 0.15 * largest;
}

void expect_propagation(const Setup& setup) {
  const BarData data(draw(setup, kShots), 0.0);
  const BarFit fit = fit_bar(data, {.waves = WaveTheory::elementary});
  const BarSpectrum spectrum = straight_line_spectrum(data, fit);
  int count = 0;
  double squares = 0.0;
  for (std::size_t k = 0; k < spectrum.frequency_Hz.size(); ++k) {
    const double f = spectrum.frequency_Hz[k];
    if (f > 15e3 || !told(setup.source, f)) {
      continue;
    }
    const Propagation truth = propagation(f);
    const double alpha =
        (spectrum.alpha_per_m.mean[k] - truth.alpha_per_m) / spectrum.alpha_per_m.sd_of_mean[k];
    const double wavenumber = (spectrum.wavenumber_per_m.mean[k] - truth.wavenumber_per_m) /
                              spectrum.wavenumber_per_m.sd_of_mean[k];
    EXPECT_LT(std::abs(alpha), 5.0) << f;
    EXPECT_LT(std::abs(wavenumber), 5.0) << f;
    squares += alpha * alpha + wavenumber * wavenumber;
    count += 2;
  }
  EXPECT_GT(count, 30);
  // Student's t of eleven degrees of freedom squares to 11/9 on average.
  EXPECT_GT(squares / count, 0.6);
  EXPECT_LT(squares / count, 1.8);
}

TEST(StraightLines, AreDrawnAcrossNullsOfThePulse) {
  expect_propagation({with_nulls, {0.1, 0.3, 0.5, 0.7}});
  expect_propagation({with_nulls, {0.1, 0.3, 0.5, 0.7}, 2e-3, 40e-6});
}

TEST(StraightLines, AreNotTurnedByLowestFrequenciesThatHoldNoise) {
  expect_propagation({without_lowest, {0.1, 0.3, 0.5, 0.7}});
  expect_propagation({without_lowest, {0.1, 0.3, 0.5, 0.7}, 2e-3, 40e-6});
}

TEST(StraightLines, AreNotTurnedByAGapInThePulse) {
  expect_propagation({with_gap, {0.1, 0.3, 0.5, 0.7}});
  expect_propagation({with_gap, {0.1, 0.3, 0.5, 0.7}, 2e-3, 40e-6});
}

// At 15 kHz the last gauge is some ten turns behind the first.
TEST(StraightLines, GoOnOverManyTurns) {
  const std::vector<double> far = {0.1, 1.1, 2.1};
  EXPECT_GT(propagation(15e3).wavenumber_per_m * 2.0, 10.0 * kTwoPi);
  expect_propagation({with_nulls, far});
  expect_propagation({without_lowest, far});
  expect_propagation({with_gap, far});
}

}  // namespace
}  // namespace kolsky
