#include "processing/criticism/search/refit.hpp"

#include <algorithm>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

double share_of_pulses(const ModelFit& one, const Eigen::VectorXd& pulses_of_one,
                       const ModelFit& other, const Eigen::VectorXd& pulses_of_other) {
  const double all = (one.residual - other.residual).squaredNorm();
  if (pulses_of_one.size() == 0 || pulses_of_other.size() == 0 || all <= 0.0) {
    return 1.0;
  }
  return std::min(1.0, (pulses_of_one - pulses_of_other).squaredNorm() / all);
}

double lead(const Refit& ahead, const Refit& behind) {
  const double share =
      share_of_pulses(ahead.studied.fit, ahead.pulses, behind.studied.fit, behind.pulses);
  const double apart =
      share * (ahead.evidence - behind.evidence) / std::max(ahead.doubt, behind.doubt);
  return square_on_noise(apart, std::min(ahead.known, behind.known));
}

}  // namespace kolsky
