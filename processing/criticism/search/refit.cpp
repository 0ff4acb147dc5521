#include "processing/criticism/search/refit.hpp"

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

double lead(const Refit& ahead, const Refit& behind) {
  const double apart = (ahead.evidence - behind.evidence) / std::max(ahead.doubt, behind.doubt);
  return square_on_noise(apart, std::min(ahead.known, behind.known));
}

}  // namespace kolsky
