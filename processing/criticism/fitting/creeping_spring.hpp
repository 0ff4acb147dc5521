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
  [[nodiscard]] double stress_at(double strain) const {
    return (strain - strain_at_rest_) * at_once_Pa_;
  }
  /// The strain of the next step without stress.
  [[nodiscard]] double strain_at_rest() const { return strain_at_rest_; }

  void advance(double stress_Pa) {
    strain_at_rest_ = 0.0;
    for (Element& element : elements_) {
      element.strain = element.at_rest + element.from_new * stress_Pa;
      element.at_rest = element.keeps * element.strain + element.from_old * stress_Pa;
      strain_at_rest_ += element.at_rest;
    }
  }

 private:
  struct Element {
    double keeps;     ///< of its strain, over a step
    double from_old;  ///< strain for the stress before it, 1/Pa
    double from_new;
    double strain = 0.0;
    double at_rest = 0.0;  ///< its strain at the next step, without stress there
  };

  double at_once_Pa_;  ///< stress per strain beyond that at rest
  double strain_at_rest_ = 0.0;
  std::vector<Element> elements_;
};

}  // namespace kolsky
