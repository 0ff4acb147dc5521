#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace kolsky {

/// Sum, sum of squares and extremes of a run of codes: what tells a quiet run from one worth a
/// look. Of 16-bit codes the sums are exact (runs of up to 2^23 samples); of 32-bit codes the sum
/// is exact below 2^53 and the squares are to double precision. All zero for an empty run.
struct RunStatistics {
  std::int64_t count = 0;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  std::int32_t minimum = 0;
  std::int32_t maximum = 0;

  /// Of this run and another together.
  [[nodiscard]] RunStatistics joined(const RunStatistics& other) const noexcept {
    if (count == 0) return other;
    if (other.count == 0) return *this;
    return {count + other.count, sum + other.sum, sum_of_squares + other.sum_of_squares,
            std::min(minimum, other.minimum), std::max(maximum, other.maximum)};
  }
  friend bool operator==(const RunStatistics&, const RunStatistics&) = default;
};

[[nodiscard]] RunStatistics run_statistics(std::span<const std::int16_t> codes) noexcept;
[[nodiscard]] RunStatistics run_statistics(std::span<const std::int32_t> codes) noexcept;

/// The same while copying, at little more than the cost of the copy. The runs do not overlap.
/// @pre equal sizes
RunStatistics copy_with_statistics(std::span<const std::int16_t> from,
                                   std::span<std::int16_t> to) noexcept;
RunStatistics copy_with_statistics(std::span<const std::int32_t> from,
                                   std::span<std::int32_t> to) noexcept;

/// The deviation of one code from a pivot as DeviationSums counts it.
[[nodiscard]] constexpr std::int32_t held_deviation(std::int32_t code,
                                                    std::int32_t pivot) noexcept {
  constexpr std::int64_t kLimit = std::int64_t{1} << 27;
  return static_cast<std::int32_t>(std::clamp(std::int64_t{code} - pivot, -kLimit, kLimit));
}

/// Exact sums of a short run's deviations from a whole number near its mean, and its extremes.
/// Being integers they add up to the same whatever the pieces a run came in. Deviations beyond 2^27
/// count as 2^27; at most 512 samples.
struct DeviationSums {
  std::int64_t count = 0;
  std::int64_t sum = 0;
  std::int64_t sum_of_squares = 0;
};

[[nodiscard]] DeviationSums deviation_sums(std::span<const std::int16_t> codes,
                                           std::int32_t pivot) noexcept;
[[nodiscard]] DeviationSums deviation_sums(std::span<const std::int32_t> codes,
                                           std::int32_t pivot) noexcept;

/// The sums alone and quickly, of a run whose extremes are known to be near the pivot.
struct NearSums {
  std::int32_t sum = 0;
  std::int32_t sum_of_squares = 0;
};

/// @pre at most 512 codes, none further than kNear from the pivot
inline constexpr std::int32_t kNear = 2047;
[[nodiscard]] NearSums near_sums(std::span<const std::int16_t> codes, std::int32_t pivot) noexcept;
[[nodiscard]] NearSums near_sums(std::span<const std::int32_t> codes, std::int32_t pivot) noexcept;

struct Extremes {
  std::int32_t minimum = 0;
  std::int32_t maximum = 0;
};

/// @pre at least one code
[[nodiscard]] Extremes extremes(std::span<const std::int16_t> codes) noexcept;
[[nodiscard]] Extremes extremes(std::span<const std::int32_t> codes) noexcept;

}  // namespace kolsky
