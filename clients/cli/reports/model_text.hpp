#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "processing/base/shot.hpp"
#include "processing/models/model.hpp"

namespace kolsky::cli {

/// A model's effects as `--json` gives them: id, stage, parameters with value, sd, unit, free.
[[nodiscard]] JsonValue describe_effects(const Model& model);

/// The fitted numbers by name: moduli as in a material file (a bar's beside a specimen as
/// "bar.E1_Pa"), effects' as "geometric-dispersion.s".
[[nodiscard]] JsonValue describe_parameters(const Model& model);

/// A number for people, in a unit near its size, to its deviation's second digit; without one
/// (sd 0) to four digits.
[[nodiscard]] std::string number_text(double value, double sd, const std::string& unit);

/// "1 effect", "2 effects".
[[nodiscard]] std::string counted(std::size_t count, const std::string& of);

/// One effect for people: id, stage, definition, its numbers.
[[nodiscard]] std::string effect_text(const EffectUse& use);
/// All of a model's effects.
[[nodiscard]] std::string model_table(const Model& model);

/// An expression that two models do not declare alike.
struct Declared {
  std::string id;
  std::string before;  ///< its formula; empty where it is not declared
  std::string after;

  /// For people, a line.
  [[nodiscard]] std::string text() const;
};

[[nodiscard]] std::vector<Declared> declared_anew(const Model& before, const Model& after);

/// Filed numbers that a fit holds more than three of their deviations off: {"name", "deviations"}
/// each. Either they are not as filed, or they stand in for what the model lacks.
[[nodiscard]] JsonValue describe_strained(const Model& model);

/// Whether there are any.
[[nodiscard]] bool is_strained(const Model& model);

/// The same for people, one after the other; empty where there are none.
[[nodiscard]] std::string strained_list(const Model& model);
/// With what it means, in lines of their own.
[[nodiscard]] std::string strained_text(const Model& model);

/// Numbers that a fit moved to the end of what they may be.
[[nodiscard]] JsonValue describe_bounds(const Model& model);
[[nodiscard]] std::string bounds_text(const Model& model);

[[nodiscard]] BenchKind bench_kind(const std::string& name);

}  // namespace kolsky::cli
