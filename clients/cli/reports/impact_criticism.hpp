#pragma once

#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "clients/report/html.hpp"
#include "clients/terminal/terminal.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/impact/impact_diagnosis.hpp"
#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky::cli {

/// @throws InputError where the captures are of another kind of bench than the model
void require_kind(const Model& model, const Campaign& campaign);

/// What `act` returns; what is refused of the model (it lacks waves, its ball bursts) is told with
/// its file.
template <typename Act>
auto naming_model(const std::string& file, const Act& act) {
  try {
    return act();
  } catch (const InputError& error) {
    throw error.inside(file);
  }
}

/// Members `where` (significant tiles, largest share first) and `speeds` of what `kolsky compare
/// --json` prints of impacts.
[[nodiscard]] JsonValue describe_tiles(const ImpactComparison& comparison,
                                       const Campaign& campaign);
[[nodiscard]] JsonValue describe_speeds(const ImpactComparison& comparison);

/// A misfit's shares of the signal's energy in a sentence, and what bounds what repeats.
[[nodiscard]] std::string impact_words(const ImpactStudy& study, const Studied& studied);

/// Speed by speed: misfit, peak forces, restitution.
[[nodiscard]] std::string speeds_table(const ImpactComparison& comparison);
/// The places that fail most.
[[nodiscard]] std::string places_table(const ImpactComparison& comparison,
                                       const Campaign& campaign);
/// Force, measured and foretold, at the speed that fails most.
[[nodiscard]] std::string worst_plot(const ImpactComparison& comparison,
                                     const std::vector<double>& times_s, const Terminal& terminal);

/// What `kolsky compare --report` writes of impacts.
[[nodiscard]] Page impact_page(const std::string& title, const std::vector<std::string>& notes,
                               const ImpactComparison& comparison, ImpactStudy& study,
                               const Studied& studied);
/// What `kolsky diagnose --report` writes of impacts.
/// @param times_s  of the judged samples, ImpactResiduals::times_s()
[[nodiscard]] Page impact_diagnosis_page(const std::string& title,
                                         const std::vector<double>& times_s, const Model& before,
                                         const Diagnosis& diagnosis, const ImpactsSeen& seen);

}  // namespace kolsky::cli
