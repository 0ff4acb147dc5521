#define KOLSKY_LANES 4
#include "processing/impact/element_kernel.inc"

namespace kolsky::impact {
extern const ElementKernel kAvx2Kernel;
const ElementKernel kAvx2Kernel{"AVX2", KOLSKY_LANES, run<false>, run<true>};
}  // namespace kolsky::impact
