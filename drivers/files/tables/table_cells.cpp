#include "drivers/files/tables/table_cells.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace kolsky {

namespace {

std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell = trimmed(cell.substr(1, cell.size() - 2));
  }
  return cell;
}

void split_at_blanks(std::string_view line, std::vector<std::string_view>& cells) {
  line = trimmed(line);
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    cells.push_back(unquoted(line.substr(0, end)));
    line = trimmed(line.substr(end));
  }
}

// Where the cell that starts the line ends. A quote counts only at the cell's beginning.
std::size_t cell_end(std::string_view line, Separator separator) {
  std::size_t from = 0;
  if (!line.empty() && line.front() == '"') {
    const std::size_t closing = line.find('"', 1);
    from = closing == std::string_view::npos ? 0 : closing + 1;
  }
  return std::min(line.find(separator, from), line.size());
}

std::optional<double> number_of(std::string_view digits) {
  if (digits.starts_with('+') && !digits.starts_with("+-")) {
    digits.remove_prefix(1);
  }
  double value = 0.0;
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (stop != end || digits.empty()) {
    return std::nullopt;
  }
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is zero; too large is left to fail as no number.
    const bool tiny =
        digits.find("e-") != std::string_view::npos || digits.find("E-") != std::string_view::npos;
    return tiny ? std::optional(0.0) : std::nullopt;
  }
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\f";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return lower;
}

void split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') {
    split_at_blanks(line, cells);
    return;
  }
  while (true) {
    const std::size_t end = cell_end(line, separator);
    cells.push_back(unquoted(line.substr(0, end)));
    if (end == line.size()) {
      return;
    }
    line.remove_prefix(end + 1);
  }
}

std::optional<double> cell_number(std::string_view cell, Separator separator) {
  const std::size_t comma = cell.find(',');
  if (separator == ',' || comma == std::string_view::npos) {
    return number_of(cell);
  }
  std::array<char, 64> digits{};
  if (cell.size() > digits.size() || cell.find('.') != std::string_view::npos) {
    return std::nullopt;
  }
  std::copy(cell.begin(), cell.end(), digits.begin());
  digits.at(comma) = '.';
  return number_of({digits.data(), cell.size()});
}

}  // namespace kolsky
