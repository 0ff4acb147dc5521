#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/models/softening.hpp"

namespace kolsky {

/// What the viscoelastic bars are made of, with what is not known of it.
struct BarPrior {
  Material material;
  /// Of the material's parameters, in their units.
  std::vector<std::vector<double>> covariance;
  /// Identified from waves, which show the moduli over the density alone: the deviation of the
  /// material's density is part of the covariance, as the moduli are off by what it is off by.
  bool from_waves = false;
  /// Relative loss of all springs by which a deviation of the bench's temperature counts.
  double softening_per_K = kSofteningPerK;

  /// With the material's covariance; without one its own deviations, as if they were independent.
  explicit BarPrior(const Material& m);
};

/// By what springs may be off, relative, because the temperature at which the shots were fired is
/// known to a deviation only; 0 where none is filed or no bar is viscoelastic.
[[nodiscard]] double sd_by_temperature(const Bench& bench, const BarPrior& bars);

/// The bar, 0 input or 1 output, with whose density the moduli go: the first viscoelastic one,
/// where they are from waves and its density may be off.
[[nodiscard]] std::optional<std::size_t> bar_of_density(const Bench& bench, const BarPrior& bars);

/// Independent directions in which the material's parameters may be off together, relative, one
/// deviation each, by column. Where the moduli go with a bar's density, what its deviation is to
/// them is left out.
[[nodiscard]] Eigen::MatrixXd moduli_directions(const Bench& bench, const BarPrior& bars);

/// Those of an output bar's own material; whose moduli go with that bar's density, where they are
/// from waves and it may be off.
[[nodiscard]] Eigen::MatrixXd own_moduli_directions(const Bar& bar);
[[nodiscard]] bool own_moduli_go_with_density(const Bar& bar);

/// How a material's parameters move, relative, per relative move of a density that they go with:
/// all moduli and viscosities by as much, which leaves waves as fast as they were.
[[nodiscard]] Eigen::VectorXd moves_with_density(const Material& material);
/// The same per relative loss of stiffness to temperature: springs alone.
[[nodiscard]] Eigen::VectorXd moves_with_temperature(const Material& material);

/// Moves each parameter, relative.
void move_parameters(Material& material, const Eigen::VectorXd& relative);

}  // namespace kolsky
