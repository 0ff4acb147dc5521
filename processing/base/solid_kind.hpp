#pragma once

#include <optional>
#include <string>
#include <vector>

namespace kolsky {

/// Families of linear solids and fluids that waves can be carried by and a spectrum of J fitted
/// with. All parameters are positive.
enum class SolidKind {
  three_element,       ///< J = 1/E1 + 1/(E2 + s eta2)                            E1, E2, eta2
  four_element_fluid,  ///< J = 1/E1 + 1/(s eta2) + 1/(E3 + s eta3)               E1, eta2, E3, eta3
  two_kelvin,    ///< J = 1/E1 + 1/(E2 + s eta2) + 1/(E3 + s eta3)          E1, E2, eta2, E3, eta3
  three_kelvin,  ///< and + 1/(E4 + s eta4)
  four_kelvin,   ///< and + 1/(E5 + s eta5)
  fractional,    ///< J = 1/E1 + 1/(E2 (1 + (s eta2/E2)^beta))              E1, E2, eta2, beta
};

/// One parameter of a family.
struct SolidParameter {
  enum class Is { modulus, viscosity, exponent };
  std::string name;  ///< with its unit, as in a material file: "E1_Pa"
  Is is = Is::modulus;

  /// Whether J falls as it grows: a solid stiffer by a factor has all these larger by it.
  [[nodiscard]] bool stiffens() const { return is != Is::exponent; }
};

/// The spring that a wave's front sees is the first; a branch's dashpot follows its spring.
[[nodiscard]] const std::vector<SolidParameter>& parameters_of(SolidKind kind);

/// How many Kelvin branches it has beside its spring; 0 where it is more than those.
[[nodiscard]] std::size_t kelvin_branches(SolidKind kind);
/// The family with one Kelvin branch more; none of a fluid, of a fractional branch, or beyond four.
[[nodiscard]] std::optional<SolidKind> one_branch_more(SolidKind kind);

/// @throws InputError for any other name: three-element, four-element-fluid, two-kelvin,
/// three-kelvin, four-kelvin, fractional
[[nodiscard]] SolidKind solid_kind(const std::string& name);
[[nodiscard]] std::string name_of(SolidKind kind);

}  // namespace kolsky
