#pragma once

#include <string>
#include <vector>

#include "processing/criticism/comparing/comparison.hpp"

namespace kolsky {

/// What a model leaves of shots that were about equally strong.
struct ShotGroup {
  double low = 0.0;
  double high = 0.0;
  std::vector<std::size_t> shots;
  double energy = 0.0;  ///< of all their tiles, whitened
  TileNoise noise;      ///< what of it noise alone would leave
  double share = 0.0;   ///< of the whole misfit's excess over noise

  [[nodiscard]] double sigma() const;
  [[nodiscard]] double log_p() const { return noise.log_tail(energy); }
};

/// A misfit by the strength of the shots: what depends on amplitude or rate grows along it.
struct ShotGroups {
  std::string by;                 ///< "peak strain", or of split bars "strain rate"
  std::string unit;               ///< "strain" or "1/s"
  std::vector<ShotGroup> groups;  ///< weakest first; empty where the shots do not differ
};

/// Half of the rate at which an incident wave of this peak would strain a specimen without any
/// resistance; 0 where there is no specimen.
[[nodiscard]] double usual_strain_rate_per_s(double peak_strain, const Model& model,
                                             const Bench& bench);

/// Shots within a quarter of the weakest one are one group. @param model  as compared
[[nodiscard]] ShotGroups by_strength(const Comparison& comparison, const Model& model,
                                     const Campaign& campaign);

}  // namespace kolsky
