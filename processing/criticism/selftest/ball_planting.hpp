#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

/// Puts effects of known size into measured impacts, in raw codes, as Planter does for bars.
///
/// What an effect does is the difference between the fitted model with it and without, calculated
/// on a mesh that no fit stands on (2048 elements). The rebound changes with it: a filed speed by
/// its ratio, and what photo-sensors recorded after the touch by passing that much sooner or later.
class BallPlanter {
 public:
  /// @param shots    as measured, those of study.campaign()
  /// @param studied  of this study: what the effects are added to
  BallPlanter(const std::vector<Shot>& shots, ImpactStudy& study, const Studied& studied);

  /// Why an effect cannot be planted; empty where it can.
  [[nodiscard]] std::string impossible_because(const EffectUse& use) const;

  /// @throws InputError where the ball with the effect is refused by the solver
  [[nodiscard]] std::vector<Shot> planted(const EffectUse& use, std::size_t worker) const;

  /// Impacts as the fitted model has them on that other mesh, noise, speeds and filed numbers drawn
  /// anew: the noise as it was before the pulses, speeds within what is filed of them.
  [[nodiscard]] std::vector<Shot> drawn_anew(std::uint64_t seed, std::size_t worker) const;

 private:
  const std::vector<Shot>& shots_;
  ImpactStudy& study_;
  const Studied& studied_;
  std::vector<double> arrival_s_;  ///< by shot
};

}  // namespace kolsky
