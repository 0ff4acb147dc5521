#include "processing/impact/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace kolsky::impact {
namespace {

// Gauss-Legendre on [0, 1].
constexpr std::array<double, 4> kPlaces = {0.06943184420297371, 0.33000947820757187,
                                           0.66999052179242813, 0.93056815579702629};
constexpr std::array<double, 4> kWeights = {0.17392742256872693, 0.32607257743127307,
                                            0.32607257743127307, 0.17392742256872693};

struct PlaneFace {
  Plane plane;

  [[nodiscard]] double sense() const { return plane.sense; }
  [[nodiscard]] double z_at(double /*r_m*/) const { return plane.z_m; }
  void push(double /*r_m*/, double /*radial_N*/, double /*axial_N*/) const {}
};

// The struck face of a bar, its nodes evenly spaced from the axis outwards.
struct BarFace {
  Body& bar;

  struct Place {
    std::size_t a, b;
    double at_b;
  };
  [[nodiscard]] static double sense() { return 1.0; }
  [[nodiscard]] Place place(double r_m) const {
    const std::vector<std::size_t>& nodes = bar.mesh().surface;
    const double width_m = bar.mesh().R_m[nodes[1]];
    const double index = std::clamp(r_m / width_m, 0.0, static_cast<double>(nodes.size() - 1));
    const std::size_t low = std::min(static_cast<std::size_t>(index), nodes.size() - 2);
    return {nodes[low], nodes[low + 1], index - static_cast<double>(low)};
  }
  [[nodiscard]] double z_at(double r_m) const {
    const Place at = place(r_m);
    return (1.0 - at.at_b) * bar.z_m(at.a) + at.at_b * bar.z_m(at.b);
  }
  void push(double r_m, double radial_N, double axial_N) const {
    const Place at = place(r_m);
    bar.push(at.a, (1.0 - at.at_b) * radial_N, (1.0 - at.at_b) * axial_N);
    bar.push(at.b, at.at_b * radial_N, at.at_b * axial_N);
  }
};

}  // namespace

double covered_share(double r_m, double disc_m, double offset_m) {
  if (disc_m <= 0.0 || r_m + offset_m <= disc_m) {
    return 1.0;
  }
  if (r_m >= disc_m + offset_m || r_m * offset_m == 0.0) {
    return 0.0;
  }
  const double cosine =
      (r_m * r_m + offset_m * offset_m - disc_m * disc_m) / (2.0 * r_m * offset_m);
  return std::acos(std::clamp(cosine, -1.0, 1.0)) / std::numbers::pi;
}

Support support_of(double r_m, const Edge& edge, double stiffness_Pa_per_m) {
  const double share = covered_share(r_m, edge.disc_m, edge.offset_m);
  if (share == 1.0 || share == 0.0) {
    return {share * stiffness_Pa_per_m, 0.0};
  }
  constexpr double kLeast = 1e-12;  // the share's slope is infinite where a circle meets the edge
  const double cosine = std::cos(std::numbers::pi * share);
  const double share_slope =
      -(1.0 / edge.offset_m - cosine / r_m) /
      (std::numbers::pi * std::sqrt(std::max(1.0 - cosine * cosine, kLeast)));
  const double overhang_m = r_m + edge.offset_m - edge.disc_m;
  const double free_by_held = (1.0 - share) / share;
  const double yielding = free_by_held * overhang_m / edge.modulus_Pa;
  const double yielding_slope =
      (free_by_held - share_slope * overhang_m / (share * share)) / edge.modulus_Pa;
  const double stiffness = 1.0 / (1.0 / stiffness_Pa_per_m + yielding);
  return {stiffness, -stiffness * stiffness * yielding_slope};
}

