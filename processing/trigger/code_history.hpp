#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky {

/// The last so many codes of one channel, by tick.
class CodeHistory {
 public:
  explicit CodeHistory(std::size_t samples) : codes_(std::bit_ceil(samples)) {}

  template <class Code>
  void append(Tick first_tick, std::span<const Code> codes) {
    const std::size_t kept = std::min(codes.size(), codes_.size());
    const std::size_t skipped = codes.size() - kept;
    for (std::size_t i = skipped; i < codes.size(); ++i) {
      codes_[slot(first_tick + static_cast<Tick>(i))] = codes[i];
    }
  }
  [[nodiscard]] std::int32_t at(Tick tick) const { return codes_[slot(tick)]; }
  [[nodiscard]] std::size_t capacity() const { return codes_.size(); }

 private:
  [[nodiscard]] std::size_t slot(Tick tick) const {
    return static_cast<std::size_t>(tick) & (codes_.size() - 1);
  }
  std::vector<std::int32_t> codes_;
};

}  // namespace kolsky
