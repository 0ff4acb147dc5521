#pragma once

#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "processing/criticism/fitting/misfit.hpp"

namespace kolsky::cli {

/// Not where nothing was fitted: then none of its numbers means anything.
[[nodiscard]] bool was_reckoned(const Misfit& misfit);
/// Numbers are null where nothing was fitted.
[[nodiscard]] JsonValue describe(const Misfit& misfit);
[[nodiscard]] std::string misfit_text(const Misfit& misfit);
/// ", judged up to 12 kHz", or nothing where no frequency is left out.
[[nodiscard]] std::string judged_text(const Misfit& misfit);

}  // namespace kolsky::cli
