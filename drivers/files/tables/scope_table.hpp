#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/tables/table_units.hpp"

namespace kolsky {

/// One channel of a table.
struct TableColumn {
  std::string header;              ///< as written; the file's stem where the form has no names
  std::string name;                ///< without the unit
  std::optional<ColumnUnit> unit;  ///< where the table states it
  std::vector<double> values;      ///< as written, finite
};

/// What a scope wrote: one time axis and its channels.
struct ScopeTable {
  std::string file;            ///< for messages
  std::string stem;            ///< the file's name without folder and extension
  std::string sha256;          ///< of the file's bytes, hexadecimal
  std::size_t first_line = 0;  ///< of the first sample
  std::vector<double> time_s;  ///< finite, as long as every column
  std::vector<TableColumn> columns;

  /// "file:line" of a sample.
  [[nodiscard]] std::string place(std::size_t sample) const;
};

/// Reads one file. Its form is found from what it holds:
/// - a header row with time first (`time_s,g1`, `Time/s,...`, `TIME,CH1`), after a preamble or not,
/// with a
///   row of units behind it or not;
/// - header fields in the first three columns with time and volts beside them (Tektronix);
/// - metadata in the first columns and waveforms beside them that begin with t0 and dt.
/// @throws InputError: file, line, column and mend
[[nodiscard]] ScopeTable read_scope_table(const std::filesystem::path& path);

/// The same from bytes; `name` stands for the file.
[[nodiscard]] ScopeTable parse_scope_table(std::string_view bytes, const std::string& name);

}  // namespace kolsky
