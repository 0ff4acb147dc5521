#include "tests/accuracy/sampled_step.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "processing/waves/bar_modes.hpp"

namespace kolsky::accuracy {
namespace {

/// Along the first mode from low frequencies on, so as to stay on it.
double wavenumber_per_m(const Bar& bar, double modulus_Pa, double omega) {
  constexpr int kSteps = 400;
  std::vector<Complex> path;
  for (int k = 1; k <= kSteps; ++k) {
    path.emplace_back(0.0, omega * k / kSteps);
  }
  const ElasticSolid solid(modulus_Pa);
  return bar_modes(WaveTheory::exact, bar, solid, path).back().gamma.imag();
}

/// What a raised cosine's spectrum has of a step's.
double of_a_step(double rise_s, double omega) {
  const double share = omega * rise_s / std::numbers::pi;
  return std::cos(omega * rise_s / 2.0) / (1.0 - share * share);
}

}  // namespace

double area_by_sampling(const Bar& bar, double modulus_Pa, double to_end_m, double period_s,
                        double rise_s) {
  const double omega = 2.0 * std::numbers::pi / period_s;
  const double there_and_back =
      2.0 * std::abs(std::sin(wavenumber_per_m(bar, modulus_Pa, omega) * to_end_m));
  const double largest = 2.0 * there_and_back / omega * std::abs(of_a_step(rise_s, omega));
  const double area_s = 2.0 * to_end_m / std::sqrt(modulus_Pa / bar.density_kg_m3.value);
  return largest / area_s / std::numbers::sqrt2;
}

}  // namespace kolsky::accuracy
