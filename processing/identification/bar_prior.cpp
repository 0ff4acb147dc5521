#include "processing/identification/bar_prior.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

/// 1 for each parameter that is so, else 0.
template <class Is>
Eigen::VectorXd ones_where(const Material& material, const Is& is) {
  const auto& family = parameters_of(material.solid);
  Eigen::VectorXd ones(static_cast<Eigen::Index>(family.size()));
  for (std::size_t i = 0; i < family.size(); ++i) {
    ones[static_cast<Eigen::Index>(i)] = is(family[i]) ? 1.0 : 0.0;
  }
  return ones;
}

template <class Matrix>
Eigen::MatrixXd scaled_eigenvectors(const Matrix& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance);
  Eigen::MatrixXd root = solver.eigenvectors();
  for (Eigen::Index j = 0; j < root.cols(); ++j) {
    root.col(j) *= std::sqrt(std::max(0.0, solver.eigenvalues()[j]));
  }
  return root;
}

}  // namespace

BarPrior::BarPrior(const Material& m) : material(m) {
  from_waves = m.identified.has_value();
  const std::size_t count = m.parameters.size();
  covariance.assign(count, std::vector<double>(count));
  for (std::size_t i = 0; i < count; ++i) {
    covariance[i][i] = m.parameters[i].sd * m.parameters[i].sd;
    for (std::size_t j = 0; m.covariance && j < count; ++j) {
      covariance[i][j] = (*m.covariance)[count * i + j];
    }
  }
}

namespace {

/// @param without_density  leaves out what the density's deviation is to them
Eigen::MatrixXd directions(const BarPrior& bars, bool without_density) {
  const double density =
      without_density ? std::pow(relative_sd(bars.material.density_kg_m3), 2) : 0.0;
  const Eigen::VectorXd with_density = moves_with_density(bars.material);
  const Eigen::Index count = with_density.size();
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      covariance(i, j) =
          bars.covariance[a][b] / (bars.material.parameters[a] * bars.material.parameters[b]) -
          density * with_density[i] * with_density[j];
    }
  }
  // Three by three has a solver of its own, and results of three elements are on file to the bit.
  return count == 3 ? scaled_eigenvectors<Eigen::Matrix3d>(covariance)
                    : scaled_eigenvectors(covariance);
}

}  // namespace

double sd_by_temperature(const Bench& bench, const BarPrior& bars) {
  const bool viscoelastic =
      !bench.input.youngs_modulus_Pa || (bench.output && !bench.output->youngs_modulus_Pa);
  return viscoelastic && bench.temperature_K ? bars.softening_per_K * bench.temperature_K->sd : 0.0;
}

std::optional<std::size_t> bar_of_density(const Bench& bench, const BarPrior& bars) {
  const std::size_t first = bench.input.youngs_modulus_Pa ? 1 : 0;
  const Bar* const bar = first == 0 ? &bench.input : bench.output ? &*bench.output : nullptr;
  const bool goes =
      bars.from_waves && bar != nullptr && bar->takes_bar_model() && bar->density_kg_m3.sd > 0.0;
  return goes ? std::optional(first) : std::nullopt;
}

Eigen::MatrixXd moduli_directions(const Bench& bench, const BarPrior& bars) {
  return directions(bars, bar_of_density(bench, bars).has_value());
}

bool own_moduli_go_with_density(const Bar& bar) {
  return bar.material->identified && bar.density_kg_m3.sd > 0.0;
}

Eigen::MatrixXd own_moduli_directions(const Bar& bar) {
  return directions(BarPrior(*bar.material), own_moduli_go_with_density(bar));
}

Eigen::VectorXd moves_with_density(const Material& material) {
  return ones_where(material, [](const SolidParameter& own) { return own.stiffens(); });
}

Eigen::VectorXd moves_with_temperature(const Material& material) {
  return ones_where(
      material, [](const SolidParameter& own) { return own.is == SolidParameter::Is::modulus; });
}

void move_parameters(Material& material, const Eigen::VectorXd& relative) {
  for (std::size_t i = 0; i < material.parameters.size(); ++i) {
    material.parameters[i].value *= 1.0 + relative[static_cast<Eigen::Index>(i)];
  }
}

}  // namespace kolsky
