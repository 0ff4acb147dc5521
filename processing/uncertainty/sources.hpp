#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"

namespace kolsky {

/// Something that is filed with a standard deviation.
struct UncertaintySource {
  std::string name;   ///< as in a bench file, "gauges.g1.position_m"
  std::string group;  ///< sources of one group share a line of the budget
  double value = 0.0;
  double sd = 0.0;  ///< in the unit of the value
  /// Moves it by so many standard deviations.
  std::function<void(Bench&, Material&, double)> move;
};

/// What is not known exactly of viscoelastic bars.
struct BarModelUncertainty {
  std::array<std::array<double, 3>, 3> covariance{};  ///< of E1_Pa, E2_Pa, eta2_Pa_s
  /// Relative change of the moduli with temperature. PMMA at room temperature: 0.3 % per kelvin.
  double softening_per_K = 3e-3;
};

/// Everything of a specimen bench and its bars that is filed with a deviation.
[[nodiscard]] std::vector<UncertaintySource> uncertainty_sources(const Bench& bench,
                                                                 const Material& bars,
                                                                 const BarModelUncertainty& model);

}  // namespace kolsky
