#pragma once

#include <span>

#include "processing/base/bench.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Sets a reduction's stress from its forces, engineering. With rho the specimen's density, a its
/// radius and h its length before the shot, e its engineering compressive strain, e' and e'' that
/// strain's rate and growth, nu Poisson's ratio (0.5 where none is filed):
///   radial  rho (nu a)^2 / 2 (1 - e)^(-2 - 2 nu) (e'' + (1 + nu) e'^2 / (1 - e)) is taken off: the
///           work that widening a (1 - e)^-nu takes; rho a^2 (e''/8 + 3 e'^2/16) as e goes to 0
///           where nu is 0.5,
///   axial   rho h^2 e''/12 off the mean of both faces; off the back face -1/6, off the front face
///           +1/3 of rho h^2 e'' (of a back face at rest) and, as the back face moves, -1/2 and
///           +1/2 of rho h times its acceleration: what is left is the mean over the specimen,
///           whichever face it is from (the back, whatever is asked for, where waves were
///           separated by equilibrium: both forces are its),
/// which for nu = 0.5 are the reference's rho a^2 (D'/8 + D^2/16) and rho h^2 (D' - D^2)/12 of the
/// true rate D = e'/(1 - e), sizes and stress as they are at that strain;
///   friction  a compressive stress is divided by 1 + mu d / (3 h), d and h as they are at that
///           strain: of faces on which the specimen slides outwards, up to the strain's top.
/// @param rate_of_front_per_s  velocity of the front face over h, as long as the histories; the
///   back face's follows from it and the strain rate
/// @throws InputError where inertia is asked for and the specimen's density is not filed
void set_stress(StressFrom from, const Corrections& corrections, const Specimen& specimen,
                std::span<const double> rate_of_front_per_s, Reduction& reduction);

}  // namespace kolsky
