#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/measured.hpp"

namespace kolsky {

/// Gauges at one place of the struck bar, as the force was taken from them.
struct ForceStation {
  std::string gauges;  ///< their names
  double position_m = 0.0;
  double weight = 0.0;         ///< in the force, by noise; 0: its window is too short
  double clean_from_s = 0.0;   ///< from first touch to the wave's arrival at this place
  double clean_until_s = 0.0;  ///< and to that of the far end's reflection
  double noise_N = 0.0;        ///< rms before the impact, as a force, not low-passed
  double impulse_N_s = 0.0;    ///< from this place alone
};

/// A ball on the end of an elastic bar, from the bar's gauges: the force on the struck face, F = A
/// E strain carried back to it, compression positive, t = 0 at first touch. Deviations are one
/// sigma, of noise and baseline and of every number that the bench files with one.
struct BallImpact {
  std::vector<double> time_s;
  std::vector<double> force_N;  ///< low-passed; as long as `time_s`
  double low_pass_Hz = 0.0;     ///< passes half there, without delay
  double force_noise_N = 0.0;   ///< rms of a sample of `force_N`
  double clean_from_s = 0.0;   ///< at the first station, from first touch: the wave's arrival there
  double clean_until_s = 0.0;  ///< the face's force is known until here: then the far end answers
  Measured peak_force_N{};
  double peak_time_s = 0.0;
  Measured contact_time_s{};       ///< while the force is above the threshold
  double contact_threshold = 0.0;  ///< share of the peak: a hundredth, or what the noise allows
  bool contact_over = false;       ///< within the clean window; else the impulse is a part of it
  Measured impulse_N_s{};
  std::optional<Measured> mass_kg{};
  std::optional<Measured> incident_speed_m_per_s{};
  std::optional<Measured> rebound_speed_m_per_s{};
  std::string speed_source{};  ///< "meta", "photo-sensors"; or why there are no speeds
  std::optional<Measured> restitution_by_speed{};    ///< Vr / Vi
  std::optional<Measured> restitution_by_impulse{};  ///< J / (m Vi) - 1
  /// By speed less by impulse, with the deviation of the difference: what both share counts once.
  std::optional<Measured> restitution_difference{};
  std::optional<Measured> momentum_excess{};  ///< J / (m (Vi + Vr)) - 1
  std::vector<ForceStation> stations;

  /// By speed, else by impulse.
  [[nodiscard]] std::optional<Measured> restitution() const {
    return restitution_by_speed ? restitution_by_speed : restitution_by_impulse;
  }
};

}  // namespace kolsky
