#include "processing/criticism/search/search_ground.hpp"

#include "processing/criticism/fitting/astray.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

SearchGround::SearchGround(Study& of, const Studied& fitted)
    : study(of),
      base(fitted),
      candidates(candidates_for(fitted, of.campaign())),
      directions(candidates.size()),
      may_be_astray(astray(fitted.model, fitted.misfit)) {
  study.executor().run(candidates.size(), [&](std::size_t i, std::size_t worker) {
    directions[i] = direction_of(candidates[i], base, study, worker);
  });
}

bool SearchGround::far_off() const {
  return base.misfit.chi2_reduced > kFarOff;
}

double SearchGround::evidence_of(std::size_t candidate) const {
  const Direction& direction = directions[candidate];
  if (direction.freedom <= 0.0) {
    return 0.0;
  }
  return equivalent_square(
      log_gain_tail(direction.gain, direction.freedom, candidates[candidate].signs));
}

}  // namespace kolsky
