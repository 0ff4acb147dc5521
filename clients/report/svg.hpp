#pragma once

#include <string>

#include "clients/figure/figure.hpp"

namespace kolsky {

/// A figure as a self-contained SVG page: panels two by two, axes with marks and units, a legend
/// where there is more than one line. Lines keep every extreme of the data: what is left out could
/// not be seen.
[[nodiscard]] std::string render_svg(const Figure& figure);

}  // namespace kolsky
