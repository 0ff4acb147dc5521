#pragma once

#include <string>
#include <vector>

#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// How near another effect's signature comes.
struct Resemblance {
  std::string effect;
  double cosine = 0.0;  ///< 1: the data cannot tell them apart to first order
};

/// What a campaign can say of an effect, to first order.
struct Distinction {
  std::string effect;
  std::string parameter;
  std::string unit;
  double absorbed_share = 0.0;  ///< of its signature: what the model's own numbers take up
  double detectable = 0.0;    ///< strength that stands at 6 sigma here; infinite: none that may be
  double identifiable = 0.0;  ///< and still at 5 beside its nearest rival; infinite: none
  std::vector<Resemblance> rivals;  ///< nearest first
};

/// How far some effects can be told from all others on this campaign: the cosines between their
/// whitened signatures, clear of what the fitted model's numbers take up. Of an effect's variants
/// (starts of its auxiliary parameters) the one that the data show best stands for it, and of a
/// rival's the one that comes nearest.
/// @param studied  a fit that holds none of them
/// @param ids      library ids and those of the model's expressions, without gauges
[[nodiscard]] std::vector<Distinction> distinctions(Study& study, const Studied& studied,
                                                    const std::vector<std::string>& ids);

}  // namespace kolsky
