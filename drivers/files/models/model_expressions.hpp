#pragma once

#include <memory>
#include <string>

#include "drivers/files/settings/toml_table.hpp"
#include "processing/models/model.hpp"

namespace kolsky {

/// One [[expressions]] of a model file. @param model  of the kind it is for, with the expressions
/// before it
/// @throws InputError: file, line, key and mend, the column of a formula too
[[nodiscard]] std::shared_ptr<const ExpressionEffect> read_expression(const TomlTable& table,
                                                                      const Model& model);

/// @throws InputError at the expression's formula where it is not fit to be part of the model (see
/// admission_problem)
void require_admissible(const TomlTable& table, const ExpressionEffect& effect, const Model& model);

/// TOML that reads back as the same bits.
[[nodiscard]] std::string format_expression(const ExpressionText& text);

}  // namespace kolsky
