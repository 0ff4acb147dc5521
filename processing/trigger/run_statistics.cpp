#include "processing/trigger/run_statistics.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "processing/base/wide.hpp"

namespace kolsky {
namespace {

struct NarrowSums {
  std::int64_t sum = 0;
  std::int64_t sum_of_squares = 0;
  std::int16_t minimum = std::numeric_limits<std::int16_t>::max();
  std::int16_t maximum = std::numeric_limits<std::int16_t>::min();
};

// Squares are summed by the two bytes of a code, x = 256 h + l, so that every product sum of a tile
// fits 32 bits: that is what the compiler turns into multiply-and-add of 16-bit lanes.
constexpr std::size_t kTile = 4096;

struct ByteSums {
  std::int32_t sum = 0;
  std::int32_t high_high = 0;
  std::int32_t high_low = 0;
  std::int32_t low_low = 0;

  [[gnu::always_inline]] void take(std::int16_t code) noexcept {
    const auto high = static_cast<std::int16_t>(code >> 8);
    const auto low = static_cast<std::int16_t>(code & 0xff);
    sum += code;
    high_high += static_cast<std::int32_t>(high) * high;
    high_low += static_cast<std::int32_t>(high) * low;
    low_low += static_cast<std::int32_t>(low) * low;
  }
  [[gnu::always_inline]] void add_to(NarrowSums& sums) const noexcept {
    sums.sum += sum;
    sums.sum_of_squares +=
        std::int64_t{65536} * high_high + std::int64_t{512} * high_low + std::int64_t{low_low};
  }
};

KOLSKY_WIDE NarrowSums narrow_sums(const std::int16_t* codes, std::size_t size) noexcept {
  NarrowSums total;
  for (std::size_t start = 0; start < size; start += kTile) {
    const std::size_t end = std::min(size, start + kTile);
    ByteSums tile;
    std::int16_t minimum = total.minimum;
    std::int16_t maximum = total.maximum;
    for (std::size_t i = start; i < end; ++i) {
      const std::int16_t code = codes[i];
      tile.take(code);
      minimum = std::min(minimum, code);
      maximum = std::max(maximum, code);
    }
    tile.add_to(total);
    total.minimum = minimum;
    total.maximum = maximum;
  }
  return total;
}

// Sums of d² and of d (d + 1), whose difference is that of d: in 16-bit lanes two
// multiply-and-adds, where a sum of d alone has to be widened first.
// Unsigned, since it overflows where codes turn out not to be near; nobody asks for it then.
struct PivotSums {
  std::uint32_t squares = 0;
  std::uint32_t next_products = 0;

