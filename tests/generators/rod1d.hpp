#pragma once

#include <span>
#include <vector>

#include "tests/generators/kelvin_chain.hpp"

namespace kolsky::testing {

/// A thin viscoelastic rod by the method of characteristics with internal variables: along
/// dx = +-c dt, c the glassy wave speed, d(s +- Z v) = -E q dt with s the stress (compression
/// positive), v the particle velocity, q the viscous strain rate; trapezoidal along both families
/// and exponential for the internal variables, so of second order in the step (which follows from
/// the number of cells). The section may vary from cell to cell; s is then force over the area 1.
class Rod {
 public:
  /// @param relative_area  of each cell; empty where all are 1
  Rod(const KelvinChain& material, double density_kg_m3, double length_m, int cells,
      std::vector<double> relative_area = {});

  [[nodiscard]] double step_s() const { return chain_.step_s(); }
  [[nodiscard]] double length_m() const { return cell_m_ * static_cast<double>(cells()); }
  [[nodiscard]] int cells() const { return static_cast<int>(stress_.size()) - 1; }

  /// What the rod allows at its ends at the new time: stress = free + slope * v at the left end,
  /// stress = free - slope * v at the right one.
  struct EndRelation {
    double free;
    double slope;
  };

  /// Advances everything inside by one step; the ends wait for close_left and close_right.
  void advance();
  [[nodiscard]] EndRelation left() const { return left_; }
  [[nodiscard]] EndRelation right() const { return right_; }
  /// Nothing beyond x will be asked for any more, nor can it come back in time: it is left as it
  /// is.
  void forget_beyond(double x_m);
  void close_left(double stress_Pa);
  void close_right(double stress_Pa);

  /// Axial strain of the material at x, interpolated over eight nodes.
  [[nodiscard]] double strain_at(double x_m) const;
  [[nodiscard]] double largest_stress() const;

 private:
  void settle(std::size_t node, double stress);

  KelvinStep chain_;
  double cell_m_;
  double impedance_;
  double half_;  // E dt/2
  std::vector<double> area_;
  std::vector<double> stress_, right_going_, left_going_, rate_;
  std::vector<double> from_left_, from_right_, remembered_;
  std::vector<std::vector<double>> viscous_;
  std::size_t reached_ = 1;  // nodes beyond this are still at rest
  std::size_t kept_;         // nodes beyond this no longer matter
  EndRelation left_{}, right_{};
};

}  // namespace kolsky::testing
