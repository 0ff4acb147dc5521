#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Meta of a record whose table has more columns than the bench gauges: which were left out.
inline constexpr const char* kIgnoredColumns = "ignored_columns";
/// Meta of a record no column of which is called like a gauge: those that were taken in the order
/// in which they come.
inline constexpr const char* kColumnsInOrder = "columns_in_order";
/// Meta of a record whose table was not even in time: how far, in samples.
inline constexpr const char* kInterpolatedFrom = "interpolated_from_samples_off";

/// What `kolsky import csv` takes.
struct TableImport {
  std::vector<std::filesystem::path> tables;  ///< one with all gauges, or one per gauge
  std::filesystem::path bench;
  std::map<std::string, std::string> meta;
  std::optional<std::int64_t> utc_ns;  ///< of the import; now if not given
};

/// Reads tables into a shot: `time_s,<gauge>,...` and what PicoScope, Tektronix and other scopes
/// write (preambles, unit rows, ; or tab between columns, decimal commas, columns of header fields
/// beside the data, waveforms with t0 and dt in their first rows). The time column gives the rate.
///
/// Columns go to gauges by name (without regard to case or a unit behind the name) where any is
/// called like a gauge, and then every gauge needs one and other columns are left out; else by
/// order, and then the counts must be equal. A column without a unit is in its gauge's. Several
/// tables must agree in their time axis.
///
/// The shot's rate is the bench's. Where the time column has a rate of its own, so that samples
/// come to lie more than 5 % of a step off the bench's, values are interpolated to even times and
/// meta gains `interpolated_from_samples_off` (the farthest). Meta gains `measured_rate_Hz`,
/// `first_sample_s` (time of sample 0), `source_file`, `source_sha256` (per file, in order) and, if
/// any, `ignored_columns`, and `columns_in_order` where no name tells which is which. Values are
/// kept as 32-bit codes with a power of two as scale, so that rounding stays below 5e-10 of the
/// full scale; where the column is in other units (mV, microstrain) its header says so and it is
/// converted.
/// @throws InputError: file, line and column, mend. The rate 1 % off the bench's and a step 5 % off
/// are
///   refused.
[[nodiscard]] Shot import_tables(const TableImport& request);

}  // namespace kolsky
