#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/base/measured.hpp"

namespace kolsky {

struct TomlNode;

/// One table of a TOML file, read strictly: what is asked for must be there in the right form, and
/// what nobody asked for is an error. Every access remembers its key; `finish()` on the root, when
/// all is read, refuses the keys that are left over.
///
/// Every function throws InputError with the place "file:line: dotted.key" (arrays count from 0:
/// "bench.toml:23: gauges[1].position_m") and the mend. Numbers are finite; integers are taken
/// where a number is expected. Copies and sub-tables share one memory of what was read: one thread
/// at a time.
class TomlTable {
 public:
  [[nodiscard]] static TomlTable open(const std::filesystem::path& path);
  /// @param name  stands for the file in messages
  [[nodiscard]] static TomlTable parse(const std::string& text, const std::string& name);

  /// Whether the key is there. It is known from now on, but still has to be read.
  [[nodiscard]] bool has(const std::string& key) const;

  [[nodiscard]] double number(const std::string& key) const;
  [[nodiscard]] std::optional<double> optional_number(const std::string& key) const;
  /// The number with its sibling `<key>_sd` (0 if absent), which must not be negative.
  [[nodiscard]] Measured measured(const std::string& key) const;
  /// None if the key is absent; `<key>_sd` without it is an error.
  [[nodiscard]] std::optional<Measured> optional_measured(const std::string& key) const;
  [[nodiscard]] std::int64_t integer(const std::string& key) const;
  [[nodiscard]] std::optional<std::int64_t> optional_integer(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key) const;
  [[nodiscard]] std::optional<std::string> optional_text(const std::string& key) const;
  /// The text, which must be one of `names`: its index there.
  [[nodiscard]] std::size_t choice(const std::string& key,
                                   std::initializer_list<std::string_view> names) const;
  [[nodiscard]] bool flag(const std::string& key) const;
  [[nodiscard]] std::optional<bool> optional_flag(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;
  [[nodiscard]] std::optional<std::vector<std::string>> optional_texts(
      const std::string& key) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& key) const;
  [[nodiscard]] TomlTable table(const std::string& key) const;
  [[nodiscard]] std::optional<TomlTable> optional_table(const std::string& key) const;
  /// An array of tables ([[key]]); empty if there is none.
  [[nodiscard]] std::vector<TomlTable> tables(const std::string& key) const;

  /// The names of this table's keys, in the order of the file; none of them counts as read.
  [[nodiscard]] std::vector<std::string> keys() const;
  /// Takes the key with whatever is below it, unread.
  void accept(const std::string& key) const;

  /// Refuses any key but these (and their `_sd` siblings), so that a misspelt key is named before
  /// the one it stands for is missed. Call it before reading; `finish()` is still needed.
  void expect(std::initializer_list<std::string_view> keys) const;
  void expect(const std::vector<std::string>& keys) const;
  /// Refuses keys in this table and the tables below it that nothing asked for, the first line
  /// first.
  void finish() const;

  /// An error at a key of this table (or at the table, if the key is empty).
  [[nodiscard]] InputError error(const std::string& key, std::string what, std::string mend) const;
  /// An error whose place is a dotted key below this table ("bars.input.length_m"), put into the
  /// file: with the line of that key, or of the nearest table above it.
  [[nodiscard]] InputError located(const InputError& error) const;

  /// The file's name as messages give it, and the text it holds.
  [[nodiscard]] const std::string& file_name() const;
  [[nodiscard]] const std::string& file_text() const;

 private:
  struct Document;
  struct Unread;

  TomlTable(std::shared_ptr<Document> document, const TomlNode& node, std::string path);

  [[nodiscard]] const TomlNode& need(const std::string& key) const;
  [[nodiscard]] TomlTable child(const TomlNode& node, const std::string& key) const;
  [[nodiscard]] std::string dotted(const std::string& key) const;
  [[nodiscard]] InputError unknown_key(const std::string& key,
                                       const std::vector<std::string>& known) const;
  void collect_unread(std::vector<Unread>& unread) const;

  std::shared_ptr<Document> document_;
  const TomlNode* node_;
  std::string path_;
};

}  // namespace kolsky
