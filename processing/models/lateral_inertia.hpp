#pragma once

#include "processing/models/scene.hpp"

namespace kolsky {

/// Stress that a specimen's section takes to move outwards, per unit strain: m s^2/8, of
/// `stress += m (strain''/8 + strain'^2/16)`. Where waves cross the section that is the first term
/// of a series in (omega a/c)^2: a cylinder strained alike along all its length, whose faces slide
/// freely, takes
///   4 (j - kappa) / ((1 - nu) (J0 - m' K)),   j = (1 - J0)/X,  kappa = (1 - K)/X,
///   J0 = J0(sqrt X),  K = 2 J1(sqrt X)/sqrt X,  m' = (1 - 2 nu)/(2 (1 - nu)),
///   X = (omega a/c)^2 = -rho a^2 s^2 J (1 + nu)(1 - 2 nu)/(1 - nu)
/// times as much, by the equations of motion with nothing pressing on its lateral surface.
/// @param J_per_Pa  the material's at s
[[nodiscard]] Complex lateral_stress_Pa(const SpecimenScene& specimen, Complex J_per_Pa, Complex s);

}  // namespace kolsky
