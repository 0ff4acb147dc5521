#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace kolsky {

/// One line of a bench file to be written, replaced or dropped.
struct BenchEdit {
  std::string table;      ///< "bars.input" or "gauges"
  std::size_t index = 0;  ///< which of several tables of that name
  std::string key;
  std::optional<std::string> text;  ///< what stands right of "="; none: the line goes
};

/// The text of a bench file with lines changed and all others, comments too, as they were.
/// @throws InputError where a table is not written under a [header] of its own
[[nodiscard]] std::string edit_bench(const std::string& text, const std::vector<BenchEdit>& edits);

}  // namespace kolsky
