#pragma once

#include <string>

#include "clients/figure/figure.hpp"
#include "processing/reduction/recorded_waves.hpp"

namespace kolsky {

/// Right- and left-going strain at one place over the record's time, as far as it is known.
[[nodiscard]] Panel waves_panel(const RecordedWaves& waves, const WavesAtPlace& place,
                                double period_s);

/// The waves of all places, and the stress and velocity there, on one page.
[[nodiscard]] Figure recorded_waves_figure(const RecordedWaves& waves, double period_s,
                                           const std::string& title);

}  // namespace kolsky
