#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "processing/base/shot.hpp"
#include "processing/models/model.hpp"

namespace kolsky::cli {

/// Captures named on the command line (files or folders), read. @throws InputError
[[nodiscard]] std::vector<Shot> read_shots(const std::vector<std::string>& captures);

/// How many captures the command line names.
[[nodiscard]] std::size_t count_of(const std::vector<std::string>& captures);

/// SHA-256 over the captures' own digests, in the order given.
[[nodiscard]] std::string digest_of(const std::vector<std::string>& captures);

/// What --band-limit asks for; 0, what the noise allows, where it was not given.
/// @throws InputError where it is not above 0
[[nodiscard]] double band_limit_of(std::optional<double> asked_Hz);

/// "2026-11-21T14:00:00Z"
[[nodiscard]] std::string utc_now();

/// A model's effects as `--json` gives them: id, stage, parameters with value, sd, unit, free.
[[nodiscard]] JsonValue describe_effects(const Model& model);

/// The fitted numbers by name: moduli as in a material file (a bar's beside a specimen as
/// "bar.E1_Pa"), effects' as "geometric-dispersion.s".
[[nodiscard]] JsonValue describe_parameters(const Model& model);

/// A table of a model's effects for people.
[[nodiscard]] std::string model_table(const Model& model);

/// Filed numbers that a fit holds more than three of their deviations off: {"name", "deviations"}
/// each. Either they are not as filed, or they stand in for what the model lacks.
[[nodiscard]] JsonValue describe_strained(const Model& model);

/// The same in a line for people; empty where there are none.
[[nodiscard]] std::string strained_text(const Model& model);

[[nodiscard]] BenchKind bench_kind(const std::string& name);
[[nodiscard]] std::string name_of(BenchKind kind);

}  // namespace kolsky::cli
