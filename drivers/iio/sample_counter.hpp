#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/iio/scan_format.hpp"
#include "processing/base/time.hpp"

namespace kolsky {

/// Follows the running sample number that a device puts beside every sample (an IIO channel of type
/// "count"), modulo 2^bits, so that holes are known to the sample.
class SampleCounter {
 public:
  explicit SampleCounter(const ScanFormat& format) : format_(format) {}

  /// How many samples are missing between the last one noted and the one at `value`. 0 before any
  /// was noted.
  /// @param possible  the most that can be missing, by the time that went by
  /// @return none where the number cannot be trusted: it says more than is possible (the device
  /// counts from
  ///   anew), or so much time went by that it may have gone round
  [[nodiscard]] std::optional<Tick> missing_before(const std::byte* value,
                                                   Tick possible) const noexcept;

  /// How many of the samples from `first` on are numbered without a hole, at least 1.
  /// @param samples  how many there are, at least 1
  [[nodiscard]] std::size_t run_length(const std::byte* first, std::ptrdiff_t stride,
                                       std::size_t samples) const noexcept;

  /// Remembers the number of the last sample delivered.
  void note(const std::byte* value) noexcept { last_ = read_unsigned(format_, value); }

 private:
  [[nodiscard]] std::uint64_t steps(std::uint64_t from, std::uint64_t to) const noexcept;

  ScanFormat format_;
  std::optional<std::uint64_t> last_;
};

}  // namespace kolsky
