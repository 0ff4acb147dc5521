#include "tests/generators/transfer_oracle.hpp"

#include <cmath>
#include <numbers>

namespace kolsky::testing {

std::vector<double> from_spectrum(
    const std::function<std::complex<double>(std::complex<double>)>& spectrum_at_iw,
    double period_s, double highest_Hz, double step_s, std::size_t samples) {
  const double damping = 14.0 / period_s;
  const auto lines = static_cast<std::size_t>(highest_Hz * period_s);
  std::vector<double> out(samples, 0.0);
  for (std::size_t k = 0; k <= lines; ++k) {
    const double w = 2.0 * std::numbers::pi * static_cast<double>(k) / period_s;
    std::complex<double> line = spectrum_at_iw({damping, w}) * (k == 0 ? 1.0 : 2.0) / period_s;
    const std::complex<double> turn = std::exp(std::complex<double>(damping, w) * step_s);
    for (double& value : out) {
      value += line.real();
      line *= turn;
    }
  }
  return out;
}

std::complex<double> unit_source_spectrum(std::complex<double> s, double knot_s) {
  return knot_s * std::pow((1.0 - std::exp(-s * knot_s)) / (s * knot_s), 6);
}

}  // namespace kolsky::testing
