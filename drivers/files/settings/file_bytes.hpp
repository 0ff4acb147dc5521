#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace kolsky {

/// The whole of a regular file, as it is on disk.
/// @param most_bytes  larger files are refused
/// @throws InputError: the file and why it cannot be read
[[nodiscard]] std::string read_file_bytes(const std::filesystem::path& path,
                                          std::size_t most_bytes);

}  // namespace kolsky
