#include "processing/trigger/code_history.hpp"

#include "processing/base/wide.hpp"

namespace kolsky {
namespace {

KOLSKY_WIDE void widen(const std::int16_t* __restrict codes, std::int32_t* __restrict to,
                       std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; ++i) to[i] = codes[i];
}

}  // namespace

void copy_widened(std::span<const std::int16_t> codes, std::int32_t* to) noexcept {
  widen(codes.data(), to, codes.size());
}

void copy_widened(std::span<const std::int32_t> codes, std::int32_t* to) noexcept {
  std::copy(codes.begin(), codes.end(), to);
}

}  // namespace kolsky
