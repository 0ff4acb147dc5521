#pragma once

#include <string>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// A shot with every part filled: one channel of 16 and one of 24 bits, the codes of their ends
/// included.
[[nodiscard]] Shot full_shot(std::size_t samples);

/// A reduction with awkward numbers: signed zeros, subnormals, infinities, a NaN with a payload.
[[nodiscard]] Reduction awkward_reduction(std::size_t samples);

/// The doubles' bits, so that NaN compares equal to itself and 0 not to -0.
[[nodiscard]] std::string bits_of(const std::vector<double>& values);

}  // namespace kolsky
