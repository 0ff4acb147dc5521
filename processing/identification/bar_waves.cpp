#include "processing/identification/bar_waves.hpp"

#include <cmath>

#include "processing/waves/each_exp.hpp"

namespace kolsky {

namespace {

/// sinh(z) / z.
Complex sinhc(Complex z) {
  return std::abs(z) < 1e-3 ? 1.0 + z * z / 6.0 : std::sinh(z) / z;
}

/// d log sinhc(z) / dz = coth(z) - 1/z.
Complex log_slope_of_sinhc(Complex z) {
  return std::abs(z) < 1e-2 ? z / 3.0 : 1.0 / std::tanh(z) - 1.0 / z;
}

}  // namespace

BarWaves::BarWaves(WaveTheory theory, const MovedBench& bench, const Compliance& solid,
                   double far_end, bool with_echo, std::vector<double> gauge_length_m,
                   const std::vector<Complex>& path)
    : modes(bar_modes(theory, bench.bar, solid, path)),
      reflection(far_end),
      length_m(std::move(gauge_length_m)) {
  if (!with_echo) {
    return;
  }
  for (const double x : bench.position_m) {
    const double way_m = 2.0 * (bench.bar.length_m - x);
    Spectrum& q = echo.emplace_back();
    q.reserve(modes.size());
    for (const BarMode& mode : modes) {
      q.push_back(-mode.gamma * way_m);
    }
    each_exp(q);
  }
}

BarWaves::Spectrum BarWaves::ratio(const MovedBench& bench, std::size_t j) const {
  const double way_m = bench.position_m[j] - bench.position_m[0];
  const bool blurred = length_m[j] != length_m[0];
  Spectrum ratio(modes.size());
  for (std::size_t k = 0; k < ratio.size(); ++k) {
    ratio[k] = -modes[k].gamma * way_m;
  }
  each_exp(ratio);
  for (std::size_t k = 0; k < ratio.size(); ++k) {
    const Complex gamma = modes[k].gamma;
    if (!echo.empty()) {
      ratio[k] *= (1.0 + reflection * echo[j][k]) / (1.0 + reflection * echo[0][k]);
    }
    if (blurred) {
      ratio[k] *= sinhc(0.5 * gamma * length_m[j]) / sinhc(0.5 * gamma * length_m[0]);
    }
  }
  return ratio;
}

GammaSlopes::GammaSlopes(WaveTheory theory, const Bar& bar, SolidKind kind,
                         std::span<const double> parameters, const BarWaves& waves,
                         bool poisson_varies, const std::vector<Complex>& path)
    : by_solid(log_slopes(kind, parameters, path)),
      by_density(path.size()),
      by_diameter(path.size()) {
  for (std::size_t k = 0; k < path.size(); ++k) {
    const BarMode& mode = waves.modes[k];
    by_density[k] = mode.gamma * mode.slope;
    by_diameter[k] = mode.gamma * (2.0 * mode.slope - 1.0);
    for (auto& slope : by_solid) {
      slope[k] *= by_density[k];
    }
  }
  if (poisson_varies) {
    constexpr double kStep = 1e-3;
    Bar other = bar;
    other.poisson_ratio.value *= 1.0 + kStep;
    const auto solid = make_solid(kind, parameters);
    for (const BarMode& mode : bar_modes(theory, other, *solid, path)) {
      by_poisson.push_back((mode.gamma - waves.modes[by_poisson.size()].gamma) / kStep);
    }
  }
}

RatioSlopes::RatioSlopes(const BarWaves& waves, const MovedBench& bench, std::size_t j,
                         const std::vector<Complex>& path)
    : by_gamma(waves.modes.size()),
      by_x(waves.modes.size()),
      by_x0(waves.modes.size()),
      by_delay(waves.modes.size()),
      by_length(waves.modes.size()),
      by_reflection(waves.modes.size()) {
  const double to_end_m = bench.bar.length_m - bench.position_m[j];
  const double first_to_end_m = bench.bar.length_m - bench.position_m[0];
  const double R = waves.reflection;
  for (std::size_t k = 0; k < by_gamma.size(); ++k) {
    const Complex gamma = waves.modes[k].gamma;
    Complex e = 0.0;
    Complex e0 = 0.0;
    if (!waves.echo.empty()) {
      e = waves.echo[j][k] / (1.0 + R * waves.echo[j][k]);
      e0 = waves.echo[0][k] / (1.0 + R * waves.echo[0][k]);
    }
    by_gamma[k] = to_end_m * (1.0 - 2.0 * R * e) - first_to_end_m * (1.0 - 2.0 * R * e0);
    by_x[k] = -gamma * (1.0 - 2.0 * R * e);
    by_x0[k] = gamma * (1.0 - 2.0 * R * e0);
    by_delay[k] = -path[k];
    by_length[k] = -2.0 * R * gamma * (e - e0);
    by_reflection[k] = e - e0;
  }
  const double own_m = waves.length_m[j];
  const double first_m = waves.length_m[0];
  if (own_m != first_m) {
    for (std::size_t k = 0; k < by_gamma.size(); ++k) {
      const Complex half = 0.5 * waves.modes[k].gamma;
      by_gamma[k] += 0.5 * own_m * log_slope_of_sinhc(half * own_m) -
                     0.5 * first_m * log_slope_of_sinhc(half * first_m);
    }
  }
}

}  // namespace kolsky
