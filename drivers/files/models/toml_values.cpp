#include "drivers/files/models/toml_values.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <string_view>

namespace kolsky {

std::string toml_number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  std::string result(text.data(), end);
  if (result.find_first_of(".e") == std::string::npos) {
    result += ".0";
  }
  return result;
}

namespace {

/// As it stands between quotes, all on one line.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace

std::string toml_quoted(const std::string& text) {
  return "\"" + escaped(text) + "\"";
}

std::string toml_lines(const std::string& text) {
  std::string result = "\"\"\"\n";
  std::string_view left = text;
  for (std::size_t end = left.find('\n'); end != std::string_view::npos; end = left.find('\n')) {
    result += escaped(left.substr(0, end)) + "\n";
    left.remove_prefix(end + 1);
  }
  return result + escaped(left) + "\"\"\"";
}

}  // namespace kolsky
