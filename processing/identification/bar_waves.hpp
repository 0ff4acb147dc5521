#pragma once

#include <optional>
#include <span>
#include <vector>

#include "processing/identification/known_unknowns.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/solids.hpp"

namespace kolsky {

/// What the waves in a bar look like along a path of s, with one set of its numbers: all that
/// gauges' transfers and their derivatives are made of.
struct BarWaves {
  using Spectrum = std::vector<Complex>;

  std::vector<BarMode> modes;
  double reflection = 0.0;       ///< what the far end returns of a stress
  std::vector<Spectrum> echo;    ///< exp(-2 gamma (L - x)) of each gauge; empty: nothing comes back
  std::vector<double> length_m;  ///< of each gauge

  BarWaves(WaveTheory theory, const MovedBench& bench, const Compliance& solid, double reflection,
           bool with_echo, std::vector<double> gauge_length_m, const std::vector<Complex>& path);

  /// How gauge j follows gauge 0: h_j / h_0 without their gains.
  [[nodiscard]] Spectrum ratio(const MovedBench& bench, std::size_t j) const;
};

/// How gamma follows the numbers it depends on.
struct GammaSlopes {
  std::vector<BarWaves::Spectrum> by_solid;  ///< by the logarithms of the solid's parameters
  BarWaves::Spectrum by_density;             ///< by its relative change
  BarWaves::Spectrum by_diameter;            ///< likewise
  BarWaves::Spectrum by_poisson;             ///< likewise; empty where that is exactly known

  GammaSlopes(WaveTheory theory, const Bar& bar, SolidKind kind, std::span<const double> parameters,
              const BarWaves& waves, bool poisson_varies, const std::vector<Complex>& path);
};

/// How log(h_j / h_0) follows gamma, places, gauge j's delay, the bar's length and what its end
/// returns.
struct RatioSlopes {
  BarWaves::Spectrum by_gamma, by_x, by_x0, by_delay, by_length, by_reflection;

  RatioSlopes(const BarWaves& waves, const MovedBench& bench, std::size_t j,
              const std::vector<Complex>& path);
};

}  // namespace kolsky
