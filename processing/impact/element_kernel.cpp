#include "processing/impact/element_kernel.hpp"

#include <array>

namespace kolsky::impact {

extern const ElementKernel kPortableKernel;
#ifdef KOLSKY_X86_KERNELS
extern const ElementKernel kAvx2Kernel;
extern const ElementKernel kAvx512Kernel;
#endif

namespace {

struct Kernels {
  std::array<const ElementKernel*, 3> list{};
  std::size_t count = 0;
};

Kernels find_kernels() {
  Kernels kernels;
  kernels.list[kernels.count++] = &kPortableKernel;
#ifdef KOLSKY_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0) {
    kernels.list[kernels.count++] = &kAvx2Kernel;
    if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
        __builtin_cpu_supports("avx512vl") != 0) {
      kernels.list[kernels.count++] = &kAvx512Kernel;
    }
  }
#endif
  return kernels;
}

const Kernels& kernels() {
  static const Kernels found = find_kernels();
  return found;
}

}  // namespace

const ElementKernel& element_kernel() {
  return *kernels().list.at(kernels().count - 1);
}

const ElementKernel* const* runnable_kernels(std::size_t& count) {
  count = kernels().count;
  return kernels().list.data();
}

}  // namespace kolsky::impact
