#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky {

/// Codes as 32 bits each.
void copy_widened(std::span<const std::int16_t> codes, std::int32_t* to) noexcept;
void copy_widened(std::span<const std::int32_t> codes, std::int32_t* to) noexcept;

/// The last so many codes of one channel, by tick.
class CodeHistory {
 public:
  explicit CodeHistory(std::size_t samples) : kept_(samples), codes_(std::bit_ceil(samples)) {}

  template <class Code>
  void append(Tick first_tick, std::span<const Code> codes) {
    const std::size_t kept = std::min(codes.size(), kept_);
    const auto newest = codes.last(kept);
    const std::size_t start = slot(first_tick + static_cast<Tick>(codes.size() - kept));
    const std::size_t before_wrap = std::min(kept, codes_.size() - start);
    copy_widened(newest.first(before_wrap), codes_.data() + start);
    copy_widened(newest.subspan(before_wrap), codes_.data());
  }
  [[nodiscard]] std::int32_t at(Tick tick) const { return codes_[slot(tick)]; }

 private:
  [[nodiscard]] std::size_t slot(Tick tick) const {
    return static_cast<std::size_t>(tick) & (codes_.size() - 1);
  }
  std::size_t kept_;
  std::vector<std::int32_t> codes_;  ///< a power of two
};

}  // namespace kolsky
