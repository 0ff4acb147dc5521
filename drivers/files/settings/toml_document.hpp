#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kolsky {

/// A TOML value with the line it stands in: what is left of a parsed file once the parser is done.
struct TomlNode {
  enum class Kind { boolean, integer, real, text, date, array, table };
  struct Entry;

  Kind kind = Kind::table;
  std::size_t line = 1;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0.0;
  std::string text;
  std::vector<TomlNode> items;  ///< of an array
  std::vector<Entry> entries;   ///< of a table, by line
};

struct TomlNode::Entry {
  std::string key;
  TomlNode node;
};

/// Parses a text; `name` stands for the file in messages. Only UTF-8, nested at most 32 deep.
/// @throws InputError: file, line and what the parser says
[[nodiscard]] TomlNode parse_toml(const std::string& text, const std::string& name);

}  // namespace kolsky
