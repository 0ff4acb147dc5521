#pragma once

#include <span>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/waves/compliance.hpp"
#include "processing/waves/pochhammer_chree.hpp"
#include "processing/waves/wave_theory.hpp"

namespace kolsky {

/// gamma and the mean-to-surface ratio along a path of s that starts near zero.
///   elementary  gamma = s sqrt(rho J)
///   love        gamma^2 = rho s^2 / (1/J + rho nu^2 a^2 s^2 / 2)
///   exact       see PochhammerChree
/// Whatever the theory, mean stress is rho s^2 / gamma^2 and mean particle velocity s / gamma times
/// the mean strain.
[[nodiscard]] std::vector<BarMode> bar_modes(WaveTheory theory, const Bar& bar,
                                             const Compliance& compliance,
                                             const std::vector<Complex>& path);

/// Mean over surface strain from which surface gauges count as blind.
inline constexpr double kBlindMeanOverSurface = 2.0;
[[nodiscard]] bool is_blind(const BarMode& mode);

/// Where surface gauges go blind: the frequency [Hz] on the path from which they read less than
/// half of the mean strain; infinite where the path does not reach that.
[[nodiscard]] double blind_from_Hz(std::span<const BarMode> modes, std::span<const Complex> path);

/// The same of a bar up to `highest_Hz`.
[[nodiscard]] double blind_from_Hz(WaveTheory theory, const Bar& bar, const Compliance& compliance,
                                   double highest_Hz);

/// Speed of a wave's very front [m/s], 1 / sqrt(rho J(infinity)).
[[nodiscard]] double front_speed_m_per_s(const Bar& bar, const Compliance& compliance);

}  // namespace kolsky
