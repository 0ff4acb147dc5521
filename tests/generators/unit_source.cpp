#include "tests/generators/unit_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/generators/interpolation.hpp"

namespace kolsky::testing {

double UnitSource::at(double time_s) const {
  constexpr std::array<double, 7> kBinomial{1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0};
  const double u = time_s / knot_s;
  if (u <= 0.0 || u >= kKnots) {
    return 0.0;
  }
  // The spline is even about its middle; the near side has fewer terms to cancel.
  const double near = u < 0.5 * kKnots ? u : kKnots - u;
  double sum = 0.0;
  for (std::size_t i = 0; static_cast<double>(i) < near; ++i) {
    sum += kBinomial[i] * std::pow(near - static_cast<double>(i), 5);
  }
  return sum / 120.0;
}

std::vector<double> superpose(std::span<const double> response, double step_s,
                              std::span<const double> coefficients, std::size_t periods_per_knot,
                              double period_s, double lag_s, std::size_t samples) {
  const auto whole = static_cast<std::ptrdiff_t>(std::floor(lag_s / period_s));
  const double rest_s = lag_s - static_cast<double>(whole) * period_s;
  const auto end = static_cast<std::ptrdiff_t>(samples);
  const auto length = static_cast<std::size_t>(std::max<std::ptrdiff_t>(end, end - whole));
  std::vector<double> shifted(length);
  for (std::size_t n = 0; n < length; ++n) {
    shifted[n] = sample_at(response, (static_cast<double>(n) * period_s - rest_s) / step_s);
  }
  std::vector<double> out(samples, 0.0);
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const double c = coefficients[k];
    const auto start = static_cast<std::ptrdiff_t>(k * periods_per_knot) + whole;
    if (c == 0.0 || start >= end) {
      continue;
    }
    const std::ptrdiff_t first = std::max<std::ptrdiff_t>(start, 0);
    const double* const values = shifted.data() - start;
    for (std::ptrdiff_t n = first; n < end; ++n) {
      out[static_cast<std::size_t>(n)] += c * values[n];
    }
  }
  return out;
}

}  // namespace kolsky::testing
