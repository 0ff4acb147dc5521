#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processing/criticism/impact/impact_study.hpp"
#include "tests/generators/impact_campaign.hpp"
#include "tests/unit/impact/fine_meshes.hpp"

namespace kolsky::testing {

/// Two speeds: what grows with the speed shows between them. score_impacts has the long form.
inline ImpactWishes two_speeds(std::uint64_t seed, std::size_t shots) {
  ImpactWishes own;
  own.seed = seed;
  own.speeds_m_per_s = {31.1, 51.0};
  own.shots = shots;
  return own;
}

inline Model paper_with(const std::vector<std::string>& effects) {
  Model model = paper_model(BenchKind::impact, true);
  for (const std::string& id : effects) {
    model.effects.push_back(use_named(id));
  }
  return model;
}

/// The paper's ball, its materials filed as a Hopkinson bar leaves them: free within 1.5 %.
inline Model filed_ball() {
  Model model = paper_with({});
  for (const char* id : {"three-element-core", "three-element-cover"}) {
    for (std::size_t p = 0; p < 3; ++p) {
      ModelValue& own = model.find(id)->values[p];
      own.free = true;
      own.prior_mean = own.value;
      own.prior_sd = 0.015 * own.value;
    }
  }
  return model;
}

/// Meshes that say as much of balls by another code as its own mesh lets them, for a fifth of what
/// the usual ones cost; with KOLSKY_FINE_MESHES in the environment the usual ones.
inline BallMeshes light_meshes() {
  return fine_meshes() ? BallMeshes{} : BallMeshes{240, 2048, 2048};
}

/// Shots under study.
struct ThrownBalls {
  explicit ThrownBalls(const std::vector<Shot>& shots, const BallMeshes& meshes = light_meshes())
      : campaign(read_campaign(shots)),
        study(campaign, JudgedStretch::to_reflection, 0.0, Workers{}, meshes) {}

  Campaign campaign;
  ImpactStudy study;
};

}  // namespace kolsky::testing
