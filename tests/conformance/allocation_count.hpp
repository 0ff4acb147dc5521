#pragma once

#include <cstdint>

/// How often operator new was called by this thread, in programs that link allocation_count.cpp.
[[nodiscard]] std::uint64_t allocations_of_this_thread() noexcept;
