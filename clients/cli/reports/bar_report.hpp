#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "clients/figure/figure.hpp"
#include "processing/identification/bar_identification.hpp"
#include "processing/identification/foretold_shots.hpp"
#include "processing/uncertainty/fit_draws.hpp"

namespace kolsky::cli {

/// What `identify bar --json` prints.
/// @param foretold  waveforms to add; none where nobody asked
/// @param draws     of the three-element parameters; none where nobody asked
[[nodiscard]] JsonValue describe(const BarIdentification& result,
                                 const std::vector<ForetoldShot>& foretold,
                                 const std::optional<FitDraws>& draws);

/// The same for people.
[[nodiscard]] std::string report(const BarIdentification& result,
                                 const std::optional<FitDraws>& draws);

/// J over frequency with the fit through it, alpha and phase velocity, the waveforms of one shot
/// with what the fit foretells and what is left.
[[nodiscard]] Figure bar_figure(const BarIdentification& result, const ForetoldShot& foretold);

}  // namespace kolsky::cli
