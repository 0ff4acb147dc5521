#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/digitiser/digitiser.hpp"

namespace kolsky {

/// How one channel's value stands in a scan, in IIO's terms: `le:s12/16>>4` is 12 bits, 2 bytes,
/// shift 4.
struct ScanFormat {
  unsigned int storage_bytes = 2;  ///< 1, 2, 4 or 8
  unsigned int bits = 16;
  unsigned int shift = 0;
  bool is_signed = true;
  bool big_endian = false;

  /// 1, 2, 4 or 8 bytes that hold bits + shift.
  [[nodiscard]] bool valid() const noexcept;

  /// What is taken from each value before it is delivered: unsigned codes of exactly 16 or 32 bits
  /// do not fit a signed integer of that size, so they are delivered half a range lower and the
  /// channel's offset is that much higher. 0 for all others.
  [[nodiscard]] std::int64_t bias() const noexcept;

  /// Least and greatest code as delivered. @pre valid(), bits <= 32
  [[nodiscard]] std::int32_t code_min() const noexcept;
  [[nodiscard]] std::int32_t code_max() const noexcept;
};

/// Turns one channel of interleaved scans into native integers.
class ScanDecoder {
 public:
  /// @pre format.valid(), at most 32 bits, and its codes fit `to`
  ScanDecoder(const ScanFormat& format, SampleFormat to);

  /// @param first   the channel's bytes in the first scan
  /// @param stride  bytes from one scan to the next
  /// @param out     samples x sample_bytes(to), aligned for its integers
  void decode(const std::byte* first, std::ptrdiff_t stride, std::size_t samples,
              std::byte* out) const noexcept {
    decode_(format_, first, stride, samples, out);
  }

 private:
  using Function = void (*)(const ScanFormat&, const std::byte*, std::ptrdiff_t, std::size_t,
                            std::byte*) noexcept;
  ScanFormat format_;
  Function decode_;
};

/// One value as an unsigned number of format.bits bits: how a counter is read.
[[nodiscard]] std::uint64_t read_unsigned(const ScanFormat& format,
                                          const std::byte* value) noexcept;

}  // namespace kolsky
