#pragma once

#include <string>

#include "processing/criticism/study.hpp"

namespace kolsky {

/// Whether strengths that every shot has of its own are more than slow noise that they followed. No
/// other shot can confirm them, so something else has to:
///   a drift must show in the samples before the pulse, too, with the same slopes;
///   a hum has one phase in a shot, whatever the gauge: its amplitudes by shot and gauge are a
///   product of one number per shot and one per gauge, and the shots' are of one size; one that is
///   alike at all gauges must show before the pulse, too, as a drift must.
/// True for effects without strengths of their own.
[[nodiscard]] bool own_strengths_confirmed(const Studied& studied, const std::string& id,
                                           const Campaign& campaign);

}  // namespace kolsky
