#include "drivers/files/settings/toml_document.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>
#include <toml.hpp>
#include <utility>

#include "drivers/files/settings/utf8.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kDeepest = 32;
// The parser takes time that grows with the square of a line's length and with the number of values
// times the size of the file; with these bounds the worst file takes about a second.
constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kMostBytes = std::size_t{256} << 10U;

std::string place_of(const std::string& name, std::size_t line) {
  return name + ":" + std::to_string(line);
}

std::size_t line_at(std::string_view text, std::size_t position) {
  const auto before = text.substr(0, position);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

void require_text(const std::string& text, const std::string& name) {
  const std::size_t valid = valid_utf8_prefix(text);
  if (valid != text.size()) {
    throw InputError(place_of(name, line_at(text, valid)), "is not UTF-8 text", "save it as UTF-8");
  }
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos) {
    throw InputError(place_of(name, line_at(text, zero)), "has a NUL byte: it is not text",
                     "give a TOML file");
  }
}

void require_moderate_size(const std::string& text, const std::string& name) {
  if (text.size() > kMostBytes) {
    throw InputError(name, "is larger than 256 KiB", "check that this is the file you mean");
  }
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (end - start > kLongestLine) {
      throw InputError(place_of(name, line_at(text, start)), "is longer than 4096 bytes",
                       "break the line");
    }
    start = end + 1;
  }
}

// The parser recurses into brackets and dotted keys without a limit of its own, so depth is counted
// before it runs. Follows strings and comments only as far as that needs.
class DepthCheck {
 public:
  DepthCheck(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  void run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == '"' || c == '\'') {
        skip_string(c);
      } else {
        count(c);
        ++at_;
      }
    }
  }

 private:
  void count(char c) {
    if (c == '[' || c == '{') {
      ++open_;
    } else if ((c == ']' || c == '}') && open_ > 0) {
      --open_;
    }
    if (c == '.') {
      ++dots_;
    } else if (std::string_view("[]{},=\n").find(c) != std::string_view::npos) {
      dots_ = 0;
    }
    if (open_ > kDeepest || dots_ > kDeepest) {
      throw InputError(place_of(name_, line_at(text_, at_)),
                       "is nested more than " + std::to_string(kDeepest) + " deep", "flatten it");
    }
  }

  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool multi_line = text_.substr(at_, 3) == triple;
    const std::string_view end = multi_line ? std::string_view(triple) : text_.substr(at_, 1);
    at_ += end.size();
    while (at_ < text_.size() && text_.substr(at_, end.size()) != end) {
      if (!multi_line && text_[at_] == '\n') {
        return;
      }
      at_ += quote == '"' && text_[at_] == '\\' ? 2 : 1;
    }
    at_ = std::min(at_ + end.size(), text_.size());
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::size_t open_ = 0;
  std::size_t dots_ = 0;
};

TomlNode convert(const toml::value& value, std::size_t line, const std::string& name);

std::string number_text(const toml::source_location& where) {
  std::string digits = where.line_str().substr(where.column() - 1, where.region());
  std::erase(digits, '_');
  if (digits.starts_with('+')) {
    digits.erase(0, 1);
  }
  return digits;
}

// The parser saturates numbers that are too large; they are read once more to know.
bool fits(std::string_view digits, TomlNode::Kind kind) {
  const char* const end = digits.data() + digits.size();
  if (kind == TomlNode::Kind::real) {
    double value = 0.0;
    return std::from_chars(digits.data(), end, value).ec != std::errc::result_out_of_range;
  }
  const std::string_view prefix = digits.substr(0, 2);
  const int base = prefix == "0x" ? 16 : prefix == "0o" ? 8 : prefix == "0b" ? 2 : 10;
  std::int64_t value = 0;
  return std::from_chars(digits.data() + (base == 10 ? 0 : 2), end, value, base).ec !=
         std::errc::result_out_of_range;
}

// A value of a table or an array of tables; a line is looked up in the whole text, so plain items
// of arrays go without.
void require_fitting_number(const TomlNode& node, const toml::source_location& where,
                            const std::string& name) {
  const bool number = node.kind == TomlNode::Kind::integer || node.kind == TomlNode::Kind::real;
  if (number && !fits(number_text(where), node.kind)) {
    throw InputError(place_of(name, node.line), "holds a number that 64 bits cannot",
                     "give a smaller one");
  }
}

