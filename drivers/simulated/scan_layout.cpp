#include "drivers/simulated/scan_layout.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace kolsky {

namespace {

std::size_t round_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

template <typename Integer>
void interleave(std::span<const std::int32_t> codes, std::byte* out, std::size_t stride) {
  for (const std::int32_t code : codes) {
    const auto stored = static_cast<Integer>(code);
    std::memcpy(out, &stored, sizeof(stored));
    out += stride;
  }
}

}  // namespace

bool enables(const std::vector<std::uint32_t>& mask, std::size_t element) {
  return element / 32 < mask.size() && ((mask[element / 32] >> (element % 32)) & 1U) != 0;
}

ScanLayout::ScanLayout(std::vector<std::uint32_t> mask,
                       const std::vector<std::size_t>& element_bytes)
    : mask_(std::move(mask)) {
  std::size_t largest = 1;
  for (std::size_t channel = 0; channel < element_bytes.size(); ++channel) {
    if (!enables(mask_, channel)) {
      continue;
    }
    const std::size_t size = element_bytes[channel];
    elements_.push_back({channel, round_up(bytes_, size), size});
    bytes_ = elements_.back().offset + size;
    largest = std::max(largest, size);
  }
  bytes_ = round_up(bytes_, largest);
}

std::string ScanLayout::mask_text() const {
  std::string text;
  for (auto word = mask_.rbegin(); word != mask_.rend(); ++word) {
    char digits[9];
    std::snprintf(digits, sizeof digits, "%08x", *word);
    text += digits;
  }
  return text;
}

void ScanLayout::place(const Element& element, std::span<const std::int32_t> codes,
                       std::span<std::byte> scans) const {
  std::byte* const first = scans.data() + element.offset;
  if (element.bytes == sizeof(std::int16_t)) {
    interleave<std::int16_t>(codes, first, bytes_);
  } else {
    interleave<std::int32_t>(codes, first, bytes_);
  }
}

void ScanLayout::place_count(const Element& element, Tick first, std::span<std::byte> scans) const {
  for (std::size_t at = element.offset; at < scans.size(); at += bytes_) {
    const auto count = static_cast<std::uint32_t>(first++);
    std::memcpy(scans.data() + at, &count, sizeof count);
  }
}

}  // namespace kolsky
