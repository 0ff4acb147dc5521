#pragma once

#include <optional>
#include <string>

#include "processing/models/model.hpp"

namespace kolsky {

/// Where a strength is not what its effect's formula makes it with the sizes filed, beyond three
/// deviations and a tenth. Something else may do the same.
[[nodiscard]] std::optional<std::string> unlike_formula_text(const EffectUse& fitted);

/// Whether records tell no strength and no time of a relaxation apart, only what both do together:
/// the beginning of something slow.
[[nodiscard]] bool only_begins(const EffectUse& fitted);
/// Where it only begins.
[[nodiscard]] std::optional<std::string> only_begins_text(const EffectUse& fitted);

}  // namespace kolsky
