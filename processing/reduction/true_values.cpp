#include "processing/reduction/true_values.hpp"

#include <cmath>
#include <limits>

namespace kolsky {

std::vector<double> true_strain(const Reduction& reduction) {
  std::vector<double> strains;
  strains.reserve(reduction.strain.size());
  for (const double strain : reduction.strain) {
    strains.push_back(strain < 1.0 ? -std::log1p(-strain)
                                   : std::numeric_limits<double>::quiet_NaN());
  }
  return strains;
}

std::vector<double> true_stress_Pa(const Reduction& reduction) {
  std::vector<double> stresses;
  stresses.reserve(reduction.stress_Pa.size());
  for (std::size_t i = 0; i < reduction.stress_Pa.size(); ++i) {
    const double left = 1.0 - reduction.strain[i];
    stresses.push_back(left > 0.0 ? reduction.stress_Pa[i] * left
                                  : std::numeric_limits<double>::quiet_NaN());
  }
  return stresses;
}

}  // namespace kolsky
