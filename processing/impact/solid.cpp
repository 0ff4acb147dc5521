#include "processing/impact/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/impact/element_kernel.hpp"

namespace kolsky::impact {
namespace {

constexpr std::array kReadingNames = {"full", "bulk-E1", "bulk-Einf", "exact"};

void require_positive(const std::string& place, double value, const std::string& unit) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InputError(place, in_words(value, unit) + " is not a passive solid's",
                     "give a positive number in " + unit);
  }
}

// Units in order of falling time, none empty, none twice.
std::vector<KelvinUnit> tidied(const CreepLaw& creep) {
  std::vector<KelvinUnit> units;
  for (const KelvinUnit& unit : creep.units) {
    if (unit.compliance_per_Pa == 0.0) {
      continue;
    }
    require_positive("relaxation compliance", unit.compliance_per_Pa, "1/Pa");
    require_positive("relaxation time", unit.time_s, "s");
    units.push_back(unit);
  }
  std::sort(units.begin(), units.end(),
            [](const KelvinUnit& a, const KelvinUnit& b) { return a.time_s > b.time_s; });
  std::vector<KelvinUnit> merged;
  for (const KelvinUnit& unit : units) {
    if (!merged.empty() && merged.back().time_s - unit.time_s <= 1e-12 * unit.time_s) {
      merged.back().compliance_per_Pa += unit.compliance_per_Pa;
    } else {
      merged.push_back(unit);
    }
  }
  return merged;
}

// J(-rate) and its derivative by s there.
struct ComplianceAt {
  double value;
  double slope;
};

ComplianceAt compliance_at(double instantaneous, const std::vector<KelvinUnit>& units,
                           double rate) {
  ComplianceAt J{instantaneous, 0.0};
  for (const KelvinUnit& unit : units) {
    const double factor = 1.0 / (1.0 - rate * unit.time_s);
    J.value += unit.compliance_per_Pa * factor;
    J.slope -= unit.compliance_per_Pa * unit.time_s * factor * factor;
  }
  return J;
}

// J falls from +infinity... to -infinity just above each pole, and grows from there to the next.
double zero_between(double instantaneous, const std::vector<KelvinUnit>& units, double low,
                    double high) {
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (compliance_at(instantaneous, units, middle).value < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double bulk_of(double E_Pa, double poisson_ratio) {
  return E_Pa / (3.0 * (1.0 - 2.0 * poisson_ratio));
}

Solid by_constant_ratio(const RelaxationLaw& law, double nu) {
  const double shear = 1.0 / (2.0 * (1.0 + nu));
  Solid solid;
  solid.shear_relaxed_Pa = law.relaxed_Pa * shear;
  solid.bulk_relaxed_Pa = bulk_of(law.relaxed_Pa, nu);
  for (const MaxwellArm& arm : law.arms) {
    solid.arms.push_back({arm.modulus_Pa * shear, bulk_of(arm.modulus_Pa, nu), arm.time_s});
  }
  return solid;
}

Solid with_elastic_bulk(const RelaxationLaw& law, double nu, double bulk_Pa) {
  Solid solid = by_constant_ratio(law, nu);
  solid.bulk_relaxed_Pa = bulk_Pa;
  for (SolidArm& arm : solid.arms) {
    arm.bulk_Pa = 0.0;
  }
  return solid;
}

// J = 1/(3 G) + 1/(9 K): the shear's creep law is 3 (J - 1/(9 K)).
Solid keeping_compliance(const CreepLaw& creep, double nu) {
  const double bulk_Pa = bulk_of(1.0 / creep.instantaneous_per_Pa, nu);
  CreepLaw shear;
  shear.instantaneous_per_Pa = 3.0 * (creep.instantaneous_per_Pa - 1.0 / (9.0 * bulk_Pa));
  for (const KelvinUnit& unit : creep.units) {
    shear.units.push_back({3.0 * unit.compliance_per_Pa, unit.time_s});
  }
  const RelaxationLaw law = relaxation_of(shear);
  Solid solid;
  solid.shear_relaxed_Pa = law.relaxed_Pa;
  solid.bulk_relaxed_Pa = bulk_Pa;
  for (const MaxwellArm& arm : law.arms) {
    solid.arms.push_back({arm.modulus_Pa, 0.0, arm.time_s});
  }
  return solid;
}

Solid read_in(const CreepLaw& creep, double nu, Reading reading) {
  if (reading == Reading::exact) {
    return keeping_compliance(creep, nu);
  }
  const RelaxationLaw law = relaxation_of(creep);
  switch (reading) {
    case Reading::bulk_E1:
      return with_elastic_bulk(law, nu, bulk_of(law.instantaneous_Pa(), nu));
    case Reading::bulk_Einf:
      return with_elastic_bulk(law, nu, bulk_of(law.relaxed_Pa, nu));
    default:
      return by_constant_ratio(law, nu);
  }
}

}  // namespace

std::string name_of(Reading reading) {
  return kReadingNames.at(static_cast<std::size_t>(reading));
}

Reading reading_named(const std::string& name, const std::string& place) {
  const auto* const found = std::find(kReadingNames.begin(), kReadingNames.end(), name);
  if (found == kReadingNames.end()) {
    throw InputError(place, "\"" + name + "\" is not a reading",
                     "give full, bulk-E1, bulk-Einf or exact");
  }
  return static_cast<Reading>(found - kReadingNames.begin());
}

FiniteStrain finite_strain_named(const std::string& name, const std::string& place) {
  if (name != "kirchhoff" && name != "cauchy") {
    throw InputError(place, "\"" + name + "\" is not a finite-strain law",
                     "give kirchhoff or cauchy");
  }
  return name == "kirchhoff" ? FiniteStrain::kirchhoff : FiniteStrain::cauchy;
}

std::string name_of(FiniteStrain law) {
  return law == FiniteStrain::kirchhoff ? "kirchhoff" : "cauchy";
}

double RelaxationLaw::instantaneous_Pa() const {
  double modulus = relaxed_Pa;
  for (const MaxwellArm& arm : arms) {
    modulus += arm.modulus_Pa;
  }
  return modulus;
}

RelaxationLaw relaxation_of(const CreepLaw& creep) {
  require_positive("instantaneous compliance", creep.instantaneous_per_Pa, "1/Pa");
  const std::vector<KelvinUnit> units = tidied(creep);
  double relaxed_per_Pa = creep.instantaneous_per_Pa;
  double all_units = 0.0;
  for (const KelvinUnit& unit : units) {
    relaxed_per_Pa += unit.compliance_per_Pa;
    all_units += unit.compliance_per_Pa;
  }
  RelaxationLaw law;
  law.relaxed_Pa = 1.0 / relaxed_per_Pa;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const double low = 1.0 / units[i].time_s;
    // Past the last pole the sum of the units is at least -(all)/(rate x shortest time - 1).
    const double high = i + 1 < units.size()
                            ? 1.0 / units[i + 1].time_s
                            : (1.0 + all_units / creep.instantaneous_per_Pa) * low * (1.0 + 1e-9);
    const double rate = zero_between(creep.instantaneous_per_Pa, units, low, high);
    const double slope = compliance_at(creep.instantaneous_per_Pa, units, rate).slope;
    law.arms.push_back({-1.0 / (rate * slope), 1.0 / rate});
  }
  return law;
}

