#pragma once

#include <memory>
#include <span>
#include <vector>

#include "processing/base/solid_kind.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// The solid with these parameters, in the order of `parameters_of`.
[[nodiscard]] std::unique_ptr<const Compliance> make_solid(SolidKind kind,
                                                           std::span<const double> parameters);

/// d log J / d log p along a path of s, by parameter.
[[nodiscard]] std::vector<std::vector<Complex>> log_slopes(SolidKind kind,
                                                           std::span<const double> parameters,
                                                           std::span<const Complex> path);

}  // namespace kolsky
