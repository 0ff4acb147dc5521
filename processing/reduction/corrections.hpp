#pragma once

#include <span>

#include "processing/base/bench.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Sets a reduction's stress from its forces, engineering. With rho the specimen's density, a its
/// radius, h its length, e the compressive strain's rate and e' that rate's:
///   radial  rho a^2 (e'/8 + e^2/16) is taken off (an incompressible cylinder),
///   axial   rho h^2 (e' - e^2)/12 off the mean of both faces; off the back face -1/6, off the
///           front face +1/3 of rho h^2 (e' - e^2) (Davies and Hunter's form, of a back face at
///           rest) and, as the back face moves, -1/2 and +1/2 of rho h times its acceleration: what
///           is left is the mean over the specimen, whichever face it is from (the back, whatever
///           is asked for, where waves were separated by equilibrium: both forces are its),
///   friction  the stress is divided by 1 + mu d / (3 h), d and h as they are at that strain.
/// @param rate_of_front_per_s  velocity of the front face over h, as long as the histories; the
///   back face's follows from it and the strain rate
/// @throws InputError where inertia is asked for and the specimen's density is not filed
void set_stress(StressFrom from, const Corrections& corrections, const Specimen& specimen,
                std::span<const double> rate_of_front_per_s, Reduction& reduction);

}  // namespace kolsky
