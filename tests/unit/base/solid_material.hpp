#pragma once

#include <vector>

#include "processing/base/material.hpp"

namespace kolsky::testing {

/// As dense as the paper's PMMA, of another solid.
/// @param values  in the order of `parameters_of`
inline Material material_of(SolidKind solid, const std::vector<double>& values) {
  Material material = paper_pmma();
  material.solid = solid;
  material.parameters.clear();
  for (const double value : values) {
    material.parameters.push_back({value});
  }
  return material;
}

}  // namespace kolsky::testing
