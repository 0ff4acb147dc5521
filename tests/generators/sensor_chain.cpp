#include "tests/generators/sensor_chain.hpp"

#include <cmath>

namespace kolsky::testing {

std::vector<double> one_pole(const std::vector<double>& input, double step_s, double tau_s) {
  if (tau_s <= 0.0) {
    return input;
  }
  const double x = step_s / tau_s;
  const double keep = std::exp(-x);
  const double mean = -std::expm1(-x) / x;
  std::vector<double> out(input.size());
  double value = 0.0;
  double before = 0.0;
  for (std::size_t n = 0; n < input.size(); ++n) {
    value = keep * value + (mean - keep) * before + (1.0 - mean) * input[n];
    before = input[n];
    out[n] = value;
  }
  return out;
}

void bend(std::vector<double>& strain, double b) {
  for (double& value : strain) {
    value *= 1.0 + b * value;
  }
}

}  // namespace kolsky::testing
