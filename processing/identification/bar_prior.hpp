#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/models/softening.hpp"

namespace kolsky {

/// What the viscoelastic bars are made of, with what is not known of it.
struct BarPrior {
  Material material;
  /// Of E1_Pa, E2_Pa, eta2_Pa_s, in their units.
  std::array<std::array<double, 3>, 3> covariance{};
  /// Identified from waves, which show the moduli over the density alone: the deviation of the
  /// material's density is part of the covariance, as the moduli are off by what it is off by.
  bool from_waves = false;
  /// Relative loss of E1 and E2 by which a deviation of the bench's temperature counts.
  double softening_per_K = kSofteningPerK;

  /// With the material's covariance; without one its own deviations, as if they were independent.
  explicit BarPrior(const Material& m);
};

/// By what E1 and E2 may be off, relative, because the temperature at which the shots were fired is
/// known to a deviation only; 0 where none is filed or no bar is viscoelastic.
[[nodiscard]] double sd_by_temperature(const Bench& bench, const BarPrior& bars);

/// The bar, 0 input or 1 output, with whose density the moduli go: the first viscoelastic one,
/// where they are from waves and its density may be off.
[[nodiscard]] std::optional<std::size_t> bar_of_density(const Bench& bench, const BarPrior& bars);

/// Three independent directions in which E1, E2 and eta2 may be off together, relative, one
/// deviation each, by column. Where the moduli go with a bar's density, what its deviation is to
/// them is left out.
[[nodiscard]] Eigen::Matrix3d moduli_directions(const Bench& bench, const BarPrior& bars);

}  // namespace kolsky
