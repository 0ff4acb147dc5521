#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace kolsky::cli {

struct JsonMember;
class JsonValue;
using JsonObject = std::vector<JsonMember>;  ///< in the order it is printed
using JsonList = std::vector<JsonValue>;

/// What --json prints, so that only one unit needs the JSON library.
class JsonValue {
 public:
  using Content = std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double,
                               std::string, std::vector<double>, JsonList, JsonObject>;

  // Implicit on purpose: an object reads as the JSON that it becomes.
  // NOLINTBEGIN(google-explicit-constructor)
  JsonValue(std::nullptr_t);
  JsonValue(bool value);
  JsonValue(std::int64_t value);
  JsonValue(std::uint64_t value);
  JsonValue(double value);
  JsonValue(const char* value);
  JsonValue(std::string value);
  JsonValue(std::vector<double> value);
  JsonValue(const std::vector<std::string>& value);
  JsonValue(JsonList value);
  JsonValue(JsonObject value);
  // NOLINTEND(google-explicit-constructor)

  [[nodiscard]] const Content& content() const { return content_; }

 private:
  Content content_;
};

struct JsonMember {
  std::string name;
  JsonValue value;
};

/// One line. Numbers read back to the same bits; what is not finite is null.
[[nodiscard]] std::string to_text(const JsonValue& value);

}  // namespace kolsky::cli
