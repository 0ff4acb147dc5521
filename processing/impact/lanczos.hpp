#pragma once

#include <functional>
#include <span>
#include <vector>

namespace kolsky::impact {

/// Largest eigenvalue of a symmetric operator, from below: within a thousandth after some thirty
/// steps for the operators of meshes. The same for every call.
/// @param start  not orthogonal to the eigenvector sought; random will do
/// @param apply  writes the operator times the first span into the second
[[nodiscard]] double largest_eigenvalue(
    std::vector<double> start, int steps,
    const std::function<void(std::span<const double>, std::span<double>)>& apply);

/// The scalar product.
[[nodiscard]] double dot(std::span<const double> a, std::span<const double> b);

}  // namespace kolsky::impact
