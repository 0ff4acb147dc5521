#pragma once

#include "processing/base/workers.hpp"

namespace kolsky::cli {

/// As many threads as the machine has cores. What a task throws ends the work and comes out.
[[nodiscard]] Workers all_cores();

}  // namespace kolsky::cli
