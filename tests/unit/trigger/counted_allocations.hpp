#pragma once

namespace kolsky {

/// How often this program has called operator new, which linking counted_allocations.cpp replaces.
[[nodiscard]] long counted_allocations();

}  // namespace kolsky
