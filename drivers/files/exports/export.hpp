#pragma once

#include <filesystem>
#include <string>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

enum class ExportFormat { csv, mat, hdf5 };

/// Writes a shot's gauge records and, where there is one, its reduction for other tools. CSV: two
/// files,
/// `<path>` (histories) and `<stem>-gauges.csv`, unit in every column's name. MAT: version 5, one
/// variable per column. HDF5: NXdata groups.
/// @throws InputError if a file exists
void export_shot(const Shot& shot, const Reduction& reduction, ExportFormat format,
                 const std::filesystem::path& path);

}  // namespace kolsky
