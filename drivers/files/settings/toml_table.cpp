#include "drivers/files/settings/toml_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "drivers/files/settings/file_bytes.hpp"
#include "drivers/files/settings/nearest_name.hpp"
#include "drivers/files/settings/toml_document.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20U;

std::string kind_name(TomlNode::Kind kind) {
  switch (kind) {
    case TomlNode::Kind::boolean:
      return "true or false";
    case TomlNode::Kind::integer:
      return "an integer";
    case TomlNode::Kind::real:
      return "a number";
    case TomlNode::Kind::text:
      return "a text";
    case TomlNode::Kind::date:
      return "a date or time";
    case TomlNode::Kind::array:
      return "an array";
    case TomlNode::Kind::table:
      return "a table";
  }
  return "something else";
}

const TomlNode* entry_of(const TomlNode& table, std::string_view key) {
  for (const auto& entry : table.entries) {
    if (entry.key == key) {
      return &entry.node;
    }
  }
  return nullptr;
}

std::string item_name(const std::string& key, std::size_t index) {
  return key + "[" + std::to_string(index) + "]";
}

// The node at a dotted place, "gauges[1].position_m", or the nearest one above it that is there.
const TomlNode& nearest_node(const TomlNode& table, std::string_view place) {
  for (const auto& [key, node] : table.entries) {
    if (place == key) {
      return node;
    }
    if (place.starts_with(key + ".")) {
      return nearest_node(node, place.substr(key.size() + 1));
    }
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const std::string item = item_name(key, i);
      if (place == item) {
        return node.items[i];
      }
      if (place.starts_with(item + ".")) {
        return nearest_node(node.items[i], place.substr(item.size() + 1));
      }
    }
  }
  return table;
}

bool is_deviation_of(std::string_view key, std::string_view number) {
  return key.size() == number.size() + 3 && key.substr(0, number.size()) == number &&
         key.substr(number.size()) == "_sd";
}

}  // namespace

struct TomlTable::Document {
  struct Access {
    std::set<std::string> known;
    std::set<std::string> read;
  };

  std::string name;
  std::string text;
  TomlNode root;
  std::map<const TomlNode*, Access> accesses;
};

struct TomlTable::Unread {
  std::size_t line;
  TomlTable table;
  std::string key;
};

TomlTable::TomlTable(std::shared_ptr<Document> document, const TomlNode& node, std::string path)
    : document_(std::move(document)), node_(&node), path_(std::move(path)) {}

TomlTable TomlTable::open(const std::filesystem::path& path) {
  return parse(read_file_bytes(path, kMostBytes), path.string());
}

TomlTable TomlTable::parse(const std::string& text, const std::string& name) {
  auto document = std::make_shared<Document>();
  document->name = name;
  document->text = text;
  document->root = parse_toml(text, name);
  const TomlNode& root = document->root;
  return {std::move(document), root, ""};
}

bool TomlTable::has(const std::string& key) const {
  document_->accesses[node_].known.insert(key);
  return entry_of(*node_, key) != nullptr;
}

double TomlTable::number(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind == TomlNode::Kind::integer) {
    return static_cast<double>(node.integer);
  }
  if (node.kind != TomlNode::Kind::real) {
    throw error(key, "is " + kind_name(node.kind), "give a number");
  }
  if (!std::isfinite(node.real)) {
    throw error(key, "is not finite", "give a finite number");
  }
  return node.real;
}

std::optional<double> TomlTable::optional_number(const std::string& key) const {
  return has(key) ? std::optional(number(key)) : std::nullopt;
}

Measured TomlTable::measured(const std::string& key) const {
  const std::string deviation = key + "_sd";
  const Measured result{number(key), optional_number(deviation).value_or(0.0)};
  if (result.sd < 0.0) {
    throw error(deviation, "is negative", "give a standard deviation of at least 0");
  }
  return result;
}

std::optional<Measured> TomlTable::optional_measured(const std::string& key) const {
  const std::string deviation = key + "_sd";
  if (has(key)) {
    return measured(key);
  }
  if (has(deviation)) {
    throw error(deviation, "is the standard deviation of a number that is not there",
                "give \"" + key + "\" too");
  }
  return std::nullopt;
}

std::int64_t TomlTable::integer(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::integer) {
    throw error(key, "is " + kind_name(node.kind), "give an integer");
  }
  return node.integer;
}

std::optional<std::int64_t> TomlTable::optional_integer(const std::string& key) const {
  return has(key) ? std::optional(integer(key)) : std::nullopt;
}

std::string TomlTable::text(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::text) {
    throw error(key, "is " + kind_name(node.kind), "give a text in quotes");
  }
  return node.text;
}

std::optional<std::string> TomlTable::optional_text(const std::string& key) const {
  return has(key) ? std::optional(text(key)) : std::nullopt;
}

std::size_t TomlTable::choice(const std::string& key,
                              std::initializer_list<std::string_view> names) const {
  const std::string chosen = text(key);
  const auto* const found = std::find(names.begin(), names.end(), chosen);
  if (found == names.end()) {
    std::string all;
    for (const std::string_view name : names) {
      all += (all.empty() ? "\"" : ", \"") + std::string(name) + "\"";
    }
    throw error(key, "is \"" + chosen + "\"", "give one of " + all);
  }
  return static_cast<std::size_t>(found - names.begin());
}

bool TomlTable::flag(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::boolean) {
    throw error(key, "is " + kind_name(node.kind), "give true or false");
  }
  return node.boolean;
}

