#pragma once

#include <filesystem>
#include <string>

namespace kolsky::cli {

/// Writes a text as a new file. @throws InputError if it exists or cannot be written; then nothing
/// is left
void write_new_file(const std::filesystem::path& path, const std::string& text);

}  // namespace kolsky::cli
