#include "tests/accuracy/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace kolsky::accuracy {

std::string digits(double value, int significant) {
  return fmt::format("{:.{}g}", value, significant);
}

std::string agreed(double reference, double ours) {
  constexpr double kSame = 1e-7;  // single precision, in which a ball's elements are
  const double off = std::abs(ours - reference) / std::abs(reference);
  return fmt::format("{:.1f}", -std::log10(std::max(off, kSame)));
}

std::string markdown(const Section& section) {
  std::string text = "## " + section.title + "\n\n" + section.text + "\n\n";
  text += fmt::format("| {} |\n", fmt::join(section.header, " | "));
  text += "|";
  for (std::size_t i = 0; i < section.header.size(); ++i) {
    text += "---|";
  }
  text += "\n";
  for (const auto& row : section.rows) {
    text += fmt::format("| {} |\n", fmt::join(row, " | "));
  }
  return text + "\n";
}

}  // namespace kolsky::accuracy