Contact::Contact(const Body& ball, std::span<const std::size_t> nodes, double friction,
                 const Edge& edge)
    : friction_(friction), edge_(edge) {
  std::vector<double> area(nodes.size(), 0.0);
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const double length_m = std::hypot(ball.r_m(nodes[k + 1]) - ball.r_m(nodes[k]),
                                       ball.z_m(nodes[k + 1]) - ball.z_m(nodes[k]));
    for (std::size_t g = 0; g < kPlaces.size(); ++g) {
      Point point;
      point.a = nodes[k];
      point.b = nodes[k + 1];
      point.at_b = kPlaces[g];
      const double r_m = (1.0 - point.at_b) * ball.r_m(point.a) + point.at_b * ball.r_m(point.b);
      point.area_m2 = 2.0 * std::numbers::pi * r_m * length_m * kWeights[g];
      area[k] += (1.0 - point.at_b) * point.area_m2;
      area[k + 1] += point.at_b * point.area_m2;
      points_.push_back(point);
    }
  }
  least_mass_per_area_ = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    least_mass_per_area_ = std::min(least_mass_per_area_, ball.nodal_mass_kg(nodes[k]) / area[k]);
  }
}

std::vector<Body::Spring> Contact::springs() const {
  std::vector<Body::Spring> springs;
  for (const Point& point : points_) {
    springs.push_back({point.a, stiffness_ * (1.0 - point.at_b) * point.area_m2});
    springs.push_back({point.b, stiffness_ * point.at_b * point.area_m2});
  }
  return springs;
}

// Coulomb friction with a spring as stiff as the penalty: the force on the ball, outwards.
double Contact::drag(Point& point, double r_m, double normal_N, ContactSums& sums) const {
  const double spring = stiffness_ * point.area_m2;
  if (!point.touching) {
    point.anchor_m = r_m;
  }
  const double limit = friction_ * normal_N;
  const double trial = spring * (point.anchor_m - r_m);
  const double held = std::clamp(trial, -limit, limit);
  if (held != trial) {
    const double anchor_m = r_m + held / spring;
    sums.friction_J += std::abs(held * (anchor_m - point.anchor_m));
    point.anchor_m = anchor_m;
  }
  sums.energy_J += 0.5 * held * held / spring;
  point.held_N = held;
  return held;
}

template <typename Face>
ContactSums Contact::push_on(Body& ball, const Face& face) {
  ContactSums sums;
  double inner_depth_m = 0.0;  // of the touching point before, whose radius is sums.radius_m
  for (Point& point : points_) {
    const double at_a = 1.0 - point.at_b;
    const double z_m = at_a * ball.z_m(point.a) + point.at_b * ball.z_m(point.b);
    const double r_m = at_a * ball.r_m(point.a) + point.at_b * ball.r_m(point.b);
    const double depth_m = face.sense() * (face.z_at(r_m) - z_m);
    const Support support = depth_m > 0.0 ? support_of(r_m, edge_, stiffness_) : Support{};
    if (support.stiffness_Pa_per_m == 0.0) {
      if (inner_depth_m > 0.0 && depth_m < 0.0) {
        // The patch ends where the gap opens, between this point and the one before.
        sums.radius_m += (r_m - sums.radius_m) * inner_depth_m / (inner_depth_m - depth_m);
      }
      inner_depth_m = 0.0;
      if (point.touching) {
        // The friction spring lets go of what it held.
        sums.friction_J += 0.5 * point.held_N * point.held_N / (stiffness_ * point.area_m2);
        point.touching = false;
      }
      continue;
    }
    const double normal_N = support.stiffness_Pa_per_m * point.area_m2 * depth_m;
    const double drag_N = friction_ > 0.0 ? drag(point, r_m, normal_N, sums) : 0.0;
    // The edge presses outwards on what yields over it: by its slope, so that energy is a state.
    const double edge_N = -0.5 * support.slope_Pa_per_m2 * point.area_m2 * depth_m * depth_m;
    const double radial_N = drag_N + edge_N;
    const double axial_N = face.sense() * normal_N;
    point.touching = true;
    ball.push(point.a, at_a * radial_N, at_a * axial_N);
    ball.push(point.b, point.at_b * radial_N, point.at_b * axial_N);
    face.push(r_m, -drag_N, -axial_N);
    sums.force_N += normal_N;
    sums.energy_J += 0.5 * normal_N * depth_m;
    sums.radius_m = std::max(sums.radius_m, r_m);
    inner_depth_m = depth_m;
  }
  return sums;
}

ContactSums Contact::push(Body& ball, const Plane& plane) {
  return push_on(ball, PlaneFace{plane});
}

ContactSums Contact::push(Body& ball, Body& bar) {
  return push_on(ball, BarFace{bar});
}

}  // namespace kolsky::impact
