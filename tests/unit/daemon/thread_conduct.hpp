#pragma once

#include <cstdint>

namespace kolsky {

/// What threads do that one which acquires must not.
struct ThreadConduct {
  std::uint64_t allocations = 0;
  std::uint64_t locks = 0;   ///< mutexes taken
  std::uint64_t writes = 0;  ///< to any file, standard output included
  bool operator==(const ThreadConduct&) const = default;
};

/// Whether what the calling thread does is counted from now on.
void watch_conduct(bool watched) noexcept;
/// Of all threads that were watched.
[[nodiscard]] ThreadConduct watched_conduct() noexcept;

/// A sanitizer keeps these functions to itself; nothing is counted then.
#ifdef KOLSKY_SANITIZED
inline constexpr bool kWatchesConduct = false;
#else
inline constexpr bool kWatchesConduct = true;
#endif

}  // namespace kolsky
