#pragma once

#include "drivers/simulated/scenario.hpp"
#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

/// The converter's settings that follow from a scenario: channels with their factors, resolution,
/// rates, name and seed. Pacing, shots and faults are left as they are by default.
[[nodiscard]] AdcSettings adc_settings(const Scenario& scenario);

}  // namespace kolsky
