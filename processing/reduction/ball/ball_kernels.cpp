#include "processing/reduction/ball/ball_kernels.hpp"

#include <algorithm>

#include "processing/waves/seen_modes.hpp"

namespace kolsky {

namespace {

/// The low-pass looks ahead: what it looks for before the record's start wraps round to the end of
/// the transform, where undamping raises it. Elastic waves need little damping, and room keeps it
/// apart.
constexpr double kWrapDamping = 1e-2;
constexpr double kPadding_s = 0.5e-3;

}  // namespace

BallPlans::BallPlans(const BallPlanKey& k)
    : key(k),
      transform(k.samples + k.delay + static_cast<std::size_t>(kPadding_s * k.rate.Hz()),
                k.rate.period_s(), kWrapDamping),
      band(transform, k.longest_pulse),
      path(transform.bins()),
      spectrum(transform.bins()) {
  for (std::size_t n = 0; n < path.size(); ++n) {
    path[n] = transform.s(n);
  }
}

std::vector<double> ball_kernel_numbers(const Bar& bar, WaveTheory theory,
                                        const std::vector<BarStation>& stations) {
  std::vector<double> numbers{static_cast<double>(theory), bar.area_m2(),
                              bar.density_kg_m3,           *bar.youngs_modulus_Pa,
                              bar.poisson_ratio,           bar.dispersion_radius_m()};
  for (const BarStation& station : stations) {
    numbers.push_back(station.gauge_to_specimen_m);
  }
  return numbers;
}

void reach(BallKernels& kernels, const BallPlans& plans, const Bar& bar, WaveTheory theory,
           const std::vector<BarStation>& stations, std::size_t bins) {
  if (kernels.bins() >= bins) {
    return;
  }
  const std::vector<Complex> path(plans.path.begin(),
                                  plans.path.begin() + static_cast<std::ptrdiff_t>(bins));
  const ElasticSolid solid(*bar.youngs_modulus_Pa);
  const std::vector<BarMode> modes = seen_modes(theory, bar, solid, path);
  kernels.blind_from_Hz = blind_from_Hz(modes, path);
  const double delay_s = static_cast<double>(plans.key.delay) * plans.key.rate.period_s();
  kernels.force_of_strain.assign(stations.size(), std::vector<Complex>(bins));
  for (std::size_t i = 0; i < stations.size(); ++i) {
    for (std::size_t k = 0; k < bins; ++k) {
      const Complex s = path[k];
      const Complex stress = bar.density_kg_m3.value * s * s / (modes[k].gamma * modes[k].gamma);
      kernels.force_of_strain[i][k] =
          bar.area_m2() * stress * modes[k].mean_over_surface *
          std::exp(modes[k].gamma * stations[i].gauge_to_specimen_m - s * delay_s);
    }
  }
}

}  // namespace kolsky