  template <class Code>
  [[gnu::always_inline]] void take(Code deviation) noexcept {
    const auto next = static_cast<Code>(deviation + 1);
    squares += static_cast<std::uint32_t>(static_cast<std::int32_t>(deviation) * deviation);
    next_products += static_cast<std::uint32_t>(static_cast<std::int32_t>(deviation) * next);
  }
  [[gnu::always_inline]] [[nodiscard]] NearSums joined() const noexcept {
    return {static_cast<std::int32_t>(next_products - squares), static_cast<std::int32_t>(squares)};
  }
};

// Quiet runs stay near their first code: 2048 products of 1023 and 1024 fit 32 bits.
constexpr std::size_t kQuietTile = 2048;
constexpr int kQuietReach = 1023;

struct QuietTile {
  NearSums sums;
  std::int16_t minimum = 0;
  std::int16_t maximum = 0;
};

KOLSKY_WIDE QuietTile copy_quiet_tile(const std::int16_t* __restrict from,
                                      std::int16_t* __restrict to, std::size_t size) noexcept {
  const std::int16_t pivot = from[0];
  PivotSums sums;
  std::int16_t minimum = pivot;
  std::int16_t maximum = pivot;
  for (std::size_t i = 0; i < size; ++i) {
    const std::int16_t code = from[i];
    to[i] = code;
    sums.take(static_cast<std::int16_t>(static_cast<std::uint16_t>(code - pivot)));
    minimum = std::min(minimum, code);
    maximum = std::max(maximum, code);
  }
  return {sums.joined(), minimum, maximum};
}

NarrowSums copy_tile(const std::int16_t* from, std::int16_t* to, std::size_t size) noexcept {
  const QuietTile tile = copy_quiet_tile(from, to, size);
  const int pivot = from[0];
  if (tile.minimum < pivot - kQuietReach || tile.maximum > pivot + kQuietReach) {
    return narrow_sums(from, size);
  }
  const auto count = static_cast<std::int64_t>(size);
  const std::int64_t sum = tile.sums.sum;
  return {sum + count * pivot, tile.sums.sum_of_squares + 2 * pivot * sum + count * pivot * pivot,
          tile.minimum, tile.maximum};
}

NarrowSums narrow_copy(const std::int16_t* from, std::int16_t* to, std::size_t size) noexcept {
  NarrowSums total;
  for (std::size_t start = 0; start < size; start += kQuietTile) {
    const NarrowSums tile = copy_tile(from + start, to + start, std::min(size - start, kQuietTile));
    total.sum += tile.sum;
    total.sum_of_squares += tile.sum_of_squares;
    total.minimum = std::min(total.minimum, tile.minimum);
    total.maximum = std::max(total.maximum, tile.maximum);
  }
  return total;
}

struct WideSums {
  double sum = 0.0;
  double sum_of_squares = 0.0;
  std::int32_t minimum = std::numeric_limits<std::int32_t>::max();
  std::int32_t maximum = std::numeric_limits<std::int32_t>::min();
};

// Floating sums keep their order unless told otherwise, so the lanes are spelled out.
constexpr std::size_t kLanes = 8;

struct WideLanes {
  std::array<double, kLanes> sum{};
  std::array<double, kLanes> sum_of_squares{};
  WideSums total;

  [[gnu::always_inline]] void take(std::size_t lane, std::int32_t code) noexcept {
    const double value = code;
    sum[lane] += value;
    sum_of_squares[lane] += value * value;
    total.minimum = std::min(total.minimum, code);
    total.maximum = std::max(total.maximum, code);
  }
  [[gnu::always_inline]] WideSums joined() noexcept {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      total.sum += sum[lane];
      total.sum_of_squares += sum_of_squares[lane];
    }
    return total;
  }
};

KOLSKY_WIDE WideSums wide_sums(const std::int32_t* codes, std::size_t size) noexcept {
  WideLanes lanes;
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes.take(lane, codes[i + lane]);
  }
  for (; i < size; ++i) lanes.take(0, codes[i]);
  return lanes.joined();
}

KOLSKY_WIDE WideSums wide_copy(const std::int32_t* __restrict from, std::int32_t* __restrict to,
                               std::size_t size) noexcept {
  WideLanes lanes;
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      to[i + lane] = from[i + lane];
      lanes.take(lane, from[i + lane]);
    }
  }
  for (; i < size; ++i) {
    to[i] = from[i];
    lanes.take(0, from[i]);
  }
  return lanes.joined();
}

KOLSKY_WIDE DeviationSums wide_deviations(const std::int32_t* codes, std::size_t size,
                                          std::int32_t pivot) noexcept {
  DeviationSums sums;
  for (std::size_t i = 0; i < size; ++i) {
    const std::int32_t deviation = held_deviation(codes[i], pivot);
    sums.sum += deviation;
    sums.sum_of_squares += std::int64_t{deviation} * deviation;
  }
  sums.count = static_cast<std::int64_t>(size);
  return sums;
}

// The length that nearly all runs have; told as a constant it costs a third less.
constexpr std::size_t kWhole = 128;

// At most 512 products of 2047 and 2048 fit 32 bits. Differences modulo 2^16 are exact, being
// small, even where the pivot is off the codes' range.
[[gnu::always_inline]] inline std::int16_t near_deviation(std::int16_t code, std::int32_t pivot) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(code - pivot));
}

[[gnu::always_inline]] inline std::int32_t near_deviation(std::int32_t code, std::int32_t pivot) {
  return code - pivot;
}

