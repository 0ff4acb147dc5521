#pragma once

#include <span>
#include <string>

#include "clients/figure/figure.hpp"
#include "clients/figure/layout.hpp"
#include "clients/terminal/terminal.hpp"

namespace kolsky {

struct PlotSize {
  int columns = 80;  ///< of the whole, labels included
  int rows = 16;     ///< of the area between the axes
};

/// A panel as text: title and legend, braille lines between axes with marks and units. Ends with a
/// newline. Without colour the second and third line are dashed, so that they can be told apart.
[[nodiscard]] std::string plot_text(const Panel& panel, PlotSize size, bool colour);

/// The band between two traces as rows of braille, newest at the right: what a scope shows of a
/// stream.
/// @param minimum, maximum  same length; squeezed to the width
[[nodiscard]] std::string envelope_text(std::span<const double> minimum,
                                        std::span<const double> maximum, AxisRange range,
                                        PlotSize size, bool colour);

}  // namespace kolsky
