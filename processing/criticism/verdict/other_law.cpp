#include "processing/criticism/verdict/other_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/departure.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

bool is_of_law(const EffectUse& use) {
  return use.effect->about().stage == Stage::specimen && !has_formula(use);
}

/// What the departure that explains most gains over the noise, to first order.
double best_departure(Study& study, const Studied& studied, double noise) {
  const Departure departure(study, studied);
  const Direction all = direction_of({.use = null_use(departure)}, studied, study);
  double best = 0.0;
  for (Eigen::Index i = 0; i < all.pull.size(); ++i) {
    const double power = all.information(i, i);
    // What the model takes up all of is left with rounding.
    constexpr double kResolved = 1e-4;
    if (power > kResolved * all.unprojected(i, i)) {
      best = std::max(best, all.pull[i] * all.pull[i] / power / noise);
    }
  }
  return best;
}

}  // namespace

std::optional<OtherLaw> other_law_in_place_of(Study& study, const Studied& current,
                                              const std::vector<std::string>& effects) {
  const auto use_of = [&](const std::string& id) -> const EffectUse& {
    return *current.model.find(id);
  };
  const auto law =
      std::ranges::find_if(effects, [&](const std::string& id) { return is_of_law(use_of(id)); });
  if (law == effects.end()) {
    return std::nullopt;
  }
  // In the noise that is frozen now, as what it is held against.
  const Studied here = changed(study, current, current.model);
  const double noise = noise_of(here.misfit, study.campaign().shots.size());
  for (const std::string& id : effects) {
    if (is_of_law(use_of(id)) || may_be_its_formula(use_of(id))) {
      continue;
    }
    Studied left = without(study, here, id);
    if (evidence(left, here, noise) - best_departure(study, left, noise) < kTie) {
      return OtherLaw{*law, id, std::move(left)};
    }
  }
  return std::nullopt;
}

std::string other_law_text(const OtherLaw& other) {
  return fmt::format(
      "beside {} a specimen that departs from its law does as well as {}, and no effect of the "
      "library is that: it may soften as it warms, level off, or not come back",
      other.law, other.claim);
}

}  // namespace kolsky
