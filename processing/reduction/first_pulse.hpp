#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace kolsky {

/// Fewest samples before a pulse that a baseline and a noise can be taken from.
inline constexpr std::size_t kFewestQuiet = 32;

/// The first pulse of a record whose scale and sign are not known yet.
struct FirstPulse {
  std::size_t rise = 0;   ///< last sample below half of the height
  double half = 0.0;      ///< where it passes half of the height [samples]
  double foot = 0.0;      ///< where it begins [samples]
  double height = 0.0;    ///< in its own sense, above what was before it
  double sense = 1.0;     ///< sign of the pulse as it is read
  std::size_t quiet = 0;  ///< samples before it, clear of its foot
};

/// Finds the first pulse that lasts 5 us at least; its height is that within 500 us of its rise.
/// @return nothing where none stands out of the noise
[[nodiscard]] std::optional<FirstPulse> first_pulse(std::span<const double> record, double rate_Hz);

/// Of the noise: below that what is found first may by chance be a wave that came back inverted.
inline constexpr double kFarOut = 20.0;
/// @param record  in which the pulse was found
[[nodiscard]] bool stands_far_out(std::span<const double> record, const FirstPulse& pulse);

/// How far behind its rise a pulse's own peak is looked for.
[[nodiscard]] std::size_t pulse_reach(double rate_Hz);

}  // namespace kolsky
