#pragma once

#include "processing/uncertainty/executor.hpp"

namespace kolsky::cli {

/// Spreads tasks over the machine's cores.
[[nodiscard]] Executor thread_executor();

}  // namespace kolsky::cli
