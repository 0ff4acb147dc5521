#include "drivers/files/tables/table_units.hpp"

#include <array>

#include "drivers/files/tables/table_cells.hpp"

namespace kolsky {

namespace {

using Quantity = ColumnUnit::Quantity;

struct KnownUnit {
  std::string_view text;
  ColumnUnit unit;
};

// Prefixes tell by case (mV, MV), so these are taken to the letter; u, micro sign and Greek mu
// alike.
constexpr std::array kUnits{
    KnownUnit{"V", {Quantity::volts, 1.0}},
    KnownUnit{"mV", {Quantity::volts, 1e-3}},
    KnownUnit{"uV", {Quantity::volts, 1e-6}},
    KnownUnit{"nV", {Quantity::volts, 1e-9}},
    KnownUnit{"kV", {Quantity::volts, 1e3}},
    KnownUnit{"strain", {Quantity::strain, 1.0}},
    KnownUnit{"ε", {Quantity::strain, 1.0}},
    KnownUnit{"m/m", {Quantity::strain, 1.0}},
    KnownUnit{"%", {Quantity::strain, 1e-2}},
    KnownUnit{"mε", {Quantity::strain, 1e-3}},
    KnownUnit{"millistrain", {Quantity::strain, 1e-3}},
    KnownUnit{"uε", {Quantity::strain, 1e-6}},
    KnownUnit{"ue", {Quantity::strain, 1e-6}},
    KnownUnit{"um/m", {Quantity::strain, 1e-6}},
    KnownUnit{"ustrain", {Quantity::strain, 1e-6}},
    KnownUnit{"microstrain", {Quantity::strain, 1e-6}},
};

constexpr std::array<std::string_view, 4> kVoltWords{"volt", "volts", "voltage", "v"};

constexpr std::array<std::string_view, 2> kMicro{"\u00B5", "\u03BC"};

std::string with_plain_micro(std::string_view text) {
  for (const std::string_view micro : kMicro) {
    if (text.starts_with(micro)) {
      return std::string("u").append(text.substr(micro.size()));
    }
  }
  return std::string(text);
}

bool is_unit(std::string_view text) {
  return column_unit(text).has_value() || time_unit_s(text).has_value();
}

}  // namespace

std::optional<ColumnUnit> column_unit(std::string_view text) {
  const std::string plain = with_plain_micro(text);
  for (const KnownUnit& known : kUnits) {
    if (plain == known.text) {
      return known.unit;
    }
  }
  const std::string word = lower_case(plain);
  for (const std::string_view volt : kVoltWords) {
    if (word == volt) {
      return ColumnUnit{Quantity::volts, 1.0};
    }
  }
  if (word == "strain" || word == "microstrain") {
    return ColumnUnit{Quantity::strain, word == "strain" ? 1.0 : 1e-6};
  }
  return std::nullopt;
}

std::optional<double> time_unit_s(std::string_view text) {
  const std::string plain = lower_case(with_plain_micro(text));
  if (plain == "s" || plain == "sec" || plain == "second" || plain == "seconds") {
    return 1.0;
  }
  if (plain == "ms") {
    return 1e-3;
  }
  if (plain == "us") {
    return 1e-6;
  }
  if (plain == "ns") {
    return 1e-9;
  }
  if (plain == "ps") {
    return 1e-12;
  }
  return std::nullopt;
}

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  const bool round = text.size() >= 2 && text.front() == '(' && text.back() == ')';
  const bool square = text.size() >= 2 && text.front() == '[' && text.back() == ']';
  return round || square ? trimmed(text.substr(1, text.size() - 2)) : text;
}

NameAndUnit split_unit(std::string_view header) {
  header = trimmed(header);
  if (header.ends_with(')') || header.ends_with(']')) {
    const std::size_t open = header.rfind(header.back() == ')' ? '(' : '[');
    if (open != std::string_view::npos && open > 0) {
      return {trimmed(header.substr(0, open)), without_brackets(header.substr(open)), true};
    }
  }
  // A unit may hold a stroke itself (um/m), so the first stroke with a unit behind it counts.
  for (const char mark : {'/', '_'}) {
    for (std::size_t at = header.find(mark); at != std::string_view::npos;
         at = header.find(mark, at + 1)) {
      const std::string_view unit = trimmed(header.substr(at + 1));
      if (at > 0 && is_unit(unit)) {
        return {trimmed(header.substr(0, at)), unit, false};
      }
    }
  }
  return {header, {}, false};
}

}  // namespace kolsky
