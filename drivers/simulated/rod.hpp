#pragma once

#include <cstddef>
#include <vector>

namespace kolsky {

/// A spring and a dashpot side by side: strain D (1 - exp(-t/tau)) after a unit of stress.
struct RodRelaxation {
  double D_per_Pa = 0.0;
  double tau_s = 0.0;
};

/// What a rod is made of: a spring E1 in series with a spring E2 and a dashpot eta2 in parallel;
/// elastic with modulus E1 where eta2 is 0. In series with a viscoelastic one, where given, further
/// relaxations and a dashpot of fluidity phi.
struct RodMaterial {
  double density_kg_m3 = 0.0;
  double E1_Pa = 0.0;
  double E2_Pa = 0.0;
  double eta2_Pa_s = 0.0;
  std::vector<RodRelaxation> relaxations{};
  double phi_per_Pa_s = 0.0;

  [[nodiscard]] bool elastic() const noexcept { return eta2_Pa_s == 0.0; }
  [[nodiscard]] bool plain() const noexcept { return relaxations.empty() && phi_per_Pa_s == 0.0; }
  /// Speed of a wave's very front.
  [[nodiscard]] double front_speed_m_per_s() const;
};

/// A uniform rod, before it is cut into cells.
struct RodShape {
  double length_m = 0.0;
  double area_m2 = 0.0;
  RodMaterial material;
};

/// A uniform rod on a staggered grid: strains in the cells at whole time steps, velocities at the
/// nodes between and at both ends, half a step earlier. Compression and motion away from the impact
/// are positive. Second order in the step. The cell is as short as the step allows, so that waves
/// travel nearly one cell a step, where the scheme has next to no dispersion of its own.
///
/// The cell's internal strain q, that of the spring and dashpot in parallel, obeys
///   eta2 dq/dt = E1 (strain - q) - E2 q,   stress = E1 (strain - q),
/// and is advanced exactly for a strain that is linear over the step. Where there are further
/// relaxations, the strains of all of them obey tau dq/dt = D stress - q, by the trapezoidal rule.
class Rod {
 public:
  /// @throws std::invalid_argument where the step is longer than the rod's transit time
  Rod(const RodShape& shape, double time_step_s);

  /// Velocities half a step on, from the stresses; the end nodes without forces from outside, which
  /// `push_front` and `push_back` add.
  void advance_velocities();
  void push_front(double force_N) { velocity_.front() += force_N * step_per_end_mass_; }
  void push_back(double force_N) { velocity_.back() -= force_N * step_per_end_mass_; }

  /// Strains and stresses a step on, from the velocities.
  void advance_strains();

  [[nodiscard]] double front_velocity() const noexcept { return velocity_.front(); }
  [[nodiscard]] double back_velocity() const noexcept { return velocity_.back(); }
  [[nodiscard]] double end_mass_kg() const noexcept { return end_mass_kg_; }
  [[nodiscard]] std::size_t cells() const noexcept { return strain_.size(); }
  [[nodiscard]] double cell_m() const noexcept { return cell_m_; }

  /// Strain at a place, by the cubic through the four nearest cells.
  /// @param position_m  from the front end, at least two cells from either end
  [[nodiscard]] double strain_at(double position_m) const;

  [[nodiscard]] double momentum_kg_m_per_s() const;

 private:
  void advance_viscous_strains();
  void advance_elastic_strains();
  void advance_chain_strains();
  void prepare_chain(const RodMaterial& material);

  /// One element of a chain: its strain a step on is keep q + take (stress before + stress after).
  struct Element {
    double keep = 0.0;
    double take = 0.0;
    std::vector<double> strain{};
  };

  double cell_m_;
  double step_s_;
  double E1_Pa_;
  bool elastic_;
  double area_m2_;
  double node_mass_kg_;
  double end_mass_kg_;
  double step_per_end_mass_;
  double keep_;         ///< of q, per step
  double from_before_;  ///< of the strain at the step's start
  double from_after_;   ///< of the strain at its end
  std::vector<double> strain_;
  std::vector<double> internal_;
  std::vector<Element> chain_;  ///< empty for a plain material
  std::vector<double> stress_;
  std::vector<double> velocity_;
};

}  // namespace kolsky
