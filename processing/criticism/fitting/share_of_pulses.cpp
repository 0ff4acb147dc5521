#include "processing/criticism/fitting/share_of_pulses.hpp"

#include <algorithm>

namespace kolsky {

double share_of_pulses(const LeftByFit& one, const LeftByFit& other) {
  const double all = (one.records - other.records).squaredNorm();
  if (one.pulses.size() == 0 || other.pulses.size() == 0 || all <= 0.0) {
    return 1.0;
  }
  return std::min(1.0, (one.pulses - other.pulses).squaredNorm() / all);
}

}  // namespace kolsky
