#include "processing/waves/wave_table.hpp"

#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

namespace {

/// Between the frequencies of a table lie so many that are only followed.
constexpr std::size_t kBetween = 4;
/// Elementary wavenumber times radius by which one step may go on.
constexpr double kLongestStep = 0.1;

}  // namespace

double thick_from_Hz(const Bar& bar, const Compliance& compliance) {
  constexpr double kThick = 0.3;
  return kThick * front_speed_m_per_s(bar, compliance) / bar.dispersion_radius_m();
}

std::vector<WaveRow> wave_table(WaveTheory theory, const Bar& bar, const Compliance& compliance,
                                double highest_Hz, std::size_t points) {
  if (!(highest_Hz > 0.0)) {
    throw InputError("highest_Hz", "is not above 0 Hz", "give a frequency");
  }
  const double radius_steps = 2.0 * std::numbers::pi * highest_Hz * bar.dispersion_radius_m() /
                              front_speed_m_per_s(bar, compliance);
  const auto fewest = static_cast<std::size_t>(
      std::ceil(radius_steps / (kLongestStep * static_cast<double>(kBetween))));
  if (points < std::max<std::size_t>(fewest, 1)) {
    throw InputError("points",
                     "are too few to follow the bar's first mode to " + in_words(highest_Hz, "Hz"),
                     "give " + std::to_string(std::max<std::size_t>(fewest, 1)) +
                         " or more, or a lower frequency");
  }
  const double step_Hz = highest_Hz / static_cast<double>(points * kBetween);
  std::vector<Complex> path;
  path.reserve(points * kBetween);
  for (std::size_t n = 1; n <= points * kBetween; ++n) {
    path.emplace_back(0.0, 2.0 * std::numbers::pi * step_Hz * static_cast<double>(n));
  }
  const std::vector<BarMode> modes = bar_modes(theory, bar, compliance, path);
  std::vector<WaveRow> table;
  table.reserve(points);
  for (std::size_t n = kBetween - 1; n < path.size(); n += kBetween) {
    const Complex gamma = modes[n].gamma;
    const Complex slowness = gamma / path[n];
    table.push_back({.frequency_Hz = step_Hz * static_cast<double>(n + 1),
                     .phase_speed_m_per_s = path[n].imag() / gamma.imag(),
                     .attenuation_per_m = gamma.real(),
                     .wavenumber_per_m = gamma.imag(),
                     .mean_over_surface = modes[n].mean_over_surface,
                     .stress_over_strain_Pa = bar.density_kg_m3.value / (slowness * slowness)});
  }
  return table;
}

}  // namespace kolsky
