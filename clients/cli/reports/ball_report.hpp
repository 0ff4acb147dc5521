#pragma once

#include <string>
#include <vector>

#include "clients/cli/reports/reduced_shot.hpp"
#include "processing/reduction/ball/ball_repeats.hpp"

namespace kolsky::cli {

/// The impact of a shot, without anything in it where it could not be reduced.
[[nodiscard]] BallImpact ball_of(const ReducedShot& reduced);

/// What `reduce --json` and `get --json` print for a shot of a ball on a bar.
[[nodiscard]] JsonValue describe_ball(const ReducedShot& reduced);
/// The same for people, with the force drawn.
[[nodiscard]] std::string ball_report(const ReducedShot& reduced, const Terminal& terminal);

/// {"value", "sd"}, or null where it is not known.
[[nodiscard]] JsonValue describe(const std::optional<Measured>& number);
/// {"mean", "sd", "count"}.
[[nodiscard]] JsonValue describe(const Repeated& number);

/// Several impacts: each, and the repeats at each speed.
[[nodiscard]] JsonValue describe_balls(const std::vector<ReducedShot>& shots);
[[nodiscard]] std::string balls_report(const std::vector<ReducedShot>& shots,
                                       const Terminal& terminal);

}  // namespace kolsky::cli
