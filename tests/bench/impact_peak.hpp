#pragma once

namespace kolsky::testing {

/// Runs a fixed number of fused products and additions that stay in registers. @return operations
/// done
using FusedLoop = double (*)();

/// The loop on vectors as wide as the element loop's. @param lanes  16: AVX-512, 8: AVX2; the
/// processor has to run it
/// @return nothing for any other width
[[nodiscard]] FusedLoop fused_in_registers(int lanes);

}  // namespace kolsky::testing
