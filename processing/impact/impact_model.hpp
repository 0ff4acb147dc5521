#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "processing/impact/solid.hpp"

namespace kolsky::impact {

/// A layer of the ball, from the inside: the core first.
struct Layer {
  double outer_diameter_m = 0.0;
  Solid solid;
};

enum class TargetKind {
  rigid,    ///< a plane at rest
  dashpot,  ///< a plane that yields as a semi-infinite bar does: F = rho c0 A v
  bar,      ///< the bar itself, meshed, elastic, its far end free
};

/// "rigid", "dashpot", "bar". @throws InputError at `place` for any other name
[[nodiscard]] TargetKind target_named(const std::string& name, const std::string& place);
[[nodiscard]] std::string name_of(TargetKind kind);

/// What the ball strikes. A rigid target is an endless plane and needs no numbers.
struct Target {
  TargetKind kind = TargetKind::rigid;
  double diameter_m = 0.0;
  double length_m = 0.0;
  double density_kg_m3 = 0.0;
  double youngs_modulus_Pa = 0.0;
  double poisson_ratio = 0.0;

  [[nodiscard]] double area_m2() const;
  [[nodiscard]] double wave_speed_m_per_s() const;  ///< c0
  [[nodiscard]] double impedance_kg_per_s() const;  ///< rho c0 A
};

/// A material point of the ball whose axial strain is recorded: undeformed place from the centre,
/// axial towards the target positive.
struct Probe {
  double radial_m = 0.0;
  double axial_m = 0.0;
};

/// Of histories, whatever the bench samples at: a contact lasts some 400 of it.
inline constexpr double kHistoryInterval_s = 1e-6;

/// One impact, complete: the same model gives the same history, bit for bit, on the same processor.
struct ImpactModel {
  std::vector<Layer> layers;
  Target target;
  double speed_m_per_s = 0.0;
  double friction = 0.3;       ///< Coulomb
  double sabot_mass_kg = 0.0;  ///< a rigid mass that follows and touches the rear pole
  double offset_m = 0.0;       ///< ball's axis off the bar's, as its mean round the axis

  std::size_t elements = 2048;          ///< of the ball, about
  std::size_t bar_elements_across = 8;  ///< over the bar's radius; the mesh along it is as fine
  double time_step_s = 0.0;             ///< 0: what stability allows
  double output_interval_s =
      kHistoryInterval_s;   ///< of the histories, which peak and contact time are of
  double duration_s = 0.0;  ///< 0: until the ball has left (and the gauges have seen it)

  std::vector<Probe> probes;
  std::vector<double> gauge_positions_m;  ///< on a meshed bar, from the struck end
  std::vector<double> field_times_s;      ///< when to keep the deformed ball
  bool field_at_turn = false;  ///< and where it is deformed most, as its centre of mass turns round
};

/// @throws InputError whose place is the member: geometry that does not fit, a solid that is not
/// passive,
///   numbers that are not finite
void check(const ImpactModel& model);

}  // namespace kolsky::impact
