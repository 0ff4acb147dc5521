#pragma once

#include <cstddef>
#include <functional>

namespace kolsky {

/// Runs task(0) .. task(count - 1), each once, in any order and on any thread, and returns when all
/// are done. What a task throws comes out of the executor.
using Executor =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

/// One after the other, on the caller's thread.
void run_in_order(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace kolsky
