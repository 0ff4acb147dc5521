#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Writes a shot once: temporary file in the same folder, fsync, rename, fsync of the folder,
/// read-only. NeXus: NXentry with an NXdata of the gauges over time, so that h5web, silx and nexpy
/// plot it; raw codes with their SHA-256 beside it. See docs/capture-format.md.
/// @throws InputError if the file exists (nothing stored is overwritten) or cannot be written
void write_capture(const Shot& shot, const std::filesystem::path& path);

/// Reads it back and checks every SHA-256. @throws InputError: file, object and mend
[[nodiscard]] Shot read_capture(const std::filesystem::path& path);

/// The captures in a folder (*.h5), by name; or the one file.
/// @throws InputError where there is none
[[nodiscard]] std::vector<std::filesystem::path> captures_in(const std::filesystem::path& path);

}  // namespace kolsky
