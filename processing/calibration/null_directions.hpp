#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace kolsky {

/// Combinations of numbers that the records do not show: of the directions in which a step that
/// matters changes the sum of squares by less than one, a basis with few members each.
/// @param information  of the data alone, per step that matters of each number
/// @return "a, b, c": those that may move together
[[nodiscard]] std::vector<std::string> null_directions(const Eigen::MatrixXd& information,
                                                       const std::vector<std::string>& names);

}  // namespace kolsky
