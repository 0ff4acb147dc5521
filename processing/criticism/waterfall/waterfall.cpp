#include "processing/criticism/waterfall/waterfall.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/comparing/shot_groups.hpp"
#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/record_parts.hpp"
#include "processing/criticism/search/candidate_table.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/search/confirmed_hum.hpp"
#include "processing/criticism/search/safeguards.hpp"

namespace kolsky {

namespace {

/// A choice between kinds: numbers that no fit moves, other than they were.
bool chosen_anew(const EffectUse& before, const EffectUse& after) {
  constexpr double kSame = 1e-9;  // as written into a file and read again
  bool other = false;
  for (std::size_t p = 0; p < after.values.size(); ++p) {
    if (before.values[p].free || after.values[p].free) {
      return false;
    }
    const double moved = std::abs(before.values[p].value - after.values[p].value);
    other = other || moved > kSame * std::abs(after.values[p].value);
  }
  return other;
}

bool holds(const Model& model, const EffectUse& use) {
  const EffectUse* own = model.find(use.id());
  if (own == nullptr) {
    return false;
  }
  const auto freed = [](const EffectUse& u) {
    return std::none_of(u.values.begin(), u.values.end(),
                        [](const ModelValue& value) { return value.prior_sd > 0.0; });
  };
  return (freed(*own) || !freed(use)) && !chosen_anew(*own, use);
}

/// A number of the bench, not what is only bounded by a prior, as a hum's amplitudes are.
bool only_filed(const EffectUse& use) {
  return !use.effect->about().each_gauge &&
         std::any_of(use.values.begin(), use.values.end(),
                     [](const ModelValue& value) { return value.prior_sd > 0.0; });
}

Studied best_of_two(Study& study, const Studied& own, const Studied& last) {
  // From what the last model knows, and from the model's own fit: a large misfit can lead either
  // astray.
  const Composition& composition = own.composition;
  WhiteResiduals& residuals = study.residuals();
  const std::vector<double> known = carry(last.composition, last.fit.theta, composition);
  residuals.freeze(composition, known);
  ModelFit near = fit_model(composition, residuals, study.executor(), known);
  ModelFit far = fit_model(composition, residuals, study.executor(), own.fit.theta);
  ModelFit fit = far.objective() < near.objective() ? std::move(far) : std::move(near);
  return study.refit({own.model, composition, std::move(fit), {}});
}

/// Every model fitted by itself, as `kolsky fit` does it; the last one's noise is what stays.
std::vector<Studied> own_fits(Study& study, const std::vector<LineageStep>& lineage) {
  std::vector<Studied> fits;
  for (const LineageStep& step : lineage) {
    study.residuals().believe_quiet();
    fits.push_back(study.fit(step.model));
  }
  return fits;
}

std::vector<MovedNumber> material_of(const Studied& studied) {
  const Model& model = studied.model;
  std::vector<MovedNumber> list;
  if (const EffectUse* specimen = model.find("three-element-specimen")) {
    list = numbers_of(*specimen, "");
  }
  if (const EffectUse* bar = model.find("three-element-bar")) {
    const auto own = numbers_of(*bar, model.kind == BenchKind::bar ? "" : "bar.");
    list.insert(list.end(), own.begin(), own.end());
  }
  for (MovedNumber& number : list) {
    number.sd *= widening(studied.misfit);
  }
  return list;
}

/// An effect's numbers; of a cosine and a sine, whose means over shots and gauges say nothing,
/// their amplitude.
std::vector<MovedNumber> strengths_of(const Studied& studied, const EffectUse& use) {
  std::vector<MovedNumber> list = numbers_of(use, "");
  if (use.effect->about().quadrature) {
    CandidateResult common;
    set_strength(studied, use.id(), common);
    list[0] = {common.parameter, common.unit, common.strength, common.sd};
    list.erase(list.begin() + 1);
  }
  return list;
}

double usual_rate(const Studied& last, const Campaign& campaign) {
  double peak = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    peak += shot.facts.peak_strain / static_cast<double>(campaign.shots.size());
  }
  return usual_strain_rate_per_s(peak, last.model, campaign.bench);
}

}  // namespace

