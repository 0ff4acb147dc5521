#include "drivers/files/tables/shot_facts.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "drivers/files/settings/nearest_name.hpp"
#include "drivers/files/tables/table_cells.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

/// A fact that programs read by its name. Other names are free.
struct KnownFact {
  const char* quantity;
  const char* unit;
};

constexpr std::array<KnownFact, 4> kKnownFacts{{{"incident_speed", "_m_per_s"},
                                                {"rebound_speed", "_m_per_s"},
                                                {"striker_speed", "_m_per_s"},
                                                {"temperature", "_K"}}};

bool has_control_character(const std::string& text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

double number_of(const std::string& key, const std::string& text) {
  const std::optional<double> value = cell_number(text, ',');
  if (!value) {
    throw InputError("meta " + key, "\"" + text + "\" is not a number", "give one");
  }
  return *value;
}

void require_number_in_unit(const std::string& key, const std::string& text) {
  constexpr Range kSpeed{-500.0, 500.0, "m/s", "give metres per second"};
  constexpr Range kTemperature{60.0, 3000.0, "K", "give kelvin: 20 C is 293.15"};
  const bool speed = key.ends_with("_m_per_s");
  if (speed || key.ends_with("_K")) {
    require_in_range("meta " + key, {number_of(key, text), 0.0}, speed ? kSpeed : kTemperature);
  }
  const bool deviation = key.ends_with("_m_per_s_sd") || key.ends_with("_K_sd");
  if (deviation && !(number_of(key, text) >= 0.0)) {
    throw InputError("meta " + key, text + " is no deviation", "give a number from 0 up");
  }
}

/// What moves towards the bar does so; a rebound may be filed with its sign.
void require_motion(const std::string& key, const std::string& text) {
  if ((key == "incident_speed_m_per_s" || key == "striker_speed_m_per_s") &&
      !(number_of(key, text) > 0.0)) {
    throw InputError("meta " + key, text + " does not move towards the bar",
                     "give metres per second, positive towards the bar");
  }
  if (key == "rebound_speed_m_per_s" && number_of(key, text) == 0.0) {
    throw InputError("meta " + key, text + " is no rebound",
                     "give metres per second, or leave it out");
  }
}

/// A name that is nearly one that programs read would be kept and read by none.
void refuse_misspelt(const std::string& key) {
  if (std::any_of(key.begin(), key.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) {
    return;  // one of several, numbered
  }
  for (const KnownFact& known : kKnownFacts) {
    const std::string name = std::string(known.quantity) + known.unit;
    if (key == name || key == name + "_sd") {
      return;
    }
  }
  for (const KnownFact& known : kKnownFacts) {
    for (const char* of : {"", "_sd"}) {
      const std::string name = std::string(known.quantity) + known.unit + of;
      if (key == known.quantity + std::string(of) || edit_distance(key, name) <= name.size() / 4) {
        throw InputError("meta " + key, "is no fact that anything here reads",
                         "did you mean " + name + "? The unit is part of the name");
      }
    }
  }
}

}  // namespace

void check_shot_facts(const std::map<std::string, std::string>& meta) {
  for (const auto& [key, text] : meta) {
    if (key.empty() || has_control_character(key) || has_control_character(text)) {
      throw InputError("meta " + key, "is not a name and a line of text", "give key=value");
    }
    refuse_misspelt(key);
    require_number_in_unit(key, text);
    require_motion(key, text);
  }
}

}  // namespace kolsky
