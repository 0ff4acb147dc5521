#include "clients/figure/text_columns.hpp"

#include <sstream>

namespace kolsky {

std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  bool escaping = false;
  for (const char character : text) {
    if (escaping) {
      escaping = character != 'm';
    } else if (character == '\x1b') {
      escaping = true;
    } else if ((static_cast<unsigned char>(character) & 0xC0U) != 0x80U) {
      ++columns;
    }
  }
  return columns;
}

std::vector<std::string> wrapped(const std::string& text, std::size_t columns) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    if (!lines.empty() && columns_of(lines.back()) + 1 + columns_of(word) <= columns) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

}  // namespace kolsky
