#pragma once

#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"

namespace kolsky {

/// The striker's push on the impacted end: raised-cosine edges, then steps, each as long as a wave
/// needs to go to and fro in the striker.
struct PlannedPulse {
  std::vector<double> step_force_N;
  double step_s = 0.0;
  double rise_s = 0.0;

  [[nodiscard]] double force_N(double time_s) const;
  [[nodiscard]] double duration_s() const {
    return step_s * static_cast<double>(step_force_N.size());
  }
};

/// From the bench's striker at a speed. The striker is of the bar's material where its own density
/// says nothing else; it pushes with V Z1 Z2 / (Z1 + Z2), and while its impedance is above the
/// bar's it goes on pushing in steps, each (Z1 - Z2) / (Z1 + Z2) of the one before.
/// @param rise_s  0: the time a wave needs along the bar's diameter
/// @throws InputError where the bench files no striker, or not its length
[[nodiscard]] PlannedPulse pulse_of_striker(const Bench& bench, const Material& bars,
                                            double speed_m_per_s, double rise_s);

/// From the largest strain it makes as it passes the input bar's first gauge, which a viscoelastic
/// bar creeps to and damps on the way, and its length.
/// @throws InputError where rise and fall are longer than that
[[nodiscard]] PlannedPulse pulse_of_strain(const Bench& bench, const Material& bars, double strain,
                                           double duration_s, double rise_s);

}  // namespace kolsky
