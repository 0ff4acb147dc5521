#pragma once

#include <cstdint>
#include <ctime>

namespace kolsky {

[[nodiscard]] inline std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Time that only goes forward: durations and order.
[[nodiscard]] inline std::int64_t monotonic_ns() noexcept {
  return clock_ns(CLOCK_MONOTONIC);
}

/// What the calendar says now of a moment on the monotonic clock: for labels only, it may be
/// stepped.
[[nodiscard]] inline std::int64_t utc_of_ns(std::int64_t moment_monotonic_ns) noexcept {
  return moment_monotonic_ns + (clock_ns(CLOCK_REALTIME) - monotonic_ns());
}

}  // namespace kolsky
