// Compiled for the plain processor; each function below is for the one that its name says. Nothing
// here comes from a header with inline functions.
#include "tests/bench/impact_peak.hpp"

namespace kolsky::testing {
namespace {

constexpr int kChains = 12;  // more than the latency of a fused pair on two ports
constexpr int kRounds = 4096;

}  // namespace

// Vectors of one width in registers: a function per width, as a target belongs to a function.
#define KOLSKY_FUSED_IN_REGISTERS(name, instructions, bytes)                  \
  [[gnu::target(instructions)]] static double name() {                        \
    using Lanes [[gnu::vector_size(bytes)]] = float;                          \
    Lanes sums[kChains] = {};                                                 \
    Lanes factor = Lanes{} + 0.9999F;                                         \
    asm volatile("" : "+v"(factor));                                          \
    for (Lanes & sum : sums) {                                                \
      asm volatile("" : "+v"(sum)); /* else twelve equal chains become one */ \
    }                                                                         \
    for (int i = 0; i < kRounds; ++i) {                                       \
      _Pragma("GCC unroll 12") for (int k = 0; k < kChains; ++k) {            \
        sums[k] = sums[k] * factor + factor;                                  \
      }                                                                       \
    }                                                                         \
    for (Lanes & sum : sums) {                                                \
      asm volatile("" : "+v"(sum));                                           \
    }                                                                         \
    return 2.0 * (bytes / 4.0) * kChains * kRounds;                           \
  }

#if defined(__x86_64__)
KOLSKY_FUSED_IN_REGISTERS(fused_avx2, "avx2,fma", 32)
KOLSKY_FUSED_IN_REGISTERS(fused_avx512, "avx512f,avx512dq,avx512vl,fma", 64)
#endif

FusedLoop fused_in_registers(int lanes) {
#if defined(__x86_64__)
  return lanes == 16 ? fused_avx512 : lanes == 8 ? fused_avx2 : nullptr;
#else
  return nullptr;
#endif
}

}  // namespace kolsky::testing
