#pragma once

#include <filesystem>
#include <string>

#include "processing/base/material.hpp"

namespace kolsky {

/// @throws InputError: file, key and mend
[[nodiscard]] Material read_material(const std::filesystem::path& path);
[[nodiscard]] Material parse_material(const std::string& text, const std::string& name);

/// TOML with as many digits as it takes for the same bits to be read back.
[[nodiscard]] std::string format_material(const Material& material);

}  // namespace kolsky
