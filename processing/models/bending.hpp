#pragma once

#include <cstddef>
#include <vector>

#include "processing/models/scene.hpp"

namespace kolsky {

/// Adds what gauges with `offset_m` read of bending in the input bar, struck off its axis: a
/// Timoshenko beam whose end carries the moment of the axial force at unit eccentricity. With
/// curvature kappa per unit eccentricity the reading is offset x radius x kappa.
/// @param readings  by gauge, per unit source at the reference gauge (see Transfers)
void add_bending(const Scene& scene, std::size_t reference,
                 std::vector<std::vector<Complex>>& readings);

}  // namespace kolsky
