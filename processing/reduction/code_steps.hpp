#pragma once

#include <span>
#include <vector>

namespace kolsky {

/// The least by which two of a record's values differ: a step of its converter. Infinite where none
/// do.
[[nodiscard]] double least_step(std::span<const double> readings);

/// From one value that a record takes to the next, in rising order; none where it takes too many to
/// show its codes.
[[nodiscard]] std::vector<double> code_steps(std::span<const double> readings);

/// The step between neighbouring codes where the record takes few enough values to show it; 0 where
/// it does not.
[[nodiscard]] double code_step(std::span<const double> readings);

}  // namespace kolsky