TomlNode convert_table(const toml::table& table, const std::string& name) {
  TomlNode node;
  for (const auto& [key, item] : table) {
    const toml::source_location where = item.location();
    TomlNode converted = convert(item, where.line(), name);
    require_fitting_number(converted, where, name);
    node.entries.push_back({key, std::move(converted)});
  }
  std::sort(node.entries.begin(), node.entries.end(), [](const auto& a, const auto& b) {
    return std::pair(a.node.line, std::string_view(a.key)) <
           std::pair(b.node.line, std::string_view(b.key));
  });
  return node;
}

TomlNode convert_array(const toml::array& array, std::size_t line, const std::string& name) {
  TomlNode node;
  node.kind = TomlNode::Kind::array;
  for (const auto& item : array) {
    node.items.push_back(convert(item, item.is_table() ? item.location().line() : line, name));
  }
  return node;
}

TomlNode convert_text(const std::string& text, std::size_t line, const std::string& name) {
  if (text.find('\0') != std::string::npos) {
    throw InputError(place_of(name, line), "holds a NUL character", "remove it");
  }
  TomlNode node;
  node.kind = TomlNode::Kind::text;
  node.text = text;
  return node;
}

TomlNode convert_value(const toml::value& value, std::size_t line, const std::string& name) {
  TomlNode node;
  switch (value.type()) {
    case toml::value_t::boolean:
      node.kind = TomlNode::Kind::boolean;
      node.boolean = value.as_boolean();
      return node;
    case toml::value_t::integer:
      node.kind = TomlNode::Kind::integer;
      node.integer = value.as_integer();
      return node;
    case toml::value_t::floating:
      node.kind = TomlNode::Kind::real;
      node.real = value.as_floating();
      return node;
    case toml::value_t::string:
      return convert_text(value.as_string().str, line, name);
    case toml::value_t::array:
      return convert_array(value.as_array(), line, name);
    case toml::value_t::table:
      return convert_table(value.as_table(), name);
    default:
      node.kind = TomlNode::Kind::date;
      return node;
  }
}

TomlNode convert(const toml::value& value, std::size_t line, const std::string& name) {
  TomlNode node = convert_value(value, line, name);
  node.line = line;
  return node;
}

// "[error] toml::parse_key: what\n --> file ..." -> "what"
std::string first_words(std::string_view message) {
  message = message.substr(0, message.find('\n'));
  if (message.starts_with("[error] ")) {
    message.remove_prefix(8);
  }
  if (message.starts_with("toml::")) {
    message.remove_prefix(std::min(message.find(": ") + 2, message.size()));
  }
  return std::string(message.empty() ? "not a value" : message);
}

// The last "12 | key = value" in the message: where it went wrong, after where the construct began.
std::size_t line_in_message(std::string_view message, std::size_t otherwise) {
  std::istringstream lines{std::string(message)};
  std::size_t last = otherwise;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    char bar = '\0';
    if (words >> number >> bar && bar == '|') {
      last = number;
    }
  }
  return last;
}

[[noreturn]] void refuse(const std::string& text, const std::string& name, std::size_t line,
                         const std::string& message) {
  // What is missed at the end of the file is missed in its last line.
  const std::size_t last = line_at(text, text.find_last_not_of(" \t\r\n"));
  throw InputError(place_of(name, std::min(line_in_message(message, line), last)),
                   "is not TOML: " + first_words(message), "mend this line");
}

}  // namespace

TomlNode parse_toml(const std::string& text, const std::string& name) {
  if (text.starts_with("\x89HDF")) {
    throw InputError(name, "is an HDF5 file, as captures are, and no TOML",
                     "give the bench, model or material file that is asked for here");
  }
  require_moderate_size(text, name);
  require_text(text, name);
  DepthCheck(text, name).run();
  std::istringstream stream(text);
  try {
    return convert(toml::parse(stream, name), 1, name);
  } catch (const InputError&) {
    throw;
  } catch (const toml::exception& error) {
    refuse(text, name, error.location().line(), error.what());
  } catch (const std::exception& error) {
    refuse(text, name, 1, error.what());
  }
}

}  // namespace kolsky
