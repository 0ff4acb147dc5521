#pragma once

#include <string>
#include <string_view>

#include "clients/figure/figure.hpp"

namespace kolsky {

/// A figure as a self-contained SVG page: panels two by two, axes with marks and units, a legend
/// where there is more than one line. Lines keep every extreme of the data: what is left out could
/// not be seen.
[[nodiscard]] std::string render_svg(const Figure& figure);

/// One panel as an <svg> element for a page of HTML that holds `panel_style` in its head.
/// @param number  tells it from the other panels of the page
[[nodiscard]] std::string panel_svg(const Panel& panel, double width, double height,
                                    std::size_t number);

/// The rules of style that panels need.
[[nodiscard]] std::string panel_style();

/// Text with what HTML and XML would take for markup written out.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace kolsky
