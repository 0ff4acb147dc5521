#include "drivers/files/tables/scope_table.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "drivers/files/settings/file_bytes.hpp"
#include "drivers/files/sha256.hpp"
#include "drivers/files/tables/table_layout.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30U;

// Reads the rows of samples of one file into its table.
class RowReader {
 public:
  RowReader(TableLayout layout, ScopeTable& table)
      : layout_(std::move(layout)), table_(table), lines_(layout_.rows) {}

  void run() {
    while (next_row()) {
      if (table_.time_s.empty()) {
        table_.first_line = lines_.number();
      }
      take_row();
    }
  }

 private:
  // Blank rows may only end the file.
  bool next_row() {
    std::size_t blank_line = 0;
    while (lines_.next()) {
      split_cells(lines_.line(), layout_.separator, cells_);
      const bool blank = std::all_of(cells_.begin(), cells_.end(),
                                     [](std::string_view cell) { return cell.empty(); });
      if (!blank) {
        if (blank_line != 0 && !table_.time_s.empty()) {
          throw InputError(table_.file + ":" + std::to_string(blank_line),
                           "is blank with samples after it", "remove it or the rest");
        }
        return true;
      }
      blank_line = blank_line == 0 ? lines_.number() : blank_line;
    }
    return false;
  }

  void take_row() {
    require_cells();
    const std::size_t row = table_.time_s.size();
    if (layout_.stated_time) {
      table_.time_s.push_back(layout_.stated_time->first_s +
                              static_cast<double>(row) * layout_.stated_time->step_s);
    } else {
      table_.time_s.push_back(number(layout_.time_cell, "time") * layout_.time_unit_s);
    }
    for (std::size_t i = 0; i < layout_.columns.size(); ++i) {
      table_.columns[i].values.push_back(
          number(layout_.columns[i].cell, layout_.columns[i].header));
    }
  }

  void require_cells() const {
    if (layout_.cells == 0) {
      return;
    }
    const bool trailing = cells_.size() == layout_.cells + 1 && cells_.back().empty();
    if (cells_.size() == layout_.cells || trailing) {
      return;
    }
    const bool doubled = layout_.separator == ',' && cells_.size() == 2 * layout_.cells;
    throw InputError(lines_.place(),
                     "has " + std::to_string(cells_.size()) + " cells where the header has " +
                         std::to_string(layout_.cells),
                     doubled ? "with decimal commas, put ; or a tab between the columns"
                             : "give every row one cell per column");
  }

  double number(std::size_t cell, const std::string& column) const {
    const std::string_view text = cell < cells_.size() ? cells_[cell] : std::string_view();
    const std::optional<double> value = cell_number(text, layout_.separator);
    if (!value || !std::isfinite(*value)) {
      throw InputError(lines_.place() + ": column " + column, problem(text),
                       "give every sample as a finite number");
    }
    return *value;
  }

  static std::string problem(std::string_view text) {
    if (text.empty()) {
      return "is empty";
    }
    if (text.find("∞") != std::string_view::npos) {
      return "is beyond the scope's range";
    }
    constexpr std::size_t kShown = 40;
    return "\"" + std::string(text.substr(0, kShown)) + "\" is not a finite number";
  }

  TableLayout layout_;
  ScopeTable& table_;
  LineReader lines_;
  std::vector<std::string_view> cells_;
};

}  // namespace

std::string ScopeTable::place(std::size_t sample) const {
  return file + ":" + std::to_string(first_line + sample);
}

ScopeTable parse_scope_table(std::string_view bytes, const std::string& name) {
  ScopeTable table;
  table.file = name;
  table.stem = std::filesystem::path(name).stem().string();
  table.sha256 = sha256_hex(std::as_bytes(std::span(bytes)));
  const std::string text = decode_table_text(bytes, name);
  const TableLayout layout = find_layout(text, name, table.stem);
  for (const TableLayout::Column& column : layout.columns) {
    table.columns.push_back({column.header, column.name, column.unit, {}});
  }
  RowReader(layout, table).run();
  if (table.time_s.size() < 2) {
    throw InputError(name, "has " + std::to_string(table.time_s.size()) + " rows of samples",
                     "give at least two");
  }
  return table;
}

ScopeTable read_scope_table(const std::filesystem::path& path) {
  return parse_scope_table(read_file_bytes(path, kMostBytes), path.string());
}

}  // namespace kolsky
