#include "processing/waves/each_exp.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/base/wide.hpp"

// glibc has these for several numbers at a time, and says so in its headers only where errors of
// some last digits may be traded for speed everywhere (-ffast-math). Here they may.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
extern "C" {
__attribute__((simd("notinbranch"))) double exp(double) noexcept;
__attribute__((simd("notinbranch"))) double sin(double) noexcept;
__attribute__((simd("notinbranch"))) double cos(double) noexcept;
}
#endif

namespace kolsky {

namespace {

constexpr std::size_t kBlock = 128;
using Block = std::array<double, kBlock>;

/// In loops of their own: a sine and a cosine of one angle side by side become a call of sincos, of
/// which there is no wide version.
KOLSKY_WIDE void exp_of(Block& re, Block& im) {
  Block size;
  for (std::size_t i = 0; i < kBlock; ++i) {
    size[i] = exp(re[i]);
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    re[i] = size[i] * cos(im[i]);
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    im[i] = size[i] * sin(im[i]);
  }
}

}  // namespace

void each_exp(std::span<Complex> values) {
  Block re{};
  Block im{};
  for (std::size_t first = 0; first < values.size(); first += kBlock) {
    const auto block = values.subspan(first, std::min(kBlock, values.size() - first));
    for (std::size_t i = 0; i < block.size(); ++i) {
      re[i] = block[i].real();
      im[i] = block[i].imag();
    }
    exp_of(re, im);
    for (std::size_t i = 0; i < block.size(); ++i) {
      block[i] = {re[i], im[i]};
    }
  }
}

}  // namespace kolsky
