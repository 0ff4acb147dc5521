#pragma once

#include <vector>

#include "processing/criticism/fitting/residuals.hpp"
#include "processing/models/effect.hpp"

namespace kolsky {

/// A gain and a clock that wander while a record is taken, each in proportion to the time since the
/// pulse and to its square: what no filter does. Like the other distortions (distortion.hpp) it
/// fits nearly anything and names nothing.
class Wander final : public Effect {
 public:
  /// @param residuals  whose records it distorts, frozen, so that their noise is known: noise that
  ///   was distorted too would find itself again
  explicit Wander(WhiteResiduals& residuals);

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override;

 private:
  std::vector<std::vector<std::vector<double>>> signal_;  ///< by shot and gauge
  double period_s_;
};

}  // namespace kolsky
