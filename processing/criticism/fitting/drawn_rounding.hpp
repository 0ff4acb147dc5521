#pragma once

#include <cstddef>
#include <vector>

#include "processing/criticism/fitting/residuals.hpp"
#include "processing/criticism/noise/converter_steps.hpp"

namespace kolsky {

/// Whether a converter's steps lie in all shots alike against the records.
enum class StepsLie { alike, as_each_shot_has_them };

/// What coarse converters leave of records like those foretold, drawn over where their steps may
/// lie against the records. Saw teeth are where a record creeps, and records that are alike have
/// like teeth: no stationary noise is like that.
class DrawnRounding {
 public:
  static constexpr std::size_t kDraws = 64;

  /// @param residuals  as frozen; outlives this
  DrawnRounding(WhiteResiduals& residuals, StepsLie lie);

  /// Whether any gauge's converter is coarse.
  [[nodiscard]] bool any() const { return !gauges_.empty(); }
  /// What is left of a shot's records, zero on average before the pulse.
  /// @return by gauge, as long as the shot's records
  [[nodiscard]] std::vector<std::vector<double>> records(std::size_t shot, std::size_t draw) const;

 private:
  struct CoarseGauge {
    std::size_t gauge;
    double step;
    RoundingAt rounding;
    std::vector<std::vector<double>> clean;   ///< by shot
    std::vector<std::vector<double>> offset;  ///< by shot and draw
  };

  const Campaign& campaign_;
  std::vector<CoarseGauge> gauges_;
};

}  // namespace kolsky
