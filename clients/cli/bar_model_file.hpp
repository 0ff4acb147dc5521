#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/specimen/shpb_unknowns.hpp"

namespace kolsky::cli {

/// A material file as a bar model.
struct BarModelFile {
  BarPrior prior;
  std::string name;                     ///< of the file, for messages
  std::optional<double> band_limit_Hz;  ///< up to which it was identified
};

/// @throws InputError: file, key and mend
[[nodiscard]] BarModelFile read_bar_model(const std::filesystem::path& path);

/// Refuses a model for bars that it does not hold for (see require_bar_model_holds).
/// @throws InputError
void require_holds(const BarModelFile& model, const Shot& shot);
void require_holds(const BarModelFile& model, const Bench& bench);

/// Refuses a band that reaches beyond the model's. @throws InputError
void require_band(const BarModelFile& model, std::optional<double> asked_Hz);

/// What to say of a model beside its name, one by one: a temperature that cannot be checked, a poor
/// identification.
[[nodiscard]] std::vector<std::string> doubts_of(const Material& model, const Shot& shot);
/// The same in brackets, for behind a name; else nothing.
[[nodiscard]] std::string doubts_in_brackets(const Material& model, const Shot& shot);

}  // namespace kolsky::cli
