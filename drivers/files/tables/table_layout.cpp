#include "drivers/files/tables/table_layout.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

using Cells = std::vector<std::string_view>;

constexpr const char* kHeaderMend = "give a header row, as time_s,<gauge>,...";

bool blank(std::string_view line) {
  return trimmed(line).empty();
}

std::string_view last_line_with_content(std::string_view text) {
  while (!text.empty()) {
    const std::size_t start = text.rfind('\n');
    const std::string_view line = start == std::string_view::npos ? text : text.substr(start + 1);
    if (!blank(line)) {
      return line;
    }
    text = text.substr(0, start == std::string_view::npos ? 0 : start);
  }
  return {};
}

std::string_view middle_line(std::string_view text) {
  const std::size_t before = text.rfind('\n', text.size() / 2);
  const std::size_t start = before == std::string_view::npos ? 0 : before + 1;
  return text.substr(start, text.find('\n', start) - start);
}

Separator find_separator(std::string_view text) {
  const std::string_view last = last_line_with_content(text);
  const std::string_view middle = middle_line(text);
  for (const Separator candidate : {'\t', ';', ','}) {
    if (last.find(candidate) != std::string_view::npos ||
        middle.find(candidate) != std::string_view::npos) {
      return candidate;
    }
  }
  return ' ';
}

bool is_time_name(std::string_view name) {
  const std::string word = lower_case(name);
  return word == "time" || word == "t" || word == "zeit";
}

void drop_empty_end(Cells& cells) {
  while (!cells.empty() && cells.back().empty()) {
    cells.pop_back();
  }
}

std::optional<ColumnUnit> unit_in_brackets(const NameAndUnit& header, const std::string& place) {
  const std::optional<ColumnUnit> unit = column_unit(header.unit);
  if (!unit) {
    throw InputError(place, "the unit \"" + std::string(header.unit) + "\" is not known",
                     "give V, mV, uV, strain or microstrain");
  }
  return unit;
}

TableLayout::Column named_column(std::size_t cell, std::string_view header,
                                 const std::string& place) {
  const NameAndUnit split = split_unit(header);
  const std::optional<ColumnUnit> unit =
      split.bracketed ? unit_in_brackets(split, place) : column_unit(split.unit);
  const std::string_view name = unit ? split.name : header;
  return {cell, std::string(header), std::string(name), unit};
}

// ---- a header row, time first

struct TimeHeader {
  std::optional<double> unit_s;
};

std::optional<TimeHeader> time_header(std::string_view cell, const std::string& place) {
  const NameAndUnit split = split_unit(cell);
  if (!is_time_name(split.name)) {
    return std::nullopt;
  }
  if (split.unit.empty()) {
    return TimeHeader{std::nullopt};
  }
  const std::optional<double> unit_s = time_unit_s(split.unit);
  if (!unit_s) {
    throw InputError(place, "the time unit \"" + std::string(split.unit) + "\" is not known",
                     "give s, ms, us or ns");
  }
  return TimeHeader{unit_s};
}

bool is_unit_row(const Cells& cells) {
  if (cells.empty() || cells.front().empty()) {
    return false;
  }
  return without_brackets(cells.front()) != cells.front() || time_unit_s(cells.front());
}

// Takes a row of units, as "(us),(mV),(mV)".
void apply_unit_row(const Cells& cells, const std::optional<double>& header_unit_s,
                    TableLayout& layout, const std::string& place) {
  const std::string_view time_text = without_brackets(cells.front());
  const std::optional<double> unit_s = time_unit_s(time_text);
  if (!unit_s || (header_unit_s && *header_unit_s != *unit_s)) {
    throw InputError(place,
                     "the time unit \"" + std::string(time_text) +
                         (unit_s ? "\" differs from the header's" : "\" is not known"),
                     "give s, ms, us or ns");
  }
  layout.time_unit_s = *unit_s;
  for (TableLayout::Column& column : layout.columns) {
    const std::string_view text =
        column.cell < cells.size() ? without_brackets(cells[column.cell]) : std::string_view();
    if (text.empty()) {
      continue;
    }
    const std::optional<ColumnUnit> unit = column_unit(text);
    if (!unit || (column.unit && *column.unit != *unit)) {
      throw InputError(place + ": column " + column.header,
                       "the unit \"" + std::string(text) +
                           (unit ? "\" differs from the header's" : "\" is not known"),
                       "give V, mV, uV, strain or microstrain");
    }
    column.unit = unit;
  }
}

