#define KOLSKY_LANES 8
#include "processing/impact/element_kernel.inc"

namespace kolsky::impact {
extern const ElementKernel kAvx512Kernel;
const ElementKernel kAvx512Kernel{"AVX-512", KOLSKY_LANES, run<false>, run<true>};
}  // namespace kolsky::impact
