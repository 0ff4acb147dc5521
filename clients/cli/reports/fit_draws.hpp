#pragma once

#include <optional>
#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/slow_work.hpp"
#include "processing/uncertainty/fit_draws.hpp"

namespace kolsky::cli {

/// What `--draws` adds to an identification's JSON; null where nobody asked.
[[nodiscard]] JsonValue describe(const std::optional<FitDraws>& draws);

/// The same for people; nothing where nobody asked.
[[nodiscard]] std::string report(const std::optional<FitDraws>& draws);

/// So many draws, told of as they are done. @param progress  outlives what is returned
[[nodiscard]] FitDrawOptions draw_options(std::uint64_t draws, SlowWork& progress);

inline constexpr const char* kDrawsHelp =
    "also propagate noise and every <key>_sd through the fit itself, by so many draws: intervals";

}  // namespace kolsky::cli