std::optional<bool> TomlTable::optional_flag(const std::string& key) const {
  return has(key) ? std::optional(flag(key)) : std::nullopt;
}

std::vector<std::string> TomlTable::texts(const std::string& key) const {
  const TomlNode& node = need(key);
  std::vector<std::string> result;
  for (const TomlNode& item : node.items) {
    if (item.kind == TomlNode::Kind::text) {
      result.push_back(item.text);
    }
  }
  if (node.kind != TomlNode::Kind::array || result.size() != node.items.size()) {
    throw error(key, "is not an array of texts", "give [\"one\", \"two\"]");
  }
  return result;
}

std::optional<std::vector<std::string>> TomlTable::optional_texts(const std::string& key) const {
  return has(key) ? std::optional(texts(key)) : std::nullopt;
}

std::vector<double> TomlTable::numbers(const std::string& key) const {
  const TomlNode& node = need(key);
  std::vector<double> result;
  for (const TomlNode& item : node.items) {
    if (item.kind == TomlNode::Kind::integer) {
      result.push_back(static_cast<double>(item.integer));
    } else if (item.kind == TomlNode::Kind::real && std::isfinite(item.real)) {
      result.push_back(item.real);
    }
  }
  if (node.kind != TomlNode::Kind::array || result.size() != node.items.size()) {
    throw error(key, "is not an array of finite numbers", "give [1.0, 2.0]");
  }
  return result;
}

TomlTable TomlTable::table(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::table) {
    throw error(key, "is " + kind_name(node.kind), "give a table, [" + dotted(key) + "]");
  }
  return child(node, key);
}

std::optional<TomlTable> TomlTable::optional_table(const std::string& key) const {
  return has(key) ? std::optional(table(key)) : std::nullopt;
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) const {
  std::vector<TomlTable> result;
  if (!has(key)) {
    return result;
  }
  const TomlNode& node = need(key);
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (node.items[i].kind == TomlNode::Kind::table) {
      result.push_back(child(node.items[i], item_name(key, i)));
    }
  }
  if (node.kind != TomlNode::Kind::array || result.size() != node.items.size()) {
    throw error(key, "is not an array of tables", "give tables, [[" + dotted(key) + "]]");
  }
  return result;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> result;
  for (const auto& entry : node_->entries) {
    result.push_back(entry.key);
  }
  return result;
}

void TomlTable::accept(const std::string& key) const {
  auto& access = document_->accesses[node_];
  access.known.insert(key);
  access.read.insert(key);
}

void TomlTable::expect(std::initializer_list<std::string_view> keys) const {
  expect(std::vector<std::string>(keys.begin(), keys.end()));
}

void TomlTable::expect(const std::vector<std::string>& keys) const {
  for (const auto& entry : node_->entries) {
    const bool expected = std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
      return entry.key == key || is_deviation_of(entry.key, key);
    });
    if (!expected) {
      throw unknown_key(entry.key, keys);
    }
  }
}

void TomlTable::finish() const {
  std::vector<Unread> unread;
  collect_unread(unread);
  const auto first = std::min_element(unread.begin(), unread.end(),
                                      [](const auto& a, const auto& b) { return a.line < b.line; });
  if (first != unread.end()) {
    const auto& known = document_->accesses[first->table.node_].known;
    throw first->table.unknown_key(first->key, {known.begin(), known.end()});
  }
}

InputError TomlTable::error(const std::string& key, std::string what, std::string mend) const {
  return located(InputError(key, std::move(what), std::move(mend)));
}

InputError TomlTable::located(const InputError& error) const {
  const TomlNode& nearest = nearest_node(*node_, error.place());
  const bool whole_file = &nearest == &document_->root;
  const std::string file =
      whole_file ? document_->name : document_->name + ":" + std::to_string(nearest.line);
  const std::string place = dotted(error.place());
  return {place.empty() ? file : file + ": " + place, error.problem(), error.mend()};
}

const std::string& TomlTable::file_name() const {
  return document_->name;
}

const std::string& TomlTable::file_text() const {
  return document_->text;
}

const TomlNode& TomlTable::need(const std::string& key) const {
  accept(key);
  const TomlNode* node = entry_of(*node_, key);
  if (node == nullptr) {
    throw error(key, "is missing", "add it");
  }
  return *node;
}

TomlTable TomlTable::child(const TomlNode& node, const std::string& key) const {
  document_->accesses.try_emplace(&node);
  return {document_, node, dotted(key)};
}

std::string TomlTable::dotted(const std::string& key) const {
  return path_.empty() || key.empty() ? path_ + key : path_ + "." + key;
}

InputError TomlTable::unknown_key(const std::string& key,
                                  const std::vector<std::string>& known) const {
  const std::string nearest = nearest_name(key, known);
  return error(key, "is not a known key",
               nearest.empty() ? "remove it" : "did you mean \"" + nearest + "\"?");
}

void TomlTable::collect_unread(std::vector<Unread>& unread) const {
  const auto& access = document_->accesses[node_];
  const auto descend = [&](const TomlNode& node, const std::string& key) {
    if (document_->accesses.contains(&node)) {
      child(node, key).collect_unread(unread);
    }
  };
  for (const auto& [key, node] : node_->entries) {
    if (!access.read.contains(key)) {
      unread.push_back({node.line, *this, key});
      continue;
    }
    descend(node, key);
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      descend(node.items[i], item_name(key, i));
    }
  }
}

}  // namespace kolsky
