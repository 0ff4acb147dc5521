#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace kolsky {

/// The text of a table as UTF-8 with lines ended by '\n', from what programs write: UTF-8 with or
/// without a mark, UTF-16 with one, Latin-1; lines ended by LF, CR LF or CR.
/// @param name  stands for the file in messages
/// @throws InputError: the file holds something else (control characters, a broken pair)
[[nodiscard]] std::string decode_table_text(std::string_view bytes, const std::string& name);

/// Walks over the lines of a text. Cheap to copy, so that a copy looks ahead.
class LineReader {
 public:
  LineReader(std::string_view text, const std::string& name) : rest_(text), name_(&name) {}

  /// Moves to the next line; false at the end. @throws InputError for a line of more than 64 KiB
  bool next();

  [[nodiscard]] std::string_view line() const { return line_; }
  /// Counted from 1; 0 before the first `next`.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// "file:line", as errors give it.
  [[nodiscard]] std::string place() const;

 private:
  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
  const std::string* name_;
};

}  // namespace kolsky
