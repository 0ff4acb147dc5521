#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "processing/base/material.hpp"

namespace kolsky {

/// @throws InputError: file, key and mend
[[nodiscard]] Material read_material(const std::filesystem::path& path);
[[nodiscard]] Material parse_material(const std::string& text, const std::string& name);

/// TOML with as many digits as it takes for the same bits to be read back.
[[nodiscard]] std::string format_material(const Material& material);

/// What an identification files beside the values.
struct Identified {
  std::array<double, 9> covariance{};  ///< of E1, E2, eta2, row by row
  std::size_t shots = 0;
  double band_limit_Hz = 0.0;  ///< up to which the records were used
  std::string dispersion;      ///< how waves were taken to travel
  double chi2_reduced = 0.0;
  std::optional<double> temperature_K{};
};

/// The same with `covariance` and the table `[identified]` below.
[[nodiscard]] std::string format_material(const Material& material, const Identified& identified);

}  // namespace kolsky
