#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace kolsky::testing {

/// The project's folder.
inline const std::filesystem::path kProject = KOLSKY_SOURCE_DIR;

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A page or source of the project. @param path  from its folder
inline std::string page(const std::filesystem::path& path) {
  return content(kProject / path);
}

}  // namespace kolsky::testing
