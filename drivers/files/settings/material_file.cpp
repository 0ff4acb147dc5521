#include "drivers/files/settings/material_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "drivers/files/settings/toml_table.hpp"

namespace kolsky {

namespace {

SolidKind read_solid(const TomlTable& table) {
  const auto name = table.optional_text("solid");
  if (!name) {
    return SolidKind::three_element;
  }
  try {
    return solid_kind(*name);
  } catch (const InputError& error) {
    throw table.located(error);
  }
}

bool has_parameter(SolidKind solid, const std::string& name) {
  const auto& family = parameters_of(solid);
  return std::any_of(family.begin(), family.end(),
                     [&](const SolidParameter& own) { return own.name == name; });
}

/// Of a family that has the parameter, the one of fewest; empty where none has.
std::string family_with(const std::string& parameter) {
  for (const SolidKind solid : {SolidKind::two_kelvin, SolidKind::fractional,
                                SolidKind::three_kelvin, SolidKind::four_kelvin}) {
    if (has_parameter(solid, parameter)) {
      return name_of(solid);
    }
  }
  return "";
}

/// A parameter that another family has says that `solid` is missing or wrong.
void refuse_of_other_solids(const TomlTable& table, SolidKind solid) {
  for (const std::string& key : table.keys()) {
    const std::string family = has_parameter(solid, key) ? "" : family_with(key);
    if (!family.empty()) {
      throw table.error(key, "is no parameter of a " + name_of(solid) + " solid",
                        "leave it out, or say which solid has it: solid = \"" + family + "\"");
    }
  }
}

// The shortest digits that read back as the same bits.
std::string digits(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  std::string result(text.data(), end);
  if (result.find_first_of(".e") == std::string::npos) {
    result += ".0";
  }
  return result;
}

std::string number_line(const std::string& key, const Measured& number) {
  std::string line = key + " = " + digits(number.value) + "\n";
  if (number.sd != 0.0) {
    line += key + "_sd = " + digits(number.sd) + "\n";
  }
  return line;
}

std::string quoted(const std::string& text) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      result += "\\u00";
      result += kHex[byte >> 4U];
      result += kHex[byte & 15U];
    } else {
      result += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    }
  }
  return result + "\"";
}

}  // namespace

Material read_material(const TomlTable& table) {
  Material material;
  material.solid = read_solid(table);
  refuse_of_other_solids(table, material.solid);
  std::vector<std::string> keys = {"density_kg_m3", "poisson_ratio"};
  for (const SolidParameter& parameter : parameters_of(material.solid)) {
    keys.push_back(parameter.name);
  }
  keys.insert(keys.end(), {"solid", "source", "covariance", "identified"});
  table.expect(keys);
  material.density_kg_m3 = table.measured("density_kg_m3");
  material.poisson_ratio = table.measured("poisson_ratio");
  material.parameters.clear();
  for (const SolidParameter& parameter : parameters_of(material.solid)) {
    material.parameters.push_back(table.measured(parameter.name));
  }
  material.source = table.optional_text("source").value_or("");
  if (table.has("covariance")) {
    material.covariance = table.numbers("covariance");
  }
  if (const auto identified = table.optional_table("identified")) {
    material.identified = Material::Identified{identified->optional_number("band_limit_Hz"),
                                               identified->optional_number("temperature_K"),
                                               identified->optional_number("chi2_reduced"),
                                               identified->optional_flag("passive").value_or(true)};
    for (const std::string& key : identified->keys()) {
      identified->accept(key);  // the rest of that is for people
    }
  }
  table.finish();
  try {
    check(material);
  } catch (const InputError& error) {
    throw table.located(error);
  }
  return material;
}

Material read_material(const std::filesystem::path& path) {
  return read_material(TomlTable::open(path));
}

Material parse_material(const std::string& text, const std::string& name) {
  return read_material(TomlTable::parse(text, name));
}

std::string format_material(const Material& material) {
  std::string text;
  if (!material.source.empty()) {
    text += "source = " + quoted(material.source) + "\n";
  }
  if (material.solid != SolidKind::three_element) {
    text += "solid = " + quoted(name_of(material.solid)) + "\n";
  }
  text += number_line("density_kg_m3", material.density_kg_m3);
  text += number_line("poisson_ratio", material.poisson_ratio);
  const auto& family = parameters_of(material.solid);
  for (std::size_t i = 0; i < family.size(); ++i) {
    text += number_line(family[i].name, material.parameters[i]);
  }
  if (material.covariance) {
    text += "covariance = [";  // of the parameters, row by row
    for (std::size_t i = 0; i < material.covariance->size(); ++i) {
      text += (i == 0 ? "" : ", ") + digits((*material.covariance)[i]);
    }
    text += "]\n";
  }
  if (material.identified) {
    text += "\n[identified]\n";
    if (material.identified->band_limit_Hz) {
      text += "band_limit_Hz = " + digits(*material.identified->band_limit_Hz) + "\n";
    }
    if (material.identified->temperature_K) {
      text += "temperature_K = " + digits(*material.identified->temperature_K) + "\n";
    }
  }
  return text;
}

std::string format_material(const Material& material, const Identified& identified) {
  Material from_waves = material;
  from_waves.identified = material.identified.value_or(Material::Identified{});
  return format_material(from_waves) + "shots = " + std::to_string(identified.shots) +
         "\ndispersion = " + quoted(identified.dispersion) +
         "\nchi2_reduced = " + digits(identified.chi2_reduced) +
         "\npassive = " + (identified.passive ? "true" : "false") + "\n" +
         (identified.better_solid.empty()
              ? ""
              : "better_solid = " + quoted(identified.better_solid) + "\n");
}

}  // namespace kolsky