// The reader moved to before the first line with content, past a row of units if there is one.
LineReader past_units(LineReader lines, const std::optional<double>& header_unit_s,
                      TableLayout& layout) {
  Cells cells;
  LineReader before = lines;
  bool units_seen = false;
  while (lines.next()) {
    split_cells(lines.line(), layout.separator, cells);
    if (!blank(lines.line())) {
      if (units_seen || !is_unit_row(cells)) {
        return before;
      }
      apply_unit_row(cells, header_unit_s, layout, lines.place());
      units_seen = true;
    }
    before = lines;
  }
  return before;
}

bool begins_with_number(LineReader lines, Separator separator) {
  Cells cells;
  if (!lines.next()) {
    return false;
  }
  split_cells(lines.line(), separator, cells);
  return cell_number(cells.front(), separator).has_value();
}

void require_distinct(const std::vector<TableLayout::Column>& columns, const std::string& place) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (columns[i].header == columns[j].header && !columns[i].header.empty()) {
        throw InputError(place, "two columns are called \"" + columns[i].header + "\"",
                         "give each column its own name");
      }
    }
  }
}

// The layout if this row is a header, whatever follows it.
std::optional<TableLayout> header_row(const LineReader& lines, Separator separator) {
  std::string_view line = trimmed(lines.line());
  if (line.starts_with('#')) {
    line = trimmed(line.substr(1));
  }
  Cells cells;
  split_cells(line, separator, cells);
  drop_empty_end(cells);
  const auto time = cells.empty() ? std::nullopt : time_header(cells.front(), lines.place());
  if (!time) {
    return std::nullopt;
  }
  TableLayout layout{.separator = separator,
                     .cells = cells.size(),
                     .time_cell = 0,
                     .time_unit_s = time->unit_s.value_or(1.0),
                     .stated_time = {},
                     .columns = {},
                     .rows = lines};
  for (std::size_t i = 1; i < cells.size(); ++i) {
    layout.columns.push_back(named_column(i, cells[i], lines.place()));
  }
  layout.rows = past_units(lines, time->unit_s, layout);
  return layout;
}

void require_channels(const TableLayout& layout, const std::string& place) {
  if (layout.columns.empty()) {
    throw InputError(place, "has a time column and no other", kHeaderMend);
  }
  require_distinct(layout.columns, place);
}

// A row of a preamble can look like a header ("Time,14:05:33"); the real one is followed by a
// number. If none is, the first that looks like one is taken, so that the row behind it is what is
// complained about.
TableLayout headed_layout(std::string_view text, const std::string& name, Separator separator) {
  constexpr std::size_t kLongestPreamble = 1000;
  LineReader lines(text, name);
  std::optional<TableLayout> best;
  std::string best_place;
  while (lines.next() && lines.number() <= kLongestPreamble) {
    std::optional<TableLayout> found = header_row(lines, separator);
    if (found) {
      const bool real = begins_with_number(found->rows, separator);
      if (!best || real) {
        best = std::move(found);
        best_place = lines.place();
      }
      if (real) {
        break;
      }
    }
  }
  if (!best) {
    throw InputError(name, "has no header row that begins with time", kHeaderMend);
  }
  require_channels(*best, best_place);
  return *best;
}

// ---- header fields in three columns, time and volts in the next two

constexpr std::size_t kFieldTimeCell = 3;
constexpr std::size_t kFieldValueCell = 4;

bool has_header_fields(const Cells& cells, Separator separator) {
  return cells.size() > kFieldValueCell && lower_case(cells.front()) == "record length" &&
         cell_number(cells[kFieldTimeCell], separator).has_value();
}

void take_header_field(const Cells& cells, TableLayout& layout, const std::string& place) {
  const std::string key = lower_case(cells[0]);
  TableLayout::Column& column = layout.columns.front();
  if (key == "source" && !cells[1].empty()) {
    column.name = column.header = std::string(cells[1]);
  } else if (key == "vertical units" && !cells[1].empty()) {
    column.unit = unit_in_brackets({column.header, cells[1], true}, place);
  } else if (key == "horizontal units" && time_unit_s(cells[1]) != 1.0) {
    throw InputError(place, "the time unit \"" + std::string(cells[1]) + "\" is not known",
                     "export time in seconds");
  }
}

