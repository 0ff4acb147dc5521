#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "processing/waves/compliance.hpp"

namespace kolsky {

/// Families of linear solids and fluids that a spectrum of J can be fitted with. All parameters are
/// positive.
enum class SolidKind {
  three_element,       ///< J = 1/E1 + 1/(E2 + s eta2)                            E1, E2, eta2
  four_element_fluid,  ///< J = 1/E1 + 1/(s eta2) + 1/(E3 + s eta3)               E1, eta2, E3, eta3
  two_kelvin,    ///< J = 1/E1 + 1/(E2 + s eta2) + 1/(E3 + s eta3)          E1, E2, eta2, E3, eta3
  three_kelvin,  ///< and + 1/(E4 + s eta4)
  fractional,    ///< J = 1/E1 + 1/(E2 (1 + (s eta2/E2)^beta))              E1, E2, eta2, beta
};

/// One parameter of a family.
struct SolidParameter {
  std::string name;  ///< with its unit, as in a material file: "E1_Pa"
};

[[nodiscard]] const std::vector<SolidParameter>& parameters_of(SolidKind kind);

/// The solid with these parameters, in the order of `parameters_of`.
[[nodiscard]] std::unique_ptr<const Compliance> make_solid(SolidKind kind,
                                                           std::span<const double> parameters);

/// d log J / d log p along a path of s, by parameter.
[[nodiscard]] std::vector<std::vector<Complex>> log_slopes(SolidKind kind,
                                                           std::span<const double> parameters,
                                                           std::span<const Complex> path);

/// @throws InputError for any other name: three-element, four-element-fluid, two-kelvin,
/// three-kelvin, fractional
[[nodiscard]] SolidKind solid_kind(const std::string& name);
[[nodiscard]] std::string name_of(SolidKind kind);

}  // namespace kolsky