CreepLaw creep_of(const Material& material, KelvinUnit second) {
  if (material.solid == SolidKind::four_element_fluid || material.solid == SolidKind::fractional) {
    throw InputError("solid",
                     "is " + name_of(material.solid) +
                         ", and finite elements carry a spring and Kelvin units in line",
                     "file three-element, two-kelvin, three-kelvin or four-kelvin, as `kolsky "
                     "identify specimen --solid` fits them");
  }
  const auto& family = parameters_of(material.solid);
  for (std::size_t i = 0; i < family.size(); ++i) {
    require_positive(family[i].name, material.parameters[i],
                     family[i].is == SolidParameter::Is::modulus ? "Pa" : "Pa s");
  }
  const std::vector<double> p = values_of(material.parameters);
  CreepLaw creep{1.0 / p[0], {}};
  for (std::size_t i = 1; i < p.size(); i += 2) {
    creep.units.push_back({1.0 / p[i], p[i + 1] / p[i]});
  }
  creep.units.push_back(second);
  return creep;
}

double Solid::shear_instantaneous_Pa() const {
  double modulus = shear_relaxed_Pa;
  for (const SolidArm& arm : arms) {
    modulus += arm.shear_Pa;
  }
  return modulus;
}

double Solid::bulk_instantaneous_Pa() const {
  double modulus = bulk_relaxed_Pa;
  for (const SolidArm& arm : arms) {
    modulus += arm.bulk_Pa;
  }
  return modulus;
}

double Solid::plane_modulus_relaxed_Pa() const {
  const double G = shear_relaxed_Pa;
  const double K = bulk_relaxed_Pa;
  return 4.0 * G * (3.0 * K + G) / (3.0 * K + 4.0 * G);
}

double Solid::falls_beyond_strain() const {
  // (1 + b e) e is steepest at no strain and level here.
  return nonlinearity < 0.0 ? -0.5 / nonlinearity : std::numeric_limits<double>::infinity();
}

double Solid::fastest_wave_m_per_s() const {
  return std::sqrt((bulk_instantaneous_Pa() + 4.0 / 3.0 * shear_instantaneous_Pa()) /
                   density_kg_m3);
}

Solid solid_of(double density_kg_m3, double poisson_ratio, const CreepLaw& creep, Reading reading) {
  require_positive("density_kg_m3", density_kg_m3, "kg/m3");
  if (!(poisson_ratio >= 0.0 && poisson_ratio < 0.5)) {
    throw InputError("poisson_ratio", in_words(poisson_ratio, "") + " has no finite bulk modulus",
                     "give a ratio from 0 to below 0.5");
  }
  Solid solid = read_in(creep, poisson_ratio, reading);
  if (solid.arms.size() > static_cast<std::size_t>(kMostBranches)) {
    throw InputError("relaxations", "are more than the solver carries",
                     "give at most six relaxation times");
  }
  solid.density_kg_m3 = density_kg_m3;
  return solid;
}

Solid solid_of(const Material& material, Reading reading) {
  return solid_of(material.density_kg_m3, material.poisson_ratio, creep_of(material), reading);
}

Solid elastic_solid(double density_kg_m3, double youngs_modulus_Pa, double poisson_ratio) {
  require_positive("youngs_modulus_Pa", youngs_modulus_Pa, "Pa");
  return solid_of(density_kg_m3, poisson_ratio, {1.0 / youngs_modulus_Pa, {}}, Reading::full);
}

}  // namespace kolsky::impact
