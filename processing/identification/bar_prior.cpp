#include "processing/identification/bar_prior.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace kolsky {

BarPrior::BarPrior(const Material& m) : material(m) {
  from_waves = m.identified.has_value();
  if (m.covariance) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        covariance[i][j] = (*m.covariance)[3 * i + j];
      }
    }
    return;
  }
  covariance[0][0] = m.E1_Pa.sd * m.E1_Pa.sd;
  covariance[1][1] = m.E2_Pa.sd * m.E2_Pa.sd;
  covariance[2][2] = m.eta2_Pa_s.sd * m.eta2_Pa_s.sd;
}

double sd_by_temperature(const Bench& bench, const BarPrior& bars) {
  const bool viscoelastic =
      !bench.input.youngs_modulus_Pa || (bench.output && !bench.output->youngs_modulus_Pa);
  return viscoelastic && bench.temperature_K ? bars.softening_per_K * bench.temperature_K->sd : 0.0;
}

std::optional<std::size_t> bar_of_density(const Bench& bench, const BarPrior& bars) {
  const std::size_t first = bench.input.youngs_modulus_Pa ? 1 : 0;
  const Bar* const bar = first == 0 ? &bench.input : bench.output ? &*bench.output : nullptr;
  const bool goes =
      bars.from_waves && bar != nullptr && !bar->youngs_modulus_Pa && bar->density_kg_m3.sd > 0.0;
  return goes ? std::optional(first) : std::nullopt;
}

Eigen::Matrix3d moduli_directions(const Bench& bench, const BarPrior& bars) {
  const std::array<double, 3> scale = {bars.material.E1_Pa, bars.material.E2_Pa,
                                       bars.material.eta2_Pa_s};
  const double density =
      bar_of_density(bench, bars) ? std::pow(relative_sd(bars.material.density_kg_m3), 2) : 0.0;
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      covariance(i, j) = bars.covariance[a][b] / (scale[a] * scale[b]) - density;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d root = solver.eigenvectors();
  for (int j = 0; j < 3; ++j) {
    root.col(j) *= std::sqrt(std::max(0.0, solver.eigenvalues()[j]));
  }
  return root;
}

}  // namespace kolsky
