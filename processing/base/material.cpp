#include "processing/base/material.hpp"

#include <cmath>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

constexpr Range kModulus{1e5, kStiffest, "Pa", "give pascals: 5.66 GPa is 5.66e9"};
constexpr Range kViscosity{1e-2, kStiffest, "Pa s", "give pascal seconds: 1.81 MPa s is 1.81e6"};
constexpr Range kRetardation{1e-7, 10.0, "s", ""};
constexpr Range kBand{1.0, 1e9, "Hz", "give hertz"};
constexpr Range kTemperature{1.0, 2000.0, "K", "give kelvins: 20 degrees Celsius are 293.15"};
constexpr Range kExponent{
    0.01, 1.0, "", "a solid that creeps has one from 0 to 1: file three elements in place of 1"};
constexpr double kRounding = 1e-6;

const Range& range_of(const SolidParameter& parameter) {
  switch (parameter.is) {
    case SolidParameter::Is::modulus:
      return kModulus;
    case SolidParameter::Is::viscosity:
      return kViscosity;
    case SolidParameter::Is::exponent:
      break;
  }
  return kExponent;
}

/// Of the branch whose dashpot is at `place`, behind its spring.
void require_retardation(const std::string& name, double eta_Pa_s, double E_Pa) {
  const double retardation_s = eta_Pa_s / E_Pa;
  if (retardation_s < kRetardation.least || retardation_s > kRetardation.most) {
    const std::string branch = name.substr(3, 1);
    throw InputError(name,
                     "makes a retardation time eta" + branch + "/E" + branch + " of " +
                         in_words(retardation_s, kRetardation.unit) + ", outside " +
                         in_words(kRetardation.least, "") + " to " +
                         in_words(kRetardation.most, kRetardation.unit),
                     "check its unit: 2.86 kPa s is 2860, 1.81 MPa s is 1.81e6");
  }
}

void require_three_elements(const Material& material) {
  if (material.solid != SolidKind::three_element) {
    throw InputError("solid", "is " + name_of(material.solid) + " where only three elements serve",
                     "give a material file of three elements");
  }
}

void require_parameters(const Material& material) {
  using Is = SolidParameter::Is;
  const auto& family = parameters_of(material.solid);
  if (material.parameters.size() != family.size()) {
    throw InputError("solid",
                     "of " + name_of(material.solid) + " has " + std::to_string(family.size()) +
                         " parameters, not " + std::to_string(material.parameters.size()),
                     "give each of that family");
  }
  for (std::size_t i = 0; i < family.size(); ++i) {
    require_in_range(family[i].name, material.parameters[i], range_of(family[i]));
  }
  // A dashpot next to the first spring is no branch but flows by itself.
  for (std::size_t i = 2; i < family.size(); ++i) {
    if (family[i].is == Is::viscosity) {
      require_retardation(family[i].name, material.parameters[i], material.parameters[i - 1]);
    }
  }
}

std::string names_of(const std::vector<SolidParameter>& family) {
  std::string text;
  for (std::size_t i = 0; i < family.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < family.size() ? ", " : " and ") + family[i].name;
  }
  return text;
}

void require_covariance(const std::vector<double>& numbers,
                        const std::vector<SolidParameter>& family) {
  const std::size_t parameters = family.size();
  if (numbers.size() != parameters * parameters) {
    throw InputError(
        "covariance", "has " + std::to_string(numbers.size()) + " numbers",
        "give " + std::to_string(parameters * parameters) + ", row by row, of " + names_of(family));
  }
  const auto at = [&](std::size_t i, std::size_t j) { return numbers.at(i * parameters + j); };
  for (std::size_t i = 0; i < parameters; ++i) {
    for (std::size_t j = 0; j < parameters; ++j) {
      const double most = std::sqrt(at(i, i) * at(j, j));
      if (!(std::abs(at(i, j) - at(j, i)) <= kRounding * most &&
            std::abs(at(i, j)) <= most * (1.0 + kRounding) && std::isfinite(most))) {
        throw InputError("covariance", "is not a covariance",
                         "give a symmetric matrix with no correlation above 1");
      }
    }
  }
}

}  // namespace

Measured& Material::E2_Pa() {
  require_three_elements(*this);
  return parameters[1];
}

const Measured& Material::E2_Pa() const {
  require_three_elements(*this);
  return parameters[1];
}

Measured& Material::eta2_Pa_s() {
  require_three_elements(*this);
  return parameters[2];
}

const Measured& Material::eta2_Pa_s() const {
  require_three_elements(*this);
  return parameters[2];
}

Material three_element_material(const Measured& density_kg_m3, const Measured& poisson_ratio,
                                const Measured& E1_Pa, const Measured& E2_Pa,
                                const Measured& eta2_Pa_s, const std::string& source) {
  Material material;
  material.density_kg_m3 = density_kg_m3;
  material.poisson_ratio = poisson_ratio;
  material.parameters = {E1_Pa, E2_Pa, eta2_Pa_s};
  material.source = source;
  return material;
}

Material paper_pmma() {
  return three_element_material({1180.0}, {0.360}, {5.66e9}, {37.0e9}, {1.81e6},
                                "the paper's PMMA (Table 4, row 1)");
}

Material paper_golf_core() {
  return three_element_material({1140.0}, {0.376}, {121e6}, {143e6}, {2860.0},
                                "paper, Table 3: polybutadiene");
}

Material paper_golf_cover() {
  return three_element_material({960.0}, {0.319}, {987e6}, {452e6}, {6020.0},
                                "paper, Table 3: ionomer");
}

std::vector<double> values_of(const std::vector<Measured>& numbers) {
  return {numbers.begin(), numbers.end()};
}

double relaxed_modulus_Pa(const Material& material) {
  const auto& family = parameters_of(material.solid);
  double J_per_Pa = 0.0;
  for (std::size_t i = 0; i < family.size(); ++i) {
    if (family[i].is == SolidParameter::Is::modulus) {
      J_per_Pa += 1.0 / material.parameters[i];
    }
  }
  return 1.0 / J_per_Pa;
}

void check(const Material& material) {
  require_in_range("density_kg_m3", material.density_kg_m3, ranges::kDensity);
  require_in_range("poisson_ratio", material.poisson_ratio, ranges::kPoissonRatio);
  require_parameters(material);
  if (material.covariance) {
    require_covariance(*material.covariance, parameters_of(material.solid));
  }
  if (material.identified && material.identified->band_limit_Hz) {
    require_in_range("identified.band_limit_Hz", {*material.identified->band_limit_Hz}, kBand);
  }
  if (material.identified && material.identified->temperature_K) {
    require_in_range("identified.temperature_K", {*material.identified->temperature_K},
                     kTemperature);
  }
}

}  // namespace kolsky
