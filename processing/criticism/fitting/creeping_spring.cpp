#include "processing/criticism/fitting/creeping_spring.hpp"

#include <cmath>

namespace kolsky {

CreepingSpring::CreepingSpring(const Solid& solid, double period_s) {
  double at_once_per_Pa = 1.0 / solid.E1_Pa;
  const auto add = [&](double D_per_Pa, double tau_s) {
    const double steps = period_s / tau_s;
    const double faded = -std::expm1(-steps);
    const Element element{1.0 - faded, D_per_Pa * (faded / steps - (1.0 - faded)),
                          D_per_Pa * (1.0 - faded / steps)};
    at_once_per_Pa += element.from_new;
    elements_.push_back(element);
  };
  add(1.0 / solid.E2_Pa, solid.eta2_Pa_s / solid.E2_Pa);
  for (const Solid::Relaxation& relaxation : solid.relaxations) {
    add(relaxation.D_per_Pa, relaxation.tau_s);
  }
  at_once_Pa_ = 1.0 / at_once_per_Pa;
}

}  // namespace kolsky
