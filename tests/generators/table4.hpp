#pragma once

#include <array>

#include "drivers/simulated/rod.hpp"

namespace kolsky::testing {

/// PMMA as the paper's Table 4 has it.
struct PublishedPmma {
  const char* source;
  RodMaterial material;
  double poisson_ratio;
};

inline const std::array<PublishedPmma, 4> kTable4{{
    {"present work", {1180.0, 5.66e9, 37.0e9, 1.81e6}, 0.360},
    {"Sogabe and Tsuzuki", {1183.0, 5.25e9, 16.9e9, 2.13e6}, 0.365},
    {"Bussac et al.", {1183.0, 5.78e9, 72.3e9, 4.75e6}, 0.360},
    {"Ahonsi et al.", {1190.0, 5.99e9, 28.5e9, 0.68e6}, 0.380},
}};

}  // namespace kolsky::testing
