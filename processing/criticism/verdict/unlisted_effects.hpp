#pragma once

#include "processing/models/effect.hpp"

namespace kolsky {

/// reading x (1 + c / (1 + s tau)) of one gauge: a bond that creeps, an amplifier that droops.
[[nodiscard]] const Effect& creeping_gauge();
/// reading = e (1 + c e^2) of one gauge or of all: amplifiers that run out of range.
[[nodiscard]] const Effect& curved_gauge();
[[nodiscard]] const Effect& curved_readings();
/// reading x (1 + c) of one gauge from a time after the pulse's foot on: a bond that comes loose, a
/// plug, a range that is switched.
[[nodiscard]] const Effect& changing_gauge();

}  // namespace kolsky
