#pragma once

#include <array>
#include <vector>

#include "tests/generators/shpb_contact.hpp"

namespace kolsky::testing {

/// A specimen as a solid of revolution between plane faces that stay plane: bilinear elements with
/// 2 x 2 points, the Kelvin chain acting on every strain alike (one Poisson's ratio), its own mass,
/// so that waves cross it along and across, and Coulomb friction on both faces. Strains are small
/// ones: sizes stay those it had. Motion by velocities of Verlet's kind at the bars' step; a face's
/// velocity is shared with its bar at the step's end, so that nothing is gained by their impedance.
class SolidSpecimen : public ShpbContact {
 public:
  struct Cells {
    std::size_t across = 12;
    std::size_t along = 16;
  };
  SolidSpecimen(const ShpbWorld& world, double step_s, Cells cells);
  SolidSpecimen(const ShpbWorld& world, double step_s) : SolidSpecimen(world, step_s, Cells{}) {}
  void close(Rod& input, Rod& output) override;

 private:
  using Tensor = std::array<double, 4>;  ///< rr, zz, hoop, rz (engineering), tension positive
  static constexpr std::size_t kCorners = 4;

  struct Point {
    std::array<double, kCorners> along_r, along_z, hoop;  ///< of each corner's shape
    double weight = 0.0;                                  ///< volume
  };
  struct Memory {
    std::vector<Tensor> viscous;
    Tensor stress{};  ///< by unit modulus: that of a stress state's strains
  };
  struct Motion {
    std::vector<double> moved, velocity, acceleration, force;  ///< by node
  };

  [[nodiscard]] std::size_t node(std::size_t across, std::size_t along) const;
  void lay_points(std::size_t column);
  void weigh();
  [[nodiscard]] Tensor stress_of(Memory& memory, const Tensor& strain) const;
  void gather_forces();
  void add_cell(std::size_t across, std::size_t along);
  void move_inside();
  /// Moves a face with its bar. @param sense  +1 where the bar pushes along z, else -1
  /// @return the bar's stress
  double move_face(std::size_t along, const Rod::EndRelation& bar, double sense);
  void slide(std::size_t node, double pressing_N);

  Cells cells_;
  KelvinStep chain_;
  double fresh_ = 0.0;
  double poisson_ratio_, friction_;
  double cell_r_m_, cell_z_m_, length_m_, density_kg_m3_;
  double bar_area_m2_;
  double step_s_;
  std::vector<std::array<Point, kCorners>> points_;  ///< by column: all rows are alike
  std::vector<Memory> memory_;                       ///< by cell and point
  std::vector<double> mass_;
  Motion radial_, axial_;
};

}  // namespace kolsky::testing
