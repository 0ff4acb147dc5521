#pragma once

#include <optional>
#include <string>

#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

inline constexpr const char* kReadingEffect = "three-dimensional-reading";

/// "full", "bulk-E1", "bulk-Einf" or "exact": as a model has it. @return none where it has none
[[nodiscard]] std::optional<std::string> reading_of(const Model& model);

/// Another reading of the uniaxial law in three dimensions, in place of what was found.
struct RivalReading {
  std::string name;
  double behind = 0.0;  ///< its objective less the one with what was found, over `scale`
};

/// Where fine forces were taken (ImpactResiduals::anchor).
struct AnchoredAt {
  Composition composition;
  std::vector<double> theta;
};

/// The best of the other readings beside a model without what was found. All are fitted around the
/// same fine forces as the search itself.
/// @param objective  with what was found, as the search had it
/// @param scale      what a square of a normal deviate counts over
/// @param there      where the search took the forces, @param back  where they are left after that
[[nodiscard]] std::optional<RivalReading> best_rival_reading(ImpactStudy& study, const Model& model,
                                                             double objective, double scale,
                                                             const AnchoredAt* there,
                                                             const AnchoredAt* back);

}  // namespace kolsky
