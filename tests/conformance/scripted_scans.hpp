#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "tests/conformance/pattern.hpp"
#include "tests/conformance/scripted_iiod.hpp"

namespace kolsky {

/// Interleaved 16-bit scans of the test pattern, as many channels as asked, with a 32-bit counter
/// that shows the tick if wanted.
[[nodiscard]] inline std::string pattern_scans(Tick first_tick, std::size_t samples,
                                               std::size_t channels = 2, bool counted = false) {
  std::string bytes;
  for (std::size_t i = 0; i < samples; ++i) {
    const Tick tick = first_tick + static_cast<Tick>(i);
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const auto code = static_cast<std::int16_t>(pattern_code(channel, tick));
      bytes.append(reinterpret_cast<const char*>(&code), sizeof code);
    }
    if (counted) {
      const auto count = static_cast<std::uint32_t>(tick);
      bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    }
  }
  return bytes;
}

/// A scripted device of two channels that numbers its samples: scans of 8 bytes, mask 7.
[[nodiscard]] inline ScriptedDevice counting_device() {
  ScriptedDevice device;
  device.channels.push_back({"count0", "le:u32/32>>0", {}});
  return device;
}

}  // namespace kolsky
