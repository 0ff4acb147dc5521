#pragma once

#include <string>
#include <vector>

#include "processing/base/material.hpp"

namespace kolsky::impact {

/// How a uniaxial law E(t) with one Poisson's ratio is read in three dimensions.
enum class Reading {
  full,       ///< G and K relax as E does, Poisson's ratio constant
  bulk_E1,    ///< K = E1/3(1-2nu) elastic, G(t) = E(t)/2(1+nu)
  bulk_Einf,  ///< K = Einf/3(1-2nu) elastic, G(t) = E(t)/2(1+nu)
  exact,      ///< K = E1/3(1-2nu) elastic, G(t) such that the uniaxial J(t) is kept
};

/// "full", "bulk-E1", "bulk-Einf", "exact".
[[nodiscard]] std::string name_of(Reading reading);
/// @throws InputError at `place` for any other name
[[nodiscard]] Reading reading_named(const std::string& name, const std::string& place);

/// A Kelvin unit of a uniaxial creep law: J += compliance / (1 + i w time).
struct KelvinUnit {
  double compliance_per_Pa = 0.0;
  double time_s = 0.0;
};

/// A uniaxial linear solid by its creep: J = 1/E1 + sum of Kelvin units. Any number of units; none
/// is an elastic solid.
struct CreepLaw {
  double instantaneous_per_Pa = 0.0;
  std::vector<KelvinUnit> units;
};

/// One Maxwell arm of a relaxation E(t) = relaxed + sum modulus e^(-t/time).
struct MaxwellArm {
  double modulus_Pa = 0.0;
  double time_s = 0.0;
};

struct RelaxationLaw {
  double relaxed_Pa = 0.0;
  std::vector<MaxwellArm> arms;

  [[nodiscard]] double instantaneous_Pa() const;
};

/// The same solid by its relaxation: the zeros of J(s) between its poles, and the residues there.
/// Units of no compliance fall away and units of equal time become one.
/// @throws InputError unless every number is positive (compliances may be 0)
[[nodiscard]] RelaxationLaw relaxation_of(const CreepLaw& creep);

/// The creep of a material file, with a further Kelvin unit where `second` has a compliance.
/// @throws InputError at "solid": a family that is no chain of Kelvin units
[[nodiscard]] CreepLaw creep_of(const Material& material, KelvinUnit second = {});

/// Which stress the linear law gives, from Hencky's strain. They part with the change of volume, at
/// 51 m/s by about a hundredth of the peak force.
enum class FiniteStrain {
  kirchhoff,  ///< per undeformed area: hyperelastic where nothing relaxes, energy is a state
  cauchy,     ///< per deformed area, as hypoelastic codes integrate it; not quite conservative
};

/// "kirchhoff", "cauchy". @throws InputError at `place` for any other name
[[nodiscard]] FiniteStrain finite_strain_named(const std::string& name, const std::string& place);
[[nodiscard]] std::string name_of(FiniteStrain law);

/// One Maxwell arm in three dimensions.
struct SolidArm {
  double shear_Pa = 0.0;
  double bulk_Pa = 0.0;
  double time_s = 0.0;
};

/// An isotropic solid, linear viscoelastic in Hencky's strain: deviatoric stress
/// 2 G(t) * d[(1 + nonlinearity x equivalent strain) deviatoric strain], mean stress K(t) * d[ln
/// J].
struct Solid {
  double density_kg_m3 = 0.0;
  double shear_relaxed_Pa = 0.0;
  double bulk_relaxed_Pa = 0.0;
  std::vector<SolidArm> arms;  ///< at most six
  double nonlinearity = 0.0;   ///< b; 0 is linear
  FiniteStrain law = FiniteStrain::kirchhoff;

  [[nodiscard]] double shear_instantaneous_Pa() const;
  [[nodiscard]] double bulk_instantaneous_Pa() const;
  /// E / (1 - nu^2) once relaxed: of a half-space under pressure.
  [[nodiscard]] double plane_modulus_relaxed_Pa() const;
  /// Equivalent strain from which on the deviatoric stress falls, 1 / (2 |b|) of a solid that
  /// softens: nothing holds its shape there. Of others, infinite.
  [[nodiscard]] double falls_beyond_strain() const;
  /// Of pressure waves at the front, undeformed.
  [[nodiscard]] double fastest_wave_m_per_s() const;
};

/// @throws InputError, place "poisson_ratio", "E1_Pa", ...: numbers that are not positive, a ratio
/// outside
///   [0, 0.5), a reading in which some modulus would not be passive
[[nodiscard]] Solid solid_of(double density_kg_m3, double poisson_ratio, const CreepLaw& creep,
                             Reading reading);
[[nodiscard]] Solid solid_of(const Material& material, Reading reading);
[[nodiscard]] Solid elastic_solid(double density_kg_m3, double youngs_modulus_Pa,
                                  double poisson_ratio);

}  // namespace kolsky::impact
