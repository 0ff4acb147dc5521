#define KOLSKY_LANES 8
#define KOLSKY_LANE_NUMBERS 0, 1, 2, 3, 4, 5, 6, 7
#include "processing/impact/element_kernel.inc"

namespace kolsky::impact {
extern const ElementKernel kAvx2Kernel;
const ElementKernel kAvx2Kernel{"AVX2", KOLSKY_LANES, run<false>, run<true>, gather, move};
}  // namespace kolsky::impact