template <class Code>
[[gnu::always_inline]] inline NearSums sums_near(const Code* codes, std::size_t size,
                                                 std::int32_t pivot) {
  PivotSums sums;
  for (std::size_t i = 0; i < size; ++i) sums.take(near_deviation(codes[i], pivot));
  return sums.joined();
}

template <class Code>
[[gnu::always_inline]] inline Extremes extremes_of(const Code* codes, std::size_t size) {
  Code minimum = codes[0];
  Code maximum = codes[0];
  for (std::size_t i = 0; i < size; ++i) {
    const Code code = codes[i];
    minimum = std::min(minimum, code);
    maximum = std::max(maximum, code);
  }
  return {minimum, maximum};
}

KOLSKY_WIDE NearSums narrow_near_sums(const std::int16_t* codes, std::size_t size,
                                      std::int32_t pivot) noexcept {
  return size == kWhole ? sums_near(codes, kWhole, pivot) : sums_near(codes, size, pivot);
}

KOLSKY_WIDE NearSums wide_near_sums(const std::int32_t* codes, std::size_t size,
                                    std::int32_t pivot) noexcept {
  return size == kWhole ? sums_near(codes, kWhole, pivot) : sums_near(codes, size, pivot);
}

KOLSKY_WIDE Extremes narrow_extremes(const std::int16_t* codes, std::size_t size) noexcept {
  return extremes_of(codes, size);
}

KOLSKY_WIDE Extremes wide_extremes(const std::int32_t* codes, std::size_t size) noexcept {
  return extremes_of(codes, size);
}

template <class Sums>
RunStatistics statistics_of(std::size_t size, const Sums& sums) noexcept {
  if (size == 0) return {};
  return {static_cast<std::int64_t>(size), static_cast<double>(sums.sum),
          static_cast<double>(sums.sum_of_squares), sums.minimum, sums.maximum};
}

}  // namespace

RunStatistics run_statistics(std::span<const std::int16_t> codes) noexcept {
  return statistics_of(codes.size(), narrow_sums(codes.data(), codes.size()));
}

RunStatistics run_statistics(std::span<const std::int32_t> codes) noexcept {
  return statistics_of(codes.size(), wide_sums(codes.data(), codes.size()));
}

RunStatistics copy_with_statistics(std::span<const std::int16_t> from,
                                   std::span<std::int16_t> to) noexcept {
  return statistics_of(from.size(), narrow_copy(from.data(), to.data(), from.size()));
}

RunStatistics copy_with_statistics(std::span<const std::int32_t> from,
                                   std::span<std::int32_t> to) noexcept {
  return statistics_of(from.size(), wide_copy(from.data(), to.data(), from.size()));
}

DeviationSums deviation_sums(std::span<const std::int16_t> codes, std::int32_t pivot) noexcept {
  if (codes.empty()) return {};
  const NarrowSums sums = narrow_sums(codes.data(), codes.size());
  const auto count = static_cast<std::int64_t>(codes.size());
  const std::int64_t shift = pivot;
  return {count, sums.sum - count * shift,
          sums.sum_of_squares - 2 * shift * sums.sum + count * shift * shift};
}

DeviationSums deviation_sums(std::span<const std::int32_t> codes, std::int32_t pivot) noexcept {
  if (codes.empty()) return {};
  return wide_deviations(codes.data(), codes.size(), pivot);
}

NearSums near_sums(std::span<const std::int16_t> codes, std::int32_t pivot) noexcept {
  return narrow_near_sums(codes.data(), codes.size(), pivot);
}

NearSums near_sums(std::span<const std::int32_t> codes, std::int32_t pivot) noexcept {
  return wide_near_sums(codes.data(), codes.size(), pivot);
}

Extremes extremes(std::span<const std::int16_t> codes) noexcept {
  return narrow_extremes(codes.data(), codes.size());
}

Extremes extremes(std::span<const std::int32_t> codes) noexcept {
  return wide_extremes(codes.data(), codes.size());
}

}  // namespace kolsky
