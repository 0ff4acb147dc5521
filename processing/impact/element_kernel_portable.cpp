#define KOLSKY_LANES 2
#include "processing/impact/element_kernel.inc"

namespace kolsky::impact {
extern const ElementKernel kPortableKernel;
const ElementKernel kPortableKernel{"portable", KOLSKY_LANES, run<false>, run<true>};
}  // namespace kolsky::impact
