#include "processing/models/exact_waves.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>

#include "processing/waves/pochhammer_chree.hpp"

namespace kolsky {

namespace {

constexpr double kSpacing = 0.1;
/// Past every frequency that a judged band's filter lets through: a kink in the table would send
/// part of a wave ahead of itself.
constexpr double kEnd = 7.0;
constexpr double kRadius = 0.15;
constexpr std::size_t kPointsOnCircle = 32;

/// Exact modes of a bar of unit radius, density and modulus along a path of s: gamma_elementary is
/// s itself.
std::vector<BarMode> unit_modes(double poisson_ratio, const std::vector<Complex>& path) {
  const ElasticSolid solid(1.0);
  return PochhammerChree(1.0, poisson_ratio, 1.0, solid).along(path);
}

}  // namespace

ExactWaves::ExactWaves(double poisson_ratio) {
  const auto count = static_cast<std::size_t>(kEnd / kSpacing) + 1;
  // One path: up the axis to each circle's nearest point, round the circle, on to the next.
  std::vector<Complex> path;
  std::vector<std::size_t> starts;
  constexpr double kSmall = 0.01;
  for (double up = 0.05; up < kRadius; up += kSmall) {
    path.emplace_back(up, 0.0);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Complex centre{0.0, kSpacing * static_cast<double>(i)};
    for (const double along : {0.34, 0.67}) {
      if (i > 0) {
        path.push_back(centre + kRadius - Complex(0.0, kSpacing * (1.0 - along)));
      }
    }
    starts.push_back(path.size());
    for (std::size_t p = 0; p < kPointsOnCircle; ++p) {
      const double angle =
          2.0 * std::numbers::pi * static_cast<double>(p) / static_cast<double>(kPointsOnCircle);
      path.push_back(centre + std::polar(kRadius, angle));
    }
    path.push_back(centre + kRadius);
  }
  const std::vector<BarMode> modes = unit_modes(poisson_ratio, path);
  for (std::size_t i = 0; i < count; ++i) {
    Place place;
    place.centre = {0.0, kSpacing * static_cast<double>(i)};
    for (std::size_t order = 0; order < kOrder; ++order) {
      // Cauchy's integral.
      Complex gamma = 0.0;
      Complex mean = 0.0;
      for (std::size_t p = 0; p < kPointsOnCircle; ++p) {
        const std::size_t at = starts[i] + p;
        const double angle =
            2.0 * std::numbers::pi * static_cast<double>(p) / static_cast<double>(kPointsOnCircle);
        const Complex turn = std::polar(std::pow(kRadius, -static_cast<double>(order)),
                                        -angle * static_cast<double>(order));
        const Complex ratio = modes[at].gamma / path[at];
        gamma += ratio * ratio * turn;
        mean += turn / modes[at].mean_over_surface;
      }
      place.gamma_squared[order] = gamma / static_cast<double>(kPointsOnCircle);
      place.mean[order] = mean / static_cast<double>(kPointsOnCircle);
    }
    places_.push_back(place);
  }
}

ExactWaves::Ratios ExactWaves::at(Complex z) const {
  Complex root = std::sqrt(z);
  if (root.imag() < 0.0) {
    root = -root;
  }
  const double reach = std::min(root.imag(), kEnd);
  const auto index = std::min(
      static_cast<std::size_t>(std::lround(std::max(0.0, reach) / kSpacing)), places_.size() - 1);
  const Place& place = places_[index];
  Complex step = root - place.centre;
  // Past the table's end, and for damping that no bar has, the nearest value it holds.
  if (std::abs(step) > 0.8 * kRadius) {
    step *= 0.8 * kRadius / std::abs(step);
  }
  Ratios ratios{place.gamma_squared[kOrder - 1], place.mean[kOrder - 1]};
  for (std::size_t order = kOrder - 1; order-- > 0;) {
    ratios.gamma_squared = ratios.gamma_squared * step + place.gamma_squared[order];
    ratios.surface_over_mean = ratios.surface_over_mean * step + place.mean[order];
  }
  return ratios;
}

void blend_exact_waves(BarScene& bar, std::span<const Complex> s, double strength) {
  // Tables depend on nothing but Poisson's ratio; making one takes milliseconds.
  static std::mutex lock;
  static std::map<double, std::unique_ptr<const ExactWaves>> tables;
  const ExactWaves* table = nullptr;
  {
    const std::scoped_lock held(lock);
    auto& entry = tables[bar.poisson_ratio];
    if (!entry) {
      entry = std::make_unique<const ExactWaves>(bar.poisson_ratio);
    }
    table = entry.get();
  }
  for (std::size_t k = 0; k < s.size(); ++k) {
    const Complex elementary = s[k] * std::sqrt(bar.density_kg_m3 * bar.J_per_Pa[k]);
    const Complex scaled = elementary * bar.radius_m;
    const auto ratios = table->at(scaled * scaled);
    bar.gamma_per_m[k] += strength * elementary * (std::sqrt(ratios.gamma_squared) - 1.0);
    bar.surface_over_mean[k] += strength * (ratios.surface_over_mean - 1.0);
  }
}

}  // namespace kolsky