std::optional<TableLayout> header_field_layout(std::string_view text, const std::string& name,
                                               const std::string& stem, Separator separator) {
  LineReader lines(text, name);
  const LineReader start = lines;
  Cells cells;
  if (!lines.next()) {
    return std::nullopt;
  }
  split_cells(lines.line(), separator, cells);
  if (!has_header_fields(cells, separator)) {
    return std::nullopt;
  }
  drop_empty_end(cells);
  if (cells.size() > kFieldValueCell + 1) {
    throw InputError(lines.place(), "holds more than one channel beside the header fields",
                     "export each channel to its own file");
  }
  TableLayout layout{.separator = separator,
                     .cells = 0,
                     .time_cell = kFieldTimeCell,
                     .time_unit_s = 1.0,
                     .stated_time = {},
                     .columns = {{kFieldValueCell, stem, stem, {}}},
                     .rows = start};
  constexpr std::size_t kMostFields = 64;
  while (lines.next() && lines.number() <= kMostFields) {
    split_cells(lines.line(), separator, cells);
    if (cells.size() > kFieldValueCell) {
      take_header_field(cells, layout, lines.place());
    }
  }
  return layout;
}

// ---- metadata, and waveforms beside it that begin with t0 and dt

std::size_t leading_empty(const Cells& cells) {
  const auto first =
      std::find_if(cells.begin(), cells.end(), [](std::string_view cell) { return !cell.empty(); });
  return static_cast<std::size_t>(first - cells.begin());
}

bool all_numbers(const Cells& cells, std::size_t from, Separator separator) {
  return from < cells.size() &&
         std::all_of(cells.begin() + static_cast<std::ptrdiff_t>(from), cells.end(),
                     [&](std::string_view cell) { return cell_number(cell, separator); });
}

// The one number in all waveforms' columns of this row.
double common_number(const LineReader& lines, const Cells& cells, std::size_t from,
                     Separator separator, const std::string& what) {
  const double first = *cell_number(cells[from], separator);
  for (std::size_t i = from + 1; i < cells.size(); ++i) {
    if (*cell_number(cells[i], separator) != first) {
      throw InputError(lines.place(), "the waveforms differ in " + what,
                       "export the channels with one time axis");
    }
  }
  if (!std::isfinite(first)) {
    throw InputError(lines.place(), what + " is not finite", "give seconds");
  }
  return first;
}

std::optional<TableLayout> waveform_layout(std::string_view text, const std::string& name,
                                           Separator separator) {
  Cells last;
  split_cells(last_line_with_content(text), separator, last);
  const std::size_t from = leading_empty(last);
  LineReader lines(text, name);
  Cells names;
  if (from == 0 || !all_numbers(last, from, separator) || !lines.next()) {
    return std::nullopt;
  }
  split_cells(lines.line(), separator, names);
  if (names.size() != last.size() || names.front().empty() ||
      time_header(names.front(), lines.place()) || all_numbers(names, from, separator)) {
    return std::nullopt;
  }
  TableLayout layout{.separator = separator,
                     .cells = last.size(),
                     .time_cell = from,
                     .time_unit_s = 1.0,
                     .stated_time = {},
                     .columns = {},
                     .rows = lines};
  for (std::size_t i = from; i < names.size(); ++i) {
    layout.columns.push_back(named_column(i, names[i], lines.place()));
  }
  require_channels(layout, lines.place());
  const auto stated = [&](const std::string& what) {
    Cells cells;
    if (lines.next()) {
      split_cells(lines.line(), separator, cells);
    }
    if (cells.size() != last.size() || !all_numbers(cells, from, separator)) {
      throw InputError(lines.place(), what + " is missing", "give t0 and dt before the samples");
    }
    return common_number(lines, cells, from, separator, what);
  };
  const double first_s = stated("t0");
  const double step_s = stated("dt");
  if (step_s <= 0.0) {
    throw InputError(lines.place(), "dt is not positive", "give the sample interval in seconds");
  }
  layout.stated_time = {first_s, step_s};
  layout.rows = lines;
  return layout;
}

}  // namespace

TableLayout find_layout(std::string_view text, const std::string& name, const std::string& stem) {
  const Separator separator = find_separator(text);
  if (auto layout = header_field_layout(text, name, stem, separator)) {
    return *layout;
  }
  if (auto layout = waveform_layout(text, name, separator)) {
    return *layout;
  }
  return headed_layout(text, name, separator);
}

}  // namespace kolsky
