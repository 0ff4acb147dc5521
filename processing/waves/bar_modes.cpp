#include "processing/waves/bar_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kolsky {

namespace {

/// Square root in the right half plane, where nothing cancels.
Complex right_root(Complex z) {
  const double re = std::sqrt(0.5 * (std::sqrt(std::norm(z)) + z.real()));
  return {re, 0.5 * z.imag() / re};
}

std::vector<BarMode> elementary_modes(const Bar& bar, const Compliance& compliance,
                                      const std::vector<Complex>& path) {
  std::vector<BarMode> modes;
  modes.reserve(path.size());
  const double rho = bar.density_kg_m3;
  for (const Complex s : path) {
    // J of a passive solid lies in the right half plane, so the principal root is the decaying one.
    modes.push_back({s * right_root(rho * compliance.at(s)), 1.0, 0.5});
  }
  return modes;
}

std::vector<BarMode> love_modes(const Bar& bar, const Compliance& compliance,
                                const std::vector<Complex>& path) {
  const double rho = bar.density_kg_m3;
  const double lateral = 0.5 * rho * std::pow(bar.poisson_ratio * bar.dispersion_radius_m(), 2);
  std::vector<BarMode> modes;
  modes.reserve(path.size());
  for (const Complex s : path) {
    const Complex stiffness = 1.0 / compliance.at(s);
    const Complex hindered = stiffness + lateral * s * s;
    modes.push_back({s * std::sqrt(rho / hindered), 1.0, 0.5 * stiffness / hindered});
  }
  return modes;
}

}  // namespace

std::vector<BarMode> bar_modes(WaveTheory theory, const Bar& bar, const Compliance& compliance,
                               const std::vector<Complex>& path) {
  switch (theory) {
    case WaveTheory::elementary:
      return elementary_modes(bar, compliance, path);
    case WaveTheory::love:
      return love_modes(bar, compliance, path);
    case WaveTheory::exact:
      break;
  }
  return PochhammerChree(bar.density_kg_m3, bar.poisson_ratio, bar.dispersion_radius_m(),
                         compliance)
      .along(path);
}

bool is_blind(const BarMode& mode) {
  return std::norm(mode.mean_over_surface) > kBlindMeanOverSurface * kBlindMeanOverSurface;
}

double blind_from_Hz(std::span<const BarMode> modes, std::span<const Complex> path) {
  const auto first =
      static_cast<std::size_t>(std::ranges::find_if(modes, is_blind) - modes.begin());
  // Not the path's end, which a limit asked for may be beyond by rounding.
  return first < modes.size() ? path[first].imag() / (2.0 * std::numbers::pi)
                              : std::numeric_limits<double>::infinity();
}

double blind_from_Hz(WaveTheory theory, const Bar& bar, const Compliance& compliance,
                     double highest_Hz) {
  constexpr std::size_t kSteps = 512;
  std::vector<Complex> path;
  path.reserve(kSteps);
  for (std::size_t n = 1; n <= kSteps; ++n) {
    path.emplace_back(0.0, 2.0 * std::numbers::pi * highest_Hz * static_cast<double>(n) / kSteps);
  }
  return blind_from_Hz(bar_modes(theory, bar, compliance, path), path);
}

double front_speed_m_per_s(const Bar& bar, const Compliance& compliance) {
  return 1.0 / std::sqrt(bar.density_kg_m3 * compliance.instantaneous());
}

}  // namespace kolsky
