#define KOLSKY_LANES 4
#define KOLSKY_LANE_NUMBERS 0, 1, 2, 3
#include "processing/impact/element_kernel.inc"

namespace kolsky::impact {
extern const ElementKernel kPortableKernel;
const ElementKernel kPortableKernel{"portable", KOLSKY_LANES, run<false>, run<true>, gather, move};
}  // namespace kolsky::impact
