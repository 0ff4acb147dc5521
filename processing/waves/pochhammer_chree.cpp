#include "processing/waves/pochhammer_chree.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/waves/frequency_equation.hpp"

namespace kolsky {

namespace {

/// Of the real part of gamma0 a, in Poisson's ratios: where the first mode is itself.
constexpr double kMostDamped = 0.9;
/// Below which hardly any ratio moves a wave.
constexpr double kLeastLimit = 0.15;
constexpr double kFarthest = 12.0;
/// Below which rounding moves the strain at the surface more than what goes sideways does.
constexpr double kLeastRatio = 1e-8;

/// Follows the root along a path of z, by a parabola through what is known of it.
class RootFollower {
 public:
  explicit RootFollower(double poisson_ratio) : equation_(poisson_ratio), nu_(poisson_ratio) {}

  BarMode mode_at(Complex elementary, double radius_m) {
    const Complex z = elementary * elementary * radius_m * radius_m;
    root_ = equation_.solve(z, foretold(z));
    curvature_ = started_ && z != z_ ? (root_.slope - last_slope_) / (z - z_) : 0.0;
    z_ = z;
    last_slope_ = root_.slope;
    started_ = true;
    mean_ = equation_.mean_over_surface(z, root_.ratio);
    slope_ = 0.5 * (1.0 + z * root_.slope / root_.ratio);
    return kept(elementary);
  }

  /// The last ratio, further out.
  [[nodiscard]] BarMode kept(Complex elementary) const {
    return {elementary * std::sqrt(root_.ratio), mean_, slope_};
  }

 private:
  [[nodiscard]] Complex foretold(Complex z) const {
    if (!started_) {
      return 1.0 - nu_ * nu_ * z / 2.0;  // Rayleigh, to first order
    }
    const Complex step = z - z_;
    return root_.ratio + step * (root_.slope + 0.5 * step * curvature_);
  }

  FrequencyEquation equation_;
  double nu_;
  bool started_ = false;
  Complex z_ = 0.0;
  FrequencyEquation::Root root_{1.0, 0.0};
  Complex last_slope_ = 0.0;
  Complex curvature_ = 0.0;
  Complex mean_ = 1.0;
  Complex slope_ = 0.5;
};

}  // namespace

PochhammerChree::PochhammerChree(double density_kg_m3, double poisson_ratio, double radius_m,
                                 const Compliance& compliance)
    : density_kg_m3_(density_kg_m3),
      poisson_ratio_(poisson_ratio),
      radius_m_(radius_m),
      compliance_(&compliance) {}

std::vector<BarMode> PochhammerChree::along(const std::vector<Complex>& path) const {
  std::vector<BarMode> modes;
  modes.reserve(path.size());
  RootFollower follower(poisson_ratio_);
  const bool sections_stay_plane = std::abs(poisson_ratio_) < kLeastRatio;
  for (const Complex s : path) {
    const Complex elementary = s * std::sqrt(density_kg_m3_ * compliance_->at(s));
    if (sections_stay_plane) {
      modes.push_back({elementary, 1.0, 0.5});
      continue;
    }
    const double reach = std::abs(elementary) * radius_m_;
    if (modes.empty()) {
      require_little_damping(elementary.real() * radius_m_);
    }
    modes.push_back(reach <= kFarthest && s != 0.0 ? follower.mode_at(elementary, radius_m_)
                                                   : follower.kept(elementary));
  }
  return modes;
}

void PochhammerChree::require_little_damping(double through_radius) const {
  const double limit = std::max(kMostDamped * poisson_ratio_, kLeastLimit);
  if (through_radius > limit) {
    throw InputError("record",
                     "is too short for exact waves in a bar of " + in_words(2e3 * radius_m_, "mm"),
                     "record " + in_words(through_radius / limit, "times") +
                         " as long, or take elementary or Love's waves (--dispersion)");
  }
}

}  // namespace kolsky
