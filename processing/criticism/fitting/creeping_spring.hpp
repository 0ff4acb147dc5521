#pragma once

#include <vector>

#include "processing/models/scene.hpp"

namespace kolsky {

/// A spring in series with Kelvin elements, step by step in time; stress is taken as straight from
/// step to step, which the elements follow exactly.
class CreepingSpring {
 public:
  CreepingSpring(const Solid& solid, double period_s);

  /// The stress [Pa] of the next step at this strain.
  [[nodiscard]] double stress_at(double strain) const;
  /// The strain of the next step without stress.
  [[nodiscard]] double strain_at_rest() const;
  void advance(double stress_Pa);

 private:
  struct Element {
    double keeps;     ///< of its strain, over a step
    double from_old;  ///< strain for the stress before it, 1/Pa
    double from_new;
    double strain = 0.0;
  };

  double at_once_per_Pa_;
  double stress_Pa_ = 0.0;
  std::vector<Element> elements_;
};

}  // namespace kolsky
