#pragma once

#include <string>
#include <vector>

namespace kolsky {

/// What an axis shows. `unit` is the unit of the data, SI: "Pa", "N", "s", "1/s", "V", "strain",
/// ...
struct Axis {
  std::string name;
  std::string unit;
};

/// One line, drawn in the order of its points. x and y have the same length; a point that is not
/// finite breaks the line.
struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
};

/// One pair of axes, in SI. How it is drawn (text, SVG) is the renderer's business.
struct Panel {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series;
  double shaded = 0.0;  ///< y from -shaded to shaded is set off where a renderer can; 0: nothing
};

/// A page of panels.
struct Figure {
  std::string title;
  std::vector<std::string> notes;  ///< lines below the title
  std::vector<Panel> panels;
};

}  // namespace kolsky
