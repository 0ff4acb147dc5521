#pragma once

#include <vector>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// Least-squares slope over time of what came before a shot's pulse, 1/s. 0 of less than two
/// samples.
[[nodiscard]] double slope_before(const CampaignShot& shot, const std::vector<double>& record);

using SlopesByShot = std::vector<std::vector<double>>;  ///< by shot and gauge, 1/s

/// Variances of slopes before the pulses by each gauge's own noise, as its quiet samples about
/// their slopes have it, 1/s^2. What wanders too slowly to show there is not in them.
[[nodiscard]] SlopesByShot variances_of_slopes(const Campaign& campaign);

/// ln of the chance that noise slopes as much before the pulses as the gauges do together. What is
/// alike at all gauges of a shot adds to their mean slope alone, whatever phase it has there; noise
/// of a gauge's own adds as much to the differences between gauges. An F test of N shots' means
/// against those N (G - 1) differences and what the samples' spectrum says of a slope, which counts
/// the less the slower the noise is. Noise that gauges share is allowed for as far as the samples
/// about their slopes are correlated,
/// and as far as a walk at random would slope of which they show so much.
/// @param less  slopes that are taken off those before the pulses; empty: none
/// @return 0 with one gauge, or where a shot has fewer than sixteen samples before its pulse
[[nodiscard]] double log_chance_of_common_slopes(const Campaign& campaign,
                                                 const SlopesByShot& less = {});

/// Whether the quiet samples of all gauges turn together, slowly, about their slopes: not by chance
/// alone, and as no hum does in a fraction of its period.
[[nodiscard]] bool wanders_in_common(const Campaign& campaign);

/// ln of the chance that a gauge's own noise, as its quiet samples about their slopes have it,
/// slopes as much before the pulses. @return by gauge; 0 as above
[[nodiscard]] std::vector<double> log_chances_of_slopes(const Campaign& campaign);

}  // namespace kolsky
