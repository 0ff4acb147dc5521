#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "processing/specimen/specimen_fit.hpp"
#include "processing/specimen/specimen_spectrum.hpp"
#include "processing/uncertainty/fit_draws.hpp"

namespace kolsky::cli {

/// What `identify specimen` found, of which shots and with which bars.
struct IdentifiedSpecimen {
  std::vector<Shot> shots;
  std::optional<BarModelFile> bars;
  SpecimenFit fit;
  std::optional<SpectralEstimate> spectral;
  std::string spectral_refused;  ///< why there is none
  std::optional<FitDraws> draws;
};

/// What `identify specimen --json` prints.
[[nodiscard]] JsonValue describe(const IdentifiedSpecimen& outcome);

/// The same for people.
[[nodiscard]] std::string report(const IdentifiedSpecimen& outcome);

/// What the bars were taken to be.
[[nodiscard]] std::string bars_in_words(const IdentifiedSpecimen& outcome);

}  // namespace kolsky::cli
