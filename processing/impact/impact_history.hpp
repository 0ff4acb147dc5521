#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace kolsky::impact {

/// Where the energy is at the end, in J; the start is all kinetic.
struct EnergyLedger {
  double initial_J = 0.0;
  double kinetic_J = 0.0;     ///< of the ball
  double stored_J = 0.0;      ///< in the ball's springs
  double dissipated_J = 0.0;  ///< in the ball's dashpots
  double radiated_J = 0.0;    ///< into the dashpot target; in the meshed bar, moving and strained
  double friction_J = 0.0;
  double contact_J = 0.0;      ///< left in the penalty
  double sabot_J = 0.0;        ///< kinetic, of the sabot
  double closure = 0.0;        ///< (sum - initial)/initial at the end
  double worst_closure = 0.0;  ///< largest magnitude of it on the way
  /// With a non-linear solid or Cauchy stress the dissipated part is what is missing in the
  /// internal work, so that the closure tests the motion alone; with linear ones it is summed over
  /// the dashpots.
  bool dissipated_by_difference = false;
};

/// A quadrilateral of the deformed ball, corners in order round it.
struct FieldElement {
  std::array<double, 4> r_m{};
  std::array<double, 4> z_m{};   ///< from the plane's first place, away from the target
  double axial_stress_Pa = 0.0;  ///< compression positive
  std::size_t layer = 0;
};

struct Field {
  double time_s = 0.0;
  std::vector<FieldElement> elements;
};

/// What an impact gives. Compression positive; t = 0 at first touch. Samples are means over the
/// interval round their time, so that their sum times the interval is the impulse.
struct ImpactHistory {
  std::vector<double> time_s;
  std::vector<double> force_N;
  std::vector<double> contact_radius_m;
  std::vector<std::vector<double>> probe_strain;  ///< by probe: -ln of the axial fibre's stretch
  std::vector<std::vector<double>>
      gauge_strain;  ///< by gauge: engineering, raw, at the bar's surface

  double mass_kg = 0.0;  ///< of the meshed ball
  double peak_force_N = 0.0;
  double peak_time_s = 0.0;
  double contact_time_s = 0.0;  ///< while the force is above a hundredth of its peak
  double release_time_s = 0.0;  ///< last touch
  double largest_contact_radius_m = 0.0;
  std::vector<double>
      strained_share;  ///< by layer: volume beyond 0.1 equivalent Hencky strain at the turn
  std::vector<double>
      falling_share;               ///< by layer: volume where stress falls with strain, at the turn
  double impulse_N_s = 0.0;        ///< on the target: force samples times their interval
  double sabot_impulse_N_s = 0.0;  ///< of a sabot on the ball, towards the target
  double rebound_speed_m_per_s = 0.0;  ///< of the centre of mass
  double restitution = 0.0;
  EnergyLedger energy;
  std::vector<Field> fields;

  std::size_t elements = 0;
  std::size_t steps = 0;
  double first_step_s = 0.0;
  double least_step_s = 0.0;
  std::vector<std::string> remarks;  ///< what a reader ought to know about this run
};

}  // namespace kolsky::impact
