// Compiled for AVX2 and FMA; nothing here comes from a header with inline functions.
#include "tests/bench/impact_peak.hpp"

namespace kolsky::testing {
namespace {

using Lanes [[gnu::vector_size(32)]] = double;
constexpr int kChains = 12;  // more than the latency of a fused pair on two ports
constexpr int kRounds = 4096;

}  // namespace

double fused_in_registers() {
  Lanes sums[kChains] = {};
  Lanes factor = Lanes{} + 0.999999;
  asm volatile("" : "+x"(factor));
  for (Lanes& sum : sums) {
    asm volatile("" : "+x"(sum));  // else twelve equal chains become one
  }
  for (int i = 0; i < kRounds; ++i) {
#pragma GCC unroll 12
    for (int k = 0; k < kChains; ++k) {
      sums[k] = sums[k] * factor + factor;
    }
  }
  for (Lanes& sum : sums) {
    asm volatile("" : "+x"(sum));
  }
  return 2.0 * 4.0 * kChains * kRounds;
}

}  // namespace kolsky::testing
