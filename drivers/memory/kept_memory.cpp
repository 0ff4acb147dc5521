#include "drivers/memory/kept_memory.hpp"

#include <malloc.h>

namespace kolsky {

void keep_freed_memory() noexcept {
  constexpr int kMost_bytes = 256 << 20;
  constexpr int kAtOnce_bytes = 16 << 20;
  constexpr int kMostOnHeap_bytes = 32 << 20;  // the C library takes no more
  mallopt(M_TRIM_THRESHOLD, kMost_bytes);
  mallopt(M_MMAP_THRESHOLD, kMostOnHeap_bytes);
  mallopt(M_TOP_PAD, kAtOnce_bytes);
}

}  // namespace kolsky
