#include "processing/base/solid_kind.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::array kNames{std::pair{SolidKind::three_element, "three-element"},
                            std::pair{SolidKind::four_element_fluid, "four-element-fluid"},
                            std::pair{SolidKind::two_kelvin, "two-kelvin"},
                            std::pair{SolidKind::three_kelvin, "three-kelvin"},
                            std::pair{SolidKind::four_kelvin, "four-kelvin"},
                            std::pair{SolidKind::fractional, "fractional"}};

/// By how many Kelvin branches they have.
constexpr std::array kKelvin{SolidKind::three_element, SolidKind::two_kelvin,
                             SolidKind::three_kelvin, SolidKind::four_kelvin};

}  // namespace

const std::vector<SolidParameter>& parameters_of(SolidKind kind) {
  using Is = SolidParameter::Is;
  static const SolidParameter E1{"E1_Pa", Is::modulus};
  static const SolidParameter E2{"E2_Pa", Is::modulus};
  static const SolidParameter eta2{"eta2_Pa_s", Is::viscosity};
  static const SolidParameter E3{"E3_Pa", Is::modulus};
  static const SolidParameter eta3{"eta3_Pa_s", Is::viscosity};
  static const SolidParameter E4{"E4_Pa", Is::modulus};
  static const SolidParameter eta4{"eta4_Pa_s", Is::viscosity};
  static const SolidParameter E5{"E5_Pa", Is::modulus};
  static const SolidParameter eta5{"eta5_Pa_s", Is::viscosity};
  static const std::vector<SolidParameter> three = {E1, E2, eta2};
  static const std::vector<SolidParameter> fluid = {E1, eta2, E3, eta3};
  static const std::vector<SolidParameter> two_kelvin = {E1, E2, eta2, E3, eta3};
  static const std::vector<SolidParameter> three_kelvin = {E1, E2, eta2, E3, eta3, E4, eta4};
  static const std::vector<SolidParameter> four_kelvin = {E1, E2,   eta2, E3,  eta3,
                                                          E4, eta4, E5,   eta5};
  static const std::vector<SolidParameter> fractional = {E1, E2, eta2, {"beta", Is::exponent}};
  switch (kind) {
    case SolidKind::three_element:
      return three;
    case SolidKind::four_element_fluid:
      return fluid;
    case SolidKind::two_kelvin:
      return two_kelvin;
    case SolidKind::three_kelvin:
      return three_kelvin;
    case SolidKind::four_kelvin:
      return four_kelvin;
    case SolidKind::fractional:
      break;
  }
  return fractional;
}

std::size_t kelvin_branches(SolidKind kind) {
  const auto at = std::ranges::find(kKelvin, kind);
  return at == kKelvin.end() ? 0 : static_cast<std::size_t>(at - kKelvin.begin()) + 1;
}

std::optional<SolidKind> one_branch_more(SolidKind kind) {
  const std::size_t branches = kelvin_branches(kind);
  return branches > 0 && branches < kKelvin.size() ? std::optional(kKelvin[branches])
                                                   : std::nullopt;
}

SolidKind solid_kind(const std::string& name) {
  for (const auto& [kind, text] : kNames) {
    if (name == text) {
      return kind;
    }
  }
  throw InputError("solid", "\"" + name + "\" is not a family of solids",
                   "give three-element, four-element-fluid, two-kelvin, three-kelvin, four-kelvin "
                   "or fractional");
}

std::string name_of(SolidKind kind) {
  for (const auto& [known, text] : kNames) {
    if (kind == known) {
      return text;
    }
  }
  return {};
}

}  // namespace kolsky
