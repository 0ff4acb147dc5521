#include "drivers/files/tables/shot_facts.hpp"

#include <algorithm>
#include <optional>

#include "drivers/files/tables/table_cells.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

bool has_control_character(const std::string& text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

void require_number_in_unit(const std::string& key, const std::string& text) {
  constexpr Range kSpeed{-500.0, 500.0, "m/s", "give metres per second"};
  constexpr Range kTemperature{60.0, 3000.0, "K", "give kelvin: 20 C is 293.15"};
  const bool speed = key.ends_with("_m_per_s");
  if (!speed && !key.ends_with("_K")) {
    return;
  }
  const std::optional<double> value = cell_number(text, ',');
  if (!value) {
    throw InputError("meta " + key, "\"" + text + "\" is not a number", "give one");
  }
  require_in_range("meta " + key, {*value, 0.0}, speed ? kSpeed : kTemperature);
}

}  // namespace

void check_shot_facts(const std::map<std::string, std::string>& meta) {
  for (const auto& [key, text] : meta) {
    if (key.empty() || has_control_character(key) || has_control_character(text)) {
      throw InputError("meta " + key, "is not a name and a line of text", "give key=value");
    }
    require_number_in_unit(key, text);
  }
}

}  // namespace kolsky
