#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kolsky::cli {

// Before long work: whether its result may be put where it is asked for.

/// @throws InputError where the name is taken or the folder cannot be written
void require_new_output(const std::optional<std::string>& path);
/// @throws InputError where the file cannot be written or is there and no model that can be read
void require_model_output(const std::optional<std::string>& path);
/// @throws InputError where the file cannot be written or is there and no page
void require_page_output(const std::optional<std::string>& path);
/// @throws InputError where the file cannot be written or is there and no picture
void require_picture_output(const std::optional<std::string>& path);

/// Writes a file that is not there yet, readable by all. @throws InputError as NewFile does
void write_output(const std::filesystem::path& path, const std::string& text);

}  // namespace kolsky::cli
