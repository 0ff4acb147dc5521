#pragma once

#include <string>
#include <vector>

namespace kolsky {

/// A quantity that falls step by step towards a floor.
struct Cascade {
  struct Step {
    std::string name;
    std::string note;  ///< below the name, in small print
    double level = 0.0;
  };
  std::string title;
  std::string quantity;  ///< what the levels are
  std::string floor_name;
  std::vector<Step> steps;
  double floor = 1.0;
};

/// The cascade as an <svg> element on a logarithmic scale: what is left in blue, what each step
/// took off in orange above it, the floor as a green line. Self-contained; no script.
/// @pre levels and floor above 0
[[nodiscard]] std::string cascade_svg(const Cascade& cascade);

}  // namespace kolsky
