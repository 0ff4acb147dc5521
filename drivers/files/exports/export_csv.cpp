#include <array>
#include <charconv>

#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/exports/export_table.hpp"

namespace kolsky {

namespace {

constexpr mode_t kMode = 0644;

/// As RFC 4180 has it: quoted where it holds what would end it.
std::string header_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

/// The shortest digits that read back as the same bits, with a point whatever the locale.
void append_number(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

std::string csv_of(const ExportTable& table) {
  std::string text;
  for (const ExportColumn& column : table) {
    text += (text.empty() ? "" : ",") + header_cell(column.name);
  }
  text += '\n';
  for (std::size_t row = 0; row < table.front().values.size(); ++row) {
    for (const ExportColumn& column : table) {
      append_number(text, column.values[row]);
      text += ',';
    }
    text.back() = '\n';
  }
  return text;
}

std::filesystem::path gauge_path(const std::filesystem::path& path) {
  auto beside = path;
  return beside.replace_filename(path.stem().string() + "-gauges.csv");
}

}  // namespace

void export_csv(const Shot& shot, const Reduction& reduction, const std::filesystem::path& path) {
  // Both names are looked at before either file is made.
  NewFile histories(path);
  NewFile gauges(gauge_path(path));
  histories.write(csv_of(history_table(reduction)));
  gauges.write(csv_of(gauge_table(shot)));
  gauges.publish(kMode);
  histories.publish(kMode);
}

}  // namespace kolsky
