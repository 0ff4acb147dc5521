#include "drivers/files/tables/table_text.hpp"

#include <algorithm>
#include <cstdint>

#include "drivers/files/settings/utf8.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kLongestLine = std::size_t{64} << 10U;

void append_utf8(std::string& text, char32_t point) {
  const auto put = [&](char32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (point < 0x80) {
    put(point);
  } else if (point < 0x800) {
    put(0xC0U | (point >> 6U));
    put(0x80U | (point & 0x3FU));
  } else if (point < 0x10000) {
    put(0xE0U | (point >> 12U));
    put(0x80U | ((point >> 6U) & 0x3FU));
    put(0x80U | (point & 0x3FU));
  } else {
    put(0xF0U | (point >> 18U));
    put(0x80U | ((point >> 12U) & 0x3FU));
    put(0x80U | ((point >> 6U) & 0x3FU));
    put(0x80U | (point & 0x3FU));
  }
}

std::string from_latin1(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  for (const char c : bytes) {
    append_utf8(text, static_cast<unsigned char>(c));
  }
  return text;
}

[[noreturn]] void refuse_utf16(const std::string& name) {
  throw InputError(name, "begins as UTF-16 and is broken further on", "save it as UTF-8");
}

// The bytes after the mark.
std::string from_utf16(std::string_view bytes, bool big_endian, const std::string& name) {
  if (bytes.size() % 2 != 0) {
    refuse_utf16(name);
  }
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]);
    const auto second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<char32_t>(big_endian ? (first << 8U) | second : (second << 8U) | first);
  };
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    char32_t point = unit(i);
    if (point >= 0xD800 && point < 0xE000) {
      const char32_t low = i + 2 < bytes.size() ? unit(i + 2) : 0;
      if (point >= 0xDC00 || low < 0xDC00 || low >= 0xE000) {
        refuse_utf16(name);
      }
      point = 0x10000 + ((point - 0xD800) << 10U) + (low - 0xDC00);
      i += 2;
    }
    append_utf8(text, point);
  }
  return text;
}

std::string to_utf8(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return from_utf16(bytes.substr(2), bytes.front() == '\xFE', name);
  }
  if (bytes.starts_with("\xEF\xBB\xBF")) {
    bytes.remove_prefix(3);
  }
  return valid_utf8_prefix(bytes) == bytes.size() ? std::string(bytes) : from_latin1(bytes);
}

void refuse_other_files(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) {
    throw InputError(name, "is empty", "give a table with a header and rows of samples");
  }
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("\xD0\xCF\x11\xE0")) {
    throw InputError(name, "is a workbook or an archive, not text", "export it as CSV");
  }
  if (bytes.starts_with("\x89HDF")) {
    throw InputError(name, "is an HDF5 file, not text", "export it as CSV");
  }
}

// One kind of line end, so that the rest counts lines once.
void unify_line_ends(std::string& text) {
  if (text.find('\r') == std::string::npos) {
    return;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool pair = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if (!pair) {
      text[kept++] = text[i] == '\r' ? '\n' : text[i];
    }
  }
  text.resize(kept);
}

void refuse_control_characters(std::string_view text, const std::string& name) {
  const auto* const found = std::find_if(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\n' && c != '\t' && c != '\f';
  });
  if (found != text.end()) {
    const auto line = 1 + std::count(text.begin(), found, '\n');
    throw InputError(name + ":" + std::to_string(line), "holds binary bytes: it is not text",
                     "export it as CSV");
  }
}

}  // namespace

std::string decode_table_text(std::string_view bytes, const std::string& name) {
  refuse_other_files(bytes, name);
  std::string text = to_utf8(bytes, name);
  unify_line_ends(text);
  refuse_control_characters(text, name);
  return text;
}

bool LineReader::next() {
  if (rest_.empty()) {
    return false;
  }
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  ++number_;
  if (end > kLongestLine) {
    throw InputError(place(), "is longer than 64 KiB", "give one row of samples per line");
  }
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  return true;
}

std::string LineReader::place() const {
  return *name_ + ":" + std::to_string(number_);
}

}  // namespace kolsky
