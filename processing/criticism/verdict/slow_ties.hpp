#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

// Hums and drifts are slopes in records that are a fraction of the mains' period.

/// In a record shorter than a period a hum of one phase in all shots is a slope at every gauge,
/// and drifts at several of them are as much. A source that is free takes up one of them, so that
/// each by itself may hardly show, and one after the other they are not found.
/// @param current  with what the diagnosis claims; a hum among it has drifts added to its ties
void tie_with_drifts(Study& study, const Studied& current, Diagnosis& diagnosis);

/// A drift of each shot's own is a hum of another phase in every shot, picked up by one gauge or
/// by several in unequal shares of which the source takes up the rest: where a hum at that gauge
/// does as well, or other gauges slope before the pulses, too, nothing tells the two apart. One
/// that all shots have alike is a hum of one phase, where another gauge drifts beside it, or
/// records do not tell which of them drifts.
/// @param current  with what the diagnosis claims; drifts among it have the hum added to their ties
void tie_with_hum(Study& study, const Studied& current, Diagnosis& diagnosis);

/// A hum that all gauges seem to have alike leaves the rest of what they pick up in unequal shares,
/// which is a slope at one of them: a drift beside it is no claim of its own where shares do as
/// well.
struct HumInShares {
  Studied studied;                  ///< with each gauge's own hum and without the drifts
  std::vector<std::string> drifts;  ///< that it needs no more
};
/// @param current  with what the diagnosis claims
/// @return nothing where no drift is claimed beside such a hum, or what is claimed is likelier
[[nodiscard]] std::optional<HumInShares> hum_in_shares(Study& study, const Studied& current,
                                                       const std::vector<std::string>& effects);

}  // namespace kolsky
