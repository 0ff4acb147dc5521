#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// A column of a table for other tools, its unit at the end of its name ("stress_Pa", "g1_V").
struct ExportColumn {
  std::string name;
  std::string unit;
  std::string meaning;
  std::vector<double> values;
};

/// Time first.
using ExportTable = std::vector<ExportColumn>;

/// The specimen's histories, the true ones last where they were asked for; columns without rows
/// where the shot could not be reduced.
[[nodiscard]] ExportTable history_table(const Reduction& reduction);

/// The gauges' records over time from the trigger, or from the first sample.
[[nodiscard]] ExportTable gauge_table(const Shot& shot);

[[nodiscard]] std::string verdict_name(Verdict verdict);

void export_csv(const Shot& shot, const Reduction& reduction, const std::filesystem::path& path);
void export_mat(const Shot& shot, const Reduction& reduction, const std::filesystem::path& path);
void export_hdf5(const Shot& shot, const Reduction& reduction, const std::filesystem::path& path);

}  // namespace kolsky