std::vector<MovedNumber> numbers_of(const EffectUse& use, const std::string& prefix) {
  std::vector<MovedNumber> list;
  const auto& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    list.push_back(
        {prefix + parameters[p].name, parameters[p].unit, use.values[p].value, use.values[p].sd});
  }
  return list;
}

void take_drop(WaterfallStep& step, const LeftOnFolds& left, const LeftOnFolds* before,
               double residuals) {
  step.held_out = held_out_misfit(left.squares, left.penalty, residuals);
  if (before == nullptr) {
    return;
  }
  step.relief = before->penalty - left.penalty;
  const Certification certified = certification(before->squares, left.squares, step.relief);
  step.gain = certified.gain;
  step.better = certified.better;
}

double widening(const Misfit& misfit) {
  return std::sqrt(std::max(1.0, misfit.chi2_reduced));
}

bool far_from_fitting(const WaterfallStep& step, const Waterfall& fall) {
  constexpr double kFar = 10.0;
  return step.held_out > kFar * fall.floor;
}

double Waterfall::closed() const {
  if (steps.empty() || steps.front().held_out <= floor) {
    return 1.0;
  }
  return (steps.front().held_out - steps.back().held_out) / (steps.front().held_out - floor);
}

std::vector<LineageStep> lineage(const Model& first, const Model& last,
                                 const std::vector<std::string>& order) {
  std::vector<LineageStep> steps{{.effect = {}, .model = first}};
  for (const EffectUse& use : first.effects) {
    if (last.find(use.id()) == nullptr && !only_filed(use)) {
      Model model = steps.back().model;
      std::erase_if(model.effects, [&](const EffectUse& own) { return own.id() == use.id(); });
      steps.push_back({.effect = use.id(), .removed = true, .model = std::move(model)});
    }
  }
  std::vector<std::string> ids = order;
  for (const EffectUse& use : last.effects) {
    ids.push_back(use.id());
  }
  for (const std::string& id : ids) {
    const EffectUse* use = last.find(id);
    // Filed numbers within their deviations belong to every model of the bench.
    if (use == nullptr || only_filed(*use) || holds(steps.back().model, *use)) {
      continue;
    }
    Model model = steps.back().model;
    std::erase_if(model.effects, [&](const EffectUse& own) { return own.id() == id; });
    model.effects.push_back(*use);
    steps.push_back({.effect = id, .model = std::move(model)});
  }
  return steps;
}

Waterfall waterfall(Study& study, const std::vector<LineageStep>& lineage) {
  const std::vector<Studied> own = own_fits(study, lineage);
  const Studied& last = own.back();
  const auto all = static_cast<double>(study.residuals().size());
  Waterfall fall;
  fall.shots = fall.folds = study.campaign().shots.size();
  if (fall.shots < 2) {
    fall.fold = "parts";
    fall.folds = kRecordParts;
  }
  fall.strain_rate_per_s = usual_rate(last, study.campaign());
  LeftOnFolds before;
  for (std::size_t i = 0; i < lineage.size(); ++i) {
    const Studied studied = best_of_two(study, own[i], last);
    LeftOnFolds left{held_out_squares(studied, study), studied.fit.penalty};
    WaterfallStep step;
    step.effect = lineage[i].effect;
    step.removed = lineage[i].removed;
    step.misfit = studied.misfit;
    step.numbers = material_of(own[i]);
    if (const EffectUse* use = step.removed ? nullptr : own[i].model.find(step.effect)) {
      step.strengths = strengths_of(own[i], *use);
    }
    take_drop(step, left, i == 0 ? nullptr : &before, all);
    step.curve = specimen_curve(own[i], study.campaign(), fall.strain_rate_per_s);
    fall.steps.push_back(std::move(step));
    before = std::move(left);
  }
  const Misfit& rest = fall.steps.back().misfit;
  fall.floor =
      floor_of(last, rest.repeatable_log_p < kFalseClaim ? Left::more : Left::noise, fall.shots);
  fall.signal = study.residuals().signal_energy() / all;
  fall.repeats = rest.repeats / all;
  fall.last_beside_quiet = judged(study, last).misfit.chi2_reduced;
  return fall;
}

}  // namespace kolsky
