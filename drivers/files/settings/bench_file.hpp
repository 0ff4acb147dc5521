#pragma once

#include <filesystem>
#include <string>

#include "processing/base/bench.hpp"

namespace kolsky {

/// A bench and the very text it was read from (which travels with every capture).
struct BenchFile {
  Bench bench;
  std::string text;
};

/// Reads and checks a bench file. Unknown keys are errors that name the nearest known key.
/// @throws InputError: file, key and mend
[[nodiscard]] BenchFile read_bench(const std::filesystem::path& path);

/// The same from a text; `name` stands for the file in messages.
[[nodiscard]] Bench parse_bench(const std::string& text, const std::string& name);

}  // namespace kolsky
