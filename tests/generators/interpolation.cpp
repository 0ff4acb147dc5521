#include "tests/generators/interpolation.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky::testing {

Stencil lagrange_stencil(double place, std::size_t nodes) {
  constexpr std::size_t kBefore = Stencil::kPoints / 2 - 1;
  constexpr auto kHalf = static_cast<double>(kBefore);
  const double first =
      std::clamp(std::floor(place) - kHalf, 0.0, static_cast<double>(nodes - Stencil::kPoints));
  Stencil stencil;
  stencil.first = static_cast<std::size_t>(first);
  const double at = place - first;
  for (std::size_t i = 0; i < Stencil::kPoints; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < Stencil::kPoints; ++j) {
      if (j != i) {
        weight *= (at - static_cast<double>(j)) / (static_cast<double>(i) - static_cast<double>(j));
      }
    }
    stencil.weight[i] = weight;
  }
  return stencil;
}

double sample_at(std::span<const double> history, double place) {
  const auto last = static_cast<double>(history.size() - 1);
  if (place <= 0.0) {
    return place < 0.0 ? 0.0 : history.front();
  }
  if (place >= last) {
    return history.back();
  }
  const Stencil stencil = lagrange_stencil(place, history.size());
  double value = 0.0;
  for (std::size_t i = 0; i < Stencil::kPoints; ++i) {
    value += stencil.weight[i] * history[stencil.first + i];
  }
  return value;
}

const GaussRule& gauss_five() {
  static const GaussRule rule{
      {-0.4530899229693320, -0.2692346550528415, 0.0, 0.2692346550528415, 0.4530899229693320},
      {0.1184634425280945, 0.2393143352496832, 0.2844444444444445, 0.2393143352496832,
       0.1184634425280945}};
  return rule;
}

}  // namespace kolsky::testing
