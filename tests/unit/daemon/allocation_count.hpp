#pragma once

#include <cstdint>

namespace kolsky {

/// Whether what the calling thread allocates is counted from now on.
void count_allocations(bool counted) noexcept;
[[nodiscard]] std::uint64_t counted_allocations() noexcept;

/// A sanitizer keeps operator new to itself; nothing is counted then.
#ifdef KOLSKY_SANITIZED
inline constexpr bool kCountsAllocations = false;
#else
inline constexpr bool kCountsAllocations = true;
#endif

}  // namespace kolsky
