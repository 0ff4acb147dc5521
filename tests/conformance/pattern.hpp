#pragma once

#include <cstdint>

#include "processing/base/time.hpp"

namespace kolsky {

/// What the test streams carry: 16-bit codes that step by an odd number from tick to tick, another
/// one on each channel. Each is one-to-one with the tick modulo 65536, so a lost, doubled or moved
/// sample, or a channel mistaken for another, shows at once.
[[nodiscard]] inline std::int32_t pattern_code(std::size_t channel, Tick tick) {
  const auto step = static_cast<std::uint64_t>(2 * channel + 1);
  return static_cast<std::int16_t>(static_cast<std::uint64_t>(tick) * step + 1000 * channel);
}

/// The tick, modulo 65536, at which channel 0 has this code.
[[nodiscard]] inline Tick pattern_tick(std::int32_t code_of_channel_0) {
  return static_cast<std::uint16_t>(code_of_channel_0);
}

}  // namespace kolsky
