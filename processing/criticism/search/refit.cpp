#include "processing/criticism/search/refit.hpp"

#include <algorithm>

#include "processing/criticism/fitting/share_of_pulses.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

double lead(const Refit& ahead, const Refit& behind) {
  const double share = share_of_pulses({ahead.studied.fit.residual, ahead.pulses},
                                       {behind.studied.fit.residual, behind.pulses});
  const double apart =
      share * (ahead.evidence - behind.evidence) / std::max(ahead.doubt, behind.doubt);
  return square_on_noise(apart, std::min(ahead.known, behind.known));
}

}  // namespace kolsky
