#pragma once

#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "clients/report/cascade_svg.hpp"
#include "clients/report/html.hpp"
#include "clients/terminal/terminal.hpp"
#include "processing/criticism/waterfall/waterfall.hpp"

namespace kolsky::cli {

/// What `kolsky model waterfall --json` prints: `steps` with effect, held_out, gain, misfit,
/// parameters and curve; `floor`, `repeats`, `signal`, `closed`.
[[nodiscard]] JsonValue describe(const Waterfall& fall);

/// The picture for a terminal: bars on a logarithmic scale, then how the numbers moved.
[[nodiscard]] std::string waterfall_text(const Waterfall& fall, const Terminal& terminal);

[[nodiscard]] Cascade cascade_of(const Waterfall& fall, const std::string& title);

/// One file with the picture, the numbers and, beside a specimen, its stress-strain curve at every
/// step.
[[nodiscard]] Page waterfall_page(const Waterfall& fall, const std::string& title,
                                  const std::vector<std::string>& notes);

}  // namespace kolsky::cli
