#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace kolsky {

/// Samples that a digitiser lost without saying so.
struct LostSamples {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// The first stretch of one reading, of a sample or more, to which a record jumps and from which it
/// jumps back to where it was, each time far beyond noise and beyond what it does from sample to
/// sample around: strain of a bar, whose waves are longer than it is thick, does not.
/// @param quiet  samples before the pulse, which tell the noise
[[nodiscard]] std::optional<LostSamples> lost_samples(std::span<const double> readings,
                                                      std::size_t quiet);

}  // namespace kolsky
