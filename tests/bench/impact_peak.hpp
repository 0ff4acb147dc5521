#pragma once

namespace kolsky::testing {

/// Runs a fixed number of fused products and additions on AVX2 registers. @return operations done
[[nodiscard]] double fused_in_registers();

}  // namespace kolsky::testing
