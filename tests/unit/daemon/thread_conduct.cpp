#include "tests/unit/daemon/thread_conduct.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::uint64_t> allocations{0};
std::atomic<std::uint64_t> locks{0};
std::atomic<std::uint64_t> writes{0};
thread_local bool watched_here = false;

void count(std::atomic<std::uint64_t>& what) {
  if (watched_here) {
    what.fetch_add(1);
  }
}

}  // namespace

namespace kolsky {

void watch_conduct(bool watched) noexcept {
  watched_here = watched;
}

ThreadConduct watched_conduct() noexcept {
  return {allocations.load(), locks.load(), writes.load()};
}

}  // namespace kolsky

#ifndef KOLSKY_SANITIZED
namespace {

/// The function of this name that the one of this file stands before.
template <typename Function>
Function* behind(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

void* operator new(std::size_t size) {
  count(allocations);
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

extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static auto* const real = behind<int(pthread_mutex_t*)>("pthread_mutex_lock");
  count(locks);
  return real(mutex);
}
extern "C" ssize_t write(int file, const void* bytes, std::size_t size) {
  static auto* const real = behind<ssize_t(int, const void*, std::size_t)>("write");
  count(writes);
  return real(file, bytes, size);
}
extern "C" std::size_t fwrite(const void* items, std::size_t size, std::size_t number,
                              std::FILE* file) {
  static auto* const real =
      behind<std::size_t(const void*, std::size_t, std::size_t, std::FILE*)>("fwrite");
  count(writes);
  return real(items, size, number, file);
}
#endif
