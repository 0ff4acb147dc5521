#include "processing/criticism/search/admission.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

/// A strength that is less than its own deviation is none, whatever fits better with it. (That of a
/// relaxation is as uncertain where its time is near the material's own: see beyond_the_record.)
bool stands_out(const Refit& refit, const Candidate& candidate) {
  const EffectUse* use = refit.studied.model.find(candidate.id());
  const auto& parameters = candidate.use.effect->about().parameters;
  const auto moving =
      std::ranges::count_if(parameters, [](const EffectParameter& own) { return !own.chosen; });
  if (use == nullptr || use->per_shot || candidate.frees_prior || moving != 1 ||
      parameters.front().is_switch) {
    return true;
  }
  const ModelValue& own = use->values.front();
  return std::abs(own.value - parameters.front().null_value) >= own.sd;
}

/// A relaxation much slower than the record, or quicker than a sample, is another effect's limit
/// (a dashpot, a spring) that it only imitates. So is one whose strength and time grow together
/// without end, which shows in both being less than their own deviations, and one that has taken
/// the material's own place, whose branch stands in for a dashpot or for what is slow: it is slower
/// than the record by far, or than a third of it and of a strength that is less than its deviation.
/// A strength alone is as uncertain where the time is near that of the material's own branch, from
/// which it is told by a little only.
bool beyond_the_record(const Studied& studied, const Candidate& candidate, Study& study) {
  const EffectUse* use = studied.model.find(candidate.id());
  const auto& parameters = candidate.use.effect->about().parameters;
  constexpr double kMuchSlower = 5.0;
  const double period_s = study.residuals().judged_period_s();
  const double record_s = period_s * static_cast<double>(study.residuals().band().judged);
  const OwnBranch beside = own_branch(studied.model, candidate.use.effect->about().id);
  constexpr double kSlow = 0.3;  // shows as a dashpot only
  if (beside.time_s > (beside.strength_known ? kMuchSlower : kSlow) * record_s) {
    return true;
  }
  bool timeless = false;
  bool unbounded = false;
  for (std::size_t p = 0; use != nullptr && p < parameters.size(); ++p) {
    const ModelValue& own = use->values[p];
    if (!parameters[p].auxiliary()) {
      unbounded = unbounded || std::abs(own.value - parameters[p].null_value) < own.sd;
    } else if (parameters[p].unit == "s") {
      timeless = timeless || own.value < own.sd;
      if (own.value > kMuchSlower * record_s || own.value < 0.5 * study.campaign().period_s) {
        return true;
      }
    }
  }
  return timeless && unbounded;
}

}  // namespace

bool fits_the_signal(const Refit& refit, const Studied& base) {
  constexpr double kShare = 0.5;
  const ModelFit& fit = refit.studied.fit;
  return base.fit.objective() - fit.penalty - refit.chi2_in_base_noise >=
         kShare * (base.fit.objective() - fit.objective());
}

bool explains(const Refit& refit, const SearchGround& ground) {
  const Candidate& candidate = ground.candidates[refit.candidate];
  return std::isfinite(refit.studied.fit.objective()) &&
         !beyond_the_record(refit.studied, candidate, ground.study) &&
         stands_out(refit, candidate) && fits_the_signal(refit, ground.base) &&
         allowed_by_formula(*refit.studied.model.find(candidate.id()));
}

bool confirm_own_strengths(Refit& refit, const SearchGround& ground, SlowChances& slow) {
  const std::string id = ground.candidates[refit.candidate].id();
  const auto by_itself = [&](Claim claim) {
    return own_strengths_confirmed(refit.studied, id, ground.study.campaign(), claim);
  };
  // By products first: slow noise takes longer to ask.
  if (refit.products && by_itself(Claim::fresh)) {
    return true;
  }
  if (refit.products && !by_itself(Claim::beyond_slow_noise)) {
    return false;
  }
  const SlowChance chance = slow.of(refit.candidate);
  if (slow_noise_excluded(chance.least(), Claim::fresh)) {
    refit.slow = chance;
    return true;
  }
  return !refit.products && by_itself(Claim::fresh);
}

}  // namespace kolsky
