#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Time of every sample: from the trigger, or without one from sample 0.
[[nodiscard]] std::vector<double> sample_times_s(const Shot& shot);

/// A channel in its gauge's unit.
[[nodiscard]] std::vector<double> gauge_values(const ChannelRecord& channel);

/// Whether every code can be kept as a 16-bit integer.
[[nodiscard]] bool fits_16_bits(const ChannelRecord& channel);

/// Nanoseconds since 1970 as "2024-02-29T12:34:56.123456789Z".
[[nodiscard]] std::string iso8601_utc(std::int64_t utc_ns);

}  // namespace kolsky
