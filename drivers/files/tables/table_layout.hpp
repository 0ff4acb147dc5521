#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/tables/table_cells.hpp"
#include "drivers/files/tables/table_text.hpp"
#include "drivers/files/tables/table_units.hpp"

namespace kolsky {

/// Where the samples are in a table and what its head says about them.
struct TableLayout {
  struct Column {
    std::size_t cell = 0;
    std::string header;
    std::string name;
    std::optional<ColumnUnit> unit;
  };
  /// A time axis that is stated, not tabulated.
  struct StatedTime {
    double first_s;
    double step_s;
  };

  Separator separator = ',';
  std::size_t cells = 0;  ///< every row has so many; 0: at least as many as the columns need
  std::size_t time_cell = 0;
  double time_unit_s = 1.0;
  std::optional<StatedTime> stated_time;
  std::vector<Column> columns;
  LineReader rows;  ///< before the first row of samples
};

/// @param stem  what a column without a name is called
/// @throws InputError: file, line and mend
[[nodiscard]] TableLayout find_layout(std::string_view text, const std::string& name,
                                      const std::string& stem);

}  // namespace kolsky
