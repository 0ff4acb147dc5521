#include "clients/cli/reports/json_value.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace kolsky::cli {
namespace {

using Json = nlohmann::ordered_json;

Json converted(const JsonValue& value) {
  return std::visit(
      [](const auto& content) -> Json {
        using Content = std::decay_t<decltype(content)>;
        if constexpr (std::is_same_v<Content, JsonList>) {
          Json list = Json::array();
          for (const JsonValue& item : content) {
            list.push_back(converted(item));
          }
          return list;
        } else if constexpr (std::is_same_v<Content, JsonObject>) {
          Json object = Json::object();
          for (const JsonMember& member : content) {
            object[member.name] = converted(member.value);
          }
          return object;
        } else {
          return content;
        }
      },
      value.content());
}

JsonList list_of(const std::vector<std::string>& texts) {
  return {texts.begin(), texts.end()};
}

}  // namespace

JsonValue::JsonValue(std::nullptr_t) : content_(nullptr) {}
JsonValue::JsonValue(bool value) : content_(value) {}
JsonValue::JsonValue(std::int64_t value) : content_(value) {}
JsonValue::JsonValue(std::uint64_t value) : content_(value) {}
JsonValue::JsonValue(double value) : content_(value) {}
JsonValue::JsonValue(const char* value) : content_(std::string(value)) {}
JsonValue::JsonValue(std::string value) : content_(std::move(value)) {}
JsonValue::JsonValue(std::vector<double> value) : content_(std::move(value)) {}
JsonValue::JsonValue(const std::vector<std::string>& value) : content_(list_of(value)) {}
JsonValue::JsonValue(JsonList value) : content_(std::move(value)) {}
JsonValue::JsonValue(JsonObject value) : content_(std::move(value)) {}

std::string to_text(const JsonValue& value) {
  // A path need not be UTF-8, JSON must.
  return converted(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kolsky::cli
