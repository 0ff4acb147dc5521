#include "drivers/iio/scan_format.hpp"

#include <bit>
#include <cstring>
#include <type_traits>

namespace kolsky {
namespace {

std::uint8_t swap_bytes(std::uint8_t value) noexcept {
  return value;
}
std::uint16_t swap_bytes(std::uint16_t value) noexcept {
  return __builtin_bswap16(value);
}
std::uint32_t swap_bytes(std::uint32_t value) noexcept {
  return __builtin_bswap32(value);
}
std::uint64_t swap_bytes(std::uint64_t value) noexcept {
  return __builtin_bswap64(value);
}

template <typename Storage>
Storage load(const std::byte* from, bool big_endian) noexcept {
  Storage value;
  std::memcpy(&value, from, sizeof value);
  return big_endian == (std::endian::native == std::endian::big) ? value : swap_bytes(value);
}

/// `Word` is the storage's integer with the sign that the value has: shifted up until its top bit
/// is the value's, then down, it is sign- or zero-extended.
template <typename Word, typename Out>
void decode_scans(const ScanFormat& format, const std::byte* first, std::ptrdiff_t stride,
                  std::size_t samples, std::byte* out) noexcept {
  using Storage = std::make_unsigned_t<Word>;
  const unsigned int width = 8 * sizeof(Storage);
  const unsigned int up = width - format.bits - format.shift;
  const unsigned int down = width - format.bits;
  const std::int64_t bias = format.bias();
  const bool big_endian = format.big_endian;
  Out* to = reinterpret_cast<Out*>(out);
  for (std::size_t i = 0; i < samples; ++i, first += stride) {
    const auto raised = static_cast<Storage>(load<Storage>(first, big_endian) << up);
    const auto value = static_cast<Word>(static_cast<Word>(raised) >> down);
    to[i] = static_cast<Out>(static_cast<std::int64_t>(value) - bias);
  }
}

template <typename Out, typename Function>
Function choose(const ScanFormat& format) noexcept {
  switch (format.storage_bytes) {
    case 1:
      return format.is_signed ? &decode_scans<std::int8_t, Out> : &decode_scans<std::uint8_t, Out>;
    case 2:
      return format.is_signed ? &decode_scans<std::int16_t, Out>
                              : &decode_scans<std::uint16_t, Out>;
    case 4:
      return format.is_signed ? &decode_scans<std::int32_t, Out>
                              : &decode_scans<std::uint32_t, Out>;
    default:
      return format.is_signed ? &decode_scans<std::int64_t, Out>
                              : &decode_scans<std::uint64_t, Out>;
  }
}

}  // namespace

bool ScanFormat::valid() const noexcept {
  const bool known =
      storage_bytes == 1 || storage_bytes == 2 || storage_bytes == 4 || storage_bytes == 8;
  return known && bits >= 1 && bits + shift <= 8 * storage_bytes;
}

std::int64_t ScanFormat::bias() const noexcept {
  return !is_signed && (bits == 16 || bits == 32) ? std::int64_t{1} << (bits - 1) : 0;
}

std::int32_t ScanFormat::code_min() const noexcept {
  const std::int64_t least = is_signed ? -(std::int64_t{1} << (bits - 1)) : 0;
  return static_cast<std::int32_t>(least - bias());
}

std::int32_t ScanFormat::code_max() const noexcept {
  const std::int64_t greatest = (std::int64_t{1} << (is_signed ? bits - 1 : bits)) - 1;
  return static_cast<std::int32_t>(greatest - bias());
}

ScanDecoder::ScanDecoder(const ScanFormat& format, SampleFormat to)
    : format_(format),
      decode_(to == SampleFormat::int16 ? choose<std::int16_t, Function>(format)
                                        : choose<std::int32_t, Function>(format)) {}

std::uint64_t read_unsigned(const ScanFormat& format, const std::byte* value) noexcept {
  std::uint64_t word = 0;
  switch (format.storage_bytes) {
    case 1:
      word = load<std::uint8_t>(value, format.big_endian);
      break;
    case 2:
      word = load<std::uint16_t>(value, format.big_endian);
      break;
    case 4:
      word = load<std::uint32_t>(value, format.big_endian);
      break;
    default:
      word = load<std::uint64_t>(value, format.big_endian);
  }
  word >>= format.shift;
  return format.bits >= 64 ? word : word & ((std::uint64_t{1} << format.bits) - 1);
}

}  // namespace kolsky
