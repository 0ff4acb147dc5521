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

/// Where a plane ends, and what of a ball beyond it gives way to.
struct Edge {
  double disc_m = 0.0;    ///< its radius; 0: endless
  double offset_m = 0.0;  ///< of the ball's axis
  double modulus_Pa =
      0.0;  ///< E/(1 - nu^2) of the ball's outer layer; used where part of a circle overhangs
};

/// A circle's resistance, per area, to its mean depth in the plane.
struct Support {
  double stiffness_Pa_per_m = 0.0;
  double slope_Pa_per_m2 = 0.0;  ///< by the circle's radius
};

/// The resistance of a circle of radius r of which a share s lies on the plane, with a penalty of
/// `stiffness`: the supported arc stays at the plane, the overhanging one moves on by what its
/// pressure p would have held back, p l / E*, l being how far the circle stands out over the edge.
/// Their mean makes the penalty one of two springs in series; the other is s / (1 - s) E* / l.
/// An estimate, good to a factor of two: the circle is one of three dimensions here as its mean.
[[nodiscard]] Support support_of(double r_m, const Edge& edge, double stiffness_Pa_per_m);

/// Penalty contact with Coulomb friction: pressure proportional to penetration at points along the
/// ball's surface, each with its share of the undeformed area, so that the patch grows smoothly and
/// not node by node.
class Contact {
 public:
  /// @param nodes  the ball's surface, in order
  Contact(const Body& ball, std::span<const std::size_t> nodes, double friction,
          const Edge& edge = {});

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
  Edge edge_;
  double stiffness_ = 0.0;
  double least_mass_per_area_ = 0.0;
};

}  // namespace kolsky::impact
