#define KOLSKY_LANES 16
#define KOLSKY_LANE_NUMBERS 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
#include "processing/impact/element_kernel.inc"

namespace kolsky::impact {
extern const ElementKernel kAvx512Kernel;
const ElementKernel kAvx512Kernel{"AVX-512", KOLSKY_LANES, run<false>, run<true>, gather, move};
}  // namespace kolsky::impact
