#pragma once

#include <cstdlib>

namespace kolsky::testing {

/// Whether KOLSKY_FINE_MESHES is set: the meshes of docs/impact.md's tables, minutes in place of
/// seconds, and closer bounds.
inline bool fine_meshes() {
  return std::getenv("KOLSKY_FINE_MESHES") != nullptr;  // NOLINT(concurrency-mt-unsafe)
}

}  // namespace kolsky::testing
