#include "processing/criticism/noise/smooth_power.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace kolsky {

SmoothPower smooth_power(const std::vector<double>& power) {
  const std::size_t bins = power.size();
  std::array<double, 3> s{};
  // White where the upper half says so, the rest from the lowest bins: the start of the ascent.
  const std::size_t half = bins / 2;
  s[0] = std::max(
      1e-6, std::accumulate(power.begin() + static_cast<std::ptrdiff_t>(half), power.end(), 0.0) /
                static_cast<double>(bins - half));
  const double lowest = std::max(1e-6, (power[0] + power[1]) / 2.0 - s[0]);
  s[1] = s[2] = std::max(0.1 * s[0], lowest / 2.0);
  std::array<std::vector<double>, 3> shape;
  for (std::size_t k = 0; k < bins; ++k) {
    const double per_f = 1.0 / static_cast<double>(k + 1);
    shape[0].push_back(1.0);
    shape[1].push_back(per_f);
    shape[2].push_back(per_f * per_f);
  }
  // Expectation and maximisation: each term takes its share of every bin's power. Slow and safe.
  std::vector<double> per_total(bins);
  for (int iteration = 0; iteration < 200; ++iteration) {
    for (std::size_t k = 0; k < bins; ++k) {
      per_total[k] = 1.0 / (s[0] + s[1] * shape[1][k] + s[2] * shape[2][k]);
    }
    for (std::size_t term = 0; term < s.size(); ++term) {
      double pull = 0.0;
      double weight = 0.0;
      for (std::size_t k = 0; k < bins; ++k) {
        const double part = shape[term][k] * per_total[k];
        pull += part * power[k] * per_total[k];
        weight += part;
      }
      s[term] *= pull / weight;
    }
  }
  return {s[0], s[1], s[2]};
}

}  // namespace kolsky
