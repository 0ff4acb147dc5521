#pragma once

#include <string>
#include <vector>

#include "clients/figure/figure.hpp"
#include "processing/impact/impact_history.hpp"

namespace kolsky {

/// Deformed balls side by side, both halves of the section, coloured by axial stress (compression
/// positive) on one scale that stands beside them; below them the figure's panels. Self-contained.
[[nodiscard]] std::string render_fields_svg(const std::vector<impact::Field>& fields,
                                            const Figure& figure);

}  // namespace kolsky
