#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/search/product_test.hpp"

namespace kolsky {

/// Degrees of freedom from which on noise counts as known exactly: Student's t is normal there.
inline constexpr double kKnownWell = 1e4;

/// ln of the chance that slow noise does as much as an addition of each shot's own.
struct SlowChance {
  double alone = 0.0;
  double with_others = 0.0;  ///< where the same at other gauges is there, too

  [[nodiscard]] double least() const { return std::min(alone, with_others); }
};

/// A candidate refitted in full beside the model.
struct Refit {
  std::size_t candidate = 0;
  Studied studied;
  double freedom = 1.0;
  Signs signs = Signs::both;        ///< of its strength
  double chi2_in_base_noise = 0.0;  ///< its residuals whitened as those without the candidate
  double scatter = 1.0;             ///< how much more than noise the shots differ in its direction
  /// That strengths which every shot and gauge has of its own are products all the same.
  std::optional<ProductTest> products = std::nullopt;
  /// Where that is what confirms them.
  std::optional<SlowChance> slow = std::nullopt;
  double noise = 1.0;       ///< what the objective has of it per residual: of all refits the best's
  double over_noise = 0.0;  ///< gain of the objective, over the noise
  double beside = 1.0;      ///< share of it beside something slow that nothing confirms
  double gain = 0.0;        ///< the same over the shots' scatter, too
  double evidence = 0.0;    ///< as a square of a normal deviate, the search not counted
  double doubt = 1.0;       ///< the scatter, where the evidence is that over the noise alone
  double known = kKnownWell;  ///< degrees of freedom by which the noise is known that weighs it
  double log_p = 0.0;
  /// ln of the chance of a rival's gain: by how much its shots scatter it is no less of one.
  double rival_log_p = 0.0;
  /// What the fit makes of the pulses, whitened, where that is all it carries and it was asked for.
  Eigen::VectorXd pulses{};
  /// With derivatives of the model without the candidate: cheap, and near enough for what is far
  /// behind.
  bool rough = false;
};

/// By how much one refit stands before another, as a square of a normal deviate. Noise that is
/// greater in the direction of either than its spectrum says makes the difference weigh less, and
/// so do noise that is known roughly and what is not of the pulses.
[[nodiscard]] double lead(const Refit& ahead, const Refit& behind);

}  // namespace kolsky
