#pragma once

#include <span>
#include <vector>

#include "processing/impact/body.hpp"

namespace kolsky::impact {

/// The plane that a ball's surface meets; it may move.
struct Plane {
  double z_m = 0.0;
  double sense = 1.0;  ///< +1: the ball is above it, -1: below
};

/// What contact did at one moment.
struct ContactSums {
  double force_N = 0.0;     ///< on the ball, away from the plane
  double radius_m = 0.0;    ///< of the outermost touching point
  double energy_J = 0.0;    ///< in the penalty's springs
  double friction_J = 0.0;  ///< lost since the call before
};

/// How much of the circle of radius r about the ball's axis lies on a disc of radius `disc_m` whose
/// axis is `offset_m` away.
[[nodiscard]] double covered_share(double r_m, double disc_m, double offset_m);

/// Penalty contact with Coulomb friction: pressure proportional to penetration at points along the
/// ball's surface, each with its share of the undeformed area, so that the patch grows smoothly and
/// not node by node.
class Contact {
 public:
  /// @param nodes  the ball's surface, in order
  /// @param disc_m, offset_m  the plane ends there; 0: endless
  Contact(const Body& ball, std::span<const std::size_t> nodes, double friction, double disc_m,
          double offset_m);

  /// Least of nodal mass per area of the surface's nodes [kg/m2].
  [[nodiscard]] double least_mass_per_area() const { return least_mass_per_area_; }
  void set_stiffness(double stiffness_Pa_per_m) { stiffness_ = stiffness_Pa_per_m; }

  /// What the penalty adds to each node where all of the surface touches (lumped: an upper bound).
  [[nodiscard]] std::vector<Body::Spring> springs() const;

  /// Adds the contact's forces to the ball.
  ContactSums push(Body& ball, const Plane& plane);

  /// The same against a bar's face, whose nodes take what the ball's give.
  ContactSums push(Body& ball, Body& bar);

 private:
  struct Point {
    std::size_t a = 0;
    std::size_t b = 0;
    double at_b = 0.0;  ///< between the nodes: 0 at a, 1 at b
    double area_m2 = 0.0;
    double anchor_m = 0.0;  ///< where it would stick
    double held_N = 0.0;    ///< friction, outwards
    bool touching = false;
  };

  template <typename Face>
  ContactSums push_on(Body& ball, const Face& face);
  double drag(Point& point, double r_m, double normal_N, ContactSums& sums) const;

  std::vector<Point> points_;
  double friction_ = 0.0;
  double disc_m_ = 0.0;
  double offset_m_ = 0.0;
  double stiffness_ = 0.0;
  double least_mass_per_area_ = 0.0;
};

}  // namespace kolsky::impact
