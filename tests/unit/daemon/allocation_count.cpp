#include "tests/unit/daemon/allocation_count.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::uint64_t> allocations{0};
thread_local bool counts = false;

}  // namespace

namespace kolsky {

void count_allocations(bool counted) noexcept {
  counts = counted;
}

std::uint64_t counted_allocations() noexcept {
  return allocations.load();
}

}  // namespace kolsky

#ifndef KOLSKY_SANITIZED
void* operator new(std::size_t size) {
  if (counts) {
    allocations.fetch_add(1);
  }
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}
void* operator new[](std::size_t size) {
  return ::operator new(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
#endif
