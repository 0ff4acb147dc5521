#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "processing/impact/element_kernel.hpp"
#include "processing/impact/mesh.hpp"
#include "processing/impact/solid.hpp"

namespace kolsky::impact {

/// Where a stress or strain is asked for: an element of a block.
struct ElementIndex {
  std::size_t block = 0;
  std::size_t column = 0;
  std::size_t row = 0;
};

/// A meshed body with its motion: nodal arrays and the elements' state. Allocates when it is made
/// and never after.
class Body {
 public:
  /// @param solids  by the regions' numbers
  Body(Mesh mesh, std::vector<Solid> solids, const ElementKernel& kernel = element_kernel());
  Body(const Body&) = delete;  // the ranges point into the arrays
  Body& operator=(const Body&) = delete;
  Body(Body&&) = default;
  Body& operator=(Body&&) = default;
  ~Body() = default;

  /// The coming call to find_forces ends a step of `now_s`, and is followed by one of `next_s`.
  void set_steps(double now_s, double next_s);

  /// The forces that the elements put on the nodes, at the present displacements. Advances the
  /// elements' state: once per step.
  ElementSums find_forces(bool survey);

  /// Power of the elements' forces on the nodes with the present velocities: with those of
  /// find_forces, kept aside by `keep_forces` before anything is added to them.
  void keep_forces();
  [[nodiscard]] double kept_power() const;

  /// Makes tied nodes' forces the sum of theirs; after everything has been added to them.
  void join_ties();

  /// Velocities by `velocity_step_s` of acceleration, displacements by `step_s` of velocity.
  void advance(double velocity_step_s, double step_s);

  /// Puts every node at a displacement. @pre as many as the mesh has node numbers
  void place(std::span<const double> radial_m, std::span<const double> axial_m);

  /// Gives every node a velocity; same sizes.
  void set_velocity(std::span<const double> radial_m_per_s, std::span<const double> axial_m_per_s);

  void set_axial_velocity(double velocity_m_per_s);

  /// A spring that holds a node, radially and axially.
  struct Spring {
    std::size_t node = 0;
    double stiffness_N_per_m = 0.0;
  };

  /// Highest natural frequency [rad/s] of the body as it is made, with springs to the ground, by
  /// Lanczos on the elements' forces; the state is as new afterwards.
  [[nodiscard]] double highest_frequency(const std::vector<Spring>& springs = {}, int steps = 40);

  /// Largest of wave speed squared times squared gradient, of the last survey [1/s2].
  [[nodiscard]] double steepness_per_s2() const { return steepness_; }

  [[nodiscard]] double mass_kg() const;
  [[nodiscard]] double axial_momentum() const;
  /// By velocities half a step before and after: exact for central differences.
  [[nodiscard]] double kinetic_energy(double velocity_step_s) const;

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] const std::vector<Solid>& solids() const { return solids_; }
  [[nodiscard]] double r_m(std::size_t node) const { return mesh_.R_m[node] + ur_[node]; }
  [[nodiscard]] double z_m(std::size_t node) const { return mesh_.Z_m[node] + uz_[node]; }
  [[nodiscard]] double axial_displacement(std::size_t node) const { return uz_[node]; }
  [[nodiscard]] double radial_velocity(std::size_t node) const { return vr_[node]; }
  [[nodiscard]] double axial_velocity(std::size_t node) const { return vz_[node]; }
  [[nodiscard]] double nodal_mass_kg(std::size_t node) const { return mass_[node]; }

  /// On a node now: radial, axial.
  [[nodiscard]] std::pair<double, double> force(std::size_t node) const {
    return {fr_[node], fz_[node]};
  }

  void push(std::size_t node, double radial_N, double axial_N) {
    fr_[node] += radial_N;
    fz_[node] += axial_N;
  }

  /// Axial Cauchy stress, tension positive, and ln of an axial fibre's stretch: means over an
  /// element. Call between find_forces and the next.
  [[nodiscard]] double axial_stress_Pa(ElementIndex element) const;
  [[nodiscard]] double axial_log_stretch(ElementIndex element) const;

  /// Share of each solid's volume whose equivalent Hencky strain is beyond its own of `strain`.
  /// @pre as many strains and shares as solids
  void find_strained_share(std::span<const double> strain, std::span<double> share) const;

  /// The element whose area has shrunk most: the inverted one, where there is one.
  [[nodiscard]] ElementIndex most_squeezed() const;
  /// The element that a wave crosses soonest as it is made: the one that bounds the step.
  [[nodiscard]] ElementIndex soonest_crossed() const;
  /// Of the solids, the one that an element is of: the layer, from the inside.
  [[nodiscard]] std::size_t layer_of(ElementIndex element) const {
    return range_of(element).region.solid;
  }
  /// "element 12 of row 3 of block 1, at R 2.1 mm, Z 0.4 mm": places in the undeformed body.
  [[nodiscard]] std::string describe(ElementIndex element) const;

 private:
  struct Range {
    Region region;
    ElementRange elements;
    double wave_speed_squared = 0.0;
    std::vector<Real> geometry;
    std::vector<Real> state;
  };
  struct Gradient {
    double rR, rZ, zR, zZ, hoop;
  };

  void measure(Range& range);
  void spread_mass(const Range& range, double density_kg_m3);
  void gather(const Block& block);
  void forget();
  /// Of a branch's state: 3 by point, then the volume's.
  struct Component {
    std::size_t number;
  };
  static constexpr std::size_t kVolumeComponent = 12;
  [[nodiscard]] const Range& range_of(ElementIndex element) const;
  [[nodiscard]] double law_at(const Range& range, std::size_t index, Component component,
                              double strain) const;
  [[nodiscard]] double deviatoric_at(const Range& range, std::size_t index, std::size_t g,
                                     const Gradient& F) const;
  [[nodiscard]] Gradient gradient_at(ElementIndex element, double xi, double eta) const;

  Mesh mesh_;
  std::vector<Solid> solids_;
  const ElementKernel* kernel_;
  std::vector<Range> ranges_;
  std::vector<double> ur_, uz_, vr_, vz_, fr_, fz_, mass_, by_mass_r_, by_mass_z_;
  std::vector<double> kept_r_, kept_z_;
  std::vector<Real> contributions_;
  std::vector<double> volume_m3_;  // by solid
  double steepness_ = 0.0;
};

}  // namespace kolsky::impact
