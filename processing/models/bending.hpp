#pragma once

#include <span>
#include <vector>

#include "processing/models/scene.hpp"

namespace kolsky {

/// Whether any gauge reads bending.
[[nodiscard]] bool bends(const Scene& scene);

/// Adds what gauges with `offset_m` read of bending in the input bar, struck off its axis: a
/// Timoshenko beam whose end carries the moment of the axial force at unit eccentricity. With
/// curvature kappa per unit eccentricity the reading is offset x radius x kappa.
/// @param struck_end  mean strain there, of waves both ways: the force is theirs together, and a
///   wave that comes back to a free end makes none
/// @param readings  by gauge, per unit of what `struck_end` is per unit of (see Transfers)
void add_bending(const Scene& scene, std::span<const Complex> struck_end,
                 std::vector<std::vector<Complex>>& readings);

}  // namespace kolsky
