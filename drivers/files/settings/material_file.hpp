#pragma once

#include <filesystem>
#include <string>

#include "processing/base/material.hpp"

namespace kolsky {

class TomlTable;

/// @throws InputError: file, key and mend
[[nodiscard]] Material read_material(const std::filesystem::path& path);
/// Of a table of another file.
[[nodiscard]] Material read_material(const TomlTable& table);
[[nodiscard]] Material parse_material(const std::string& text, const std::string& name);

/// TOML with as many digits as it takes for the same bits to be read back. What is said of the
/// identification itself goes by the form below.
[[nodiscard]] std::string format_material(const Material& material);

/// How the values were identified.
struct Identified {
  std::size_t shots = 0;
  std::string dispersion;  ///< how waves were taken to travel
  double chi2_reduced = 0.0;
  bool passive = true;  ///< false: waves grew on their way, and no bar model may be made of it
  /// What clearly explains the records better than this solid and what this one costs, for people;
  /// empty where nothing does.
  std::string better_solid{};
};

/// The same with these in the table `[identified]`.
[[nodiscard]] std::string format_material(const Material& material, const Identified& identified);

}  // namespace kolsky
