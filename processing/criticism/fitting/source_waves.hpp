#pragma once

#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// The waves that a fit says came past the reference gauge: smoothed flat to the sixth order above
/// twice the judged band, with nothing before the foot, a gauge's length taken off. What is sent
/// through a model from here on carries no noise of its own.
struct SourceWaves {
  std::vector<std::vector<double>> by_shot;  ///< strain, at the records' rate
  double period_s = 0.0;
};

[[nodiscard]] SourceWaves source_waves(Study& study, const Studied& studied);

/// What a campaign's gauges read of a wave under a composition: transfers, bridges, additions.
/// @param campaign  its bench and facts; its records are not looked at
/// @param shot      of the campaign
[[nodiscard]] std::vector<std::vector<double>> readings_of(const std::vector<double>& wave,
                                                           const Campaign& campaign,
                                                           const Composition& composition,
                                                           const std::vector<double>& theta,
                                                           std::size_t shot);

}  // namespace kolsky
