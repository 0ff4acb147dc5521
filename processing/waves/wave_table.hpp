#pragma once

#include <vector>

#include "processing/base/bench.hpp"
#include "processing/waves/compliance.hpp"
#include "processing/waves/wave_theory.hpp"

namespace kolsky {

/// Harmonic waves in a bar at one frequency.
struct WaveRow {
  double frequency_Hz;
  double phase_speed_m_per_s;     ///< w / k
  double attenuation_per_m;       ///< alpha, gamma = alpha + i k
  double wavenumber_per_m;        ///< k
  Complex mean_over_surface;      ///< axial strain, mean over the section by that at the surface
  Complex stress_over_strain_Pa;  ///< mean stress over mean strain, rho s^2 / gamma^2
};

/// At so many frequencies, evenly from highest_Hz / points to highest_Hz.
/// @throws InputError "points", "highest_Hz" where the first mode cannot be followed: too few
/// points for the way to the highest frequency
[[nodiscard]] std::vector<WaveRow> wave_table(WaveTheory theory, const Bar& bar,
                                              const Compliance& compliance, double highest_Hz,
                                              std::size_t points);

/// Frequency [Hz] where the bar's radius is three tenths of what an elementary wave is long: well
/// beyond what pulses in it hold, and near to where surface gauges go blind.
[[nodiscard]] double thick_from_Hz(const Bar& bar, const Compliance& compliance);

}  // namespace kolsky
