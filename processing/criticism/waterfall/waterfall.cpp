#include "processing/criticism/waterfall/waterfall.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/record_parts.hpp"
#include "processing/criticism/search/candidates.hpp"

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

Studied best_of_two(Study& study, const Model& model, const Studied& last) {
  // From what the last model knows, and from nothing: a large misfit can lead either astray.
  Composition composition(model, study.campaign());
  WhiteResiduals& residuals = study.residuals();
  residuals.freeze(composition, carry(last.composition, last.fit.theta, composition));
  ModelFit near = fit_model(composition, residuals, study.executor(),
                            carry(last.composition, last.fit.theta, composition));
  Model fresh = model;
  start_moduli(fresh, study.campaign(), residuals);
  const Composition again(fresh, study.campaign());
  ModelFit far =
      fit_model(composition, residuals, study.executor(), carry(again, again.start(), composition));
  ModelFit fit = far.objective() < near.objective() ? std::move(far) : std::move(near);
  return study.refit({model, std::move(composition), std::move(fit), {}});
}

std::vector<MovedNumber> material_of(const Model& model) {
  std::vector<MovedNumber> list;
  if (const EffectUse* specimen = model.find("three-element-specimen")) {
    list = numbers_of(*specimen, "");
  }
  if (const EffectUse* bar = model.find("three-element-bar")) {
    const auto own = numbers_of(*bar, model.kind == BenchKind::bar ? "" : "bar.");
    list.insert(list.end(), own.begin(), own.end());
  }
  return list;
}

/// Half of what the incident wave would do to a specimen without any resistance.
double usual_rate(const Studied& last, const Campaign& campaign) {
  if (!campaign.bench.specimen) {
    return 0.0;
  }
  const Bar& bar = campaign.bench.input;
  double modulus = bar.youngs_modulus_Pa.value_or(Measured{}).value;
  if (const EffectUse* use = last.model.find("three-element-bar")) {
    modulus = use->values.front().value;
  }
  double peak = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    peak += shot.facts.peak_strain / static_cast<double>(campaign.shots.size());
  }
  return peak * std::sqrt(modulus / bar.density_kg_m3) / campaign.bench.specimen->length_m;
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

void take_drop(WaterfallStep& step, const std::vector<double>& squares,
               const std::vector<double>* before, double residuals) {
  step.held_out = std::accumulate(squares.begin(), squares.end(), 0.0) / residuals;
  for (std::size_t n = 0; before != nullptr && n < squares.size(); ++n) {
    step.gain += (*before)[n] - squares[n];
    step.better += (*before)[n] > squares[n] ? 1 : 0;
  }
}

double Waterfall::closed() const {
  if (steps.empty() || steps.front().held_out <= floor) {
    return 1.0;
  }
  return (steps.front().held_out - steps.back().held_out) / (steps.front().held_out - floor);
}

std::vector<LineageStep> lineage(const Model& first, const Model& last,
                                 const std::vector<std::string>& order) {
  std::vector<LineageStep> steps{{{}, false, first}};
  for (const EffectUse& use : first.effects) {
    if (last.find(use.id()) == nullptr && !only_filed(use)) {
      Model model = steps.back().model;
      std::erase_if(model.effects, [&](const EffectUse& own) { return own.id() == use.id(); });
      steps.push_back({use.id(), true, std::move(model)});
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
    steps.push_back({id, false, std::move(model)});
  }
  return steps;
}

Waterfall waterfall(Study& study, const std::vector<LineageStep>& lineage) {
  const Studied last = study.fit(lineage.back().model);
  Waterfall fall;
  fall.shots = fall.folds = study.campaign().shots.size();
  if (fall.shots < 2) {
    fall.fold = "parts";
    fall.folds = kRecordParts;
  }
  fall.strain_rate_per_s = usual_rate(last, study.campaign());
  std::vector<double> before;
  double penalty = 0.0;
  for (const LineageStep& own : lineage) {
    const Studied studied = best_of_two(study, own.model, last);
    const std::vector<double> squares = held_out_squares(studied, study);
    WaterfallStep step;
    step.effect = own.effect;
    step.removed = own.removed;
    step.misfit = studied.misfit;
    step.numbers = material_of(studied.model);
    take_drop(step, squares, before.empty() ? nullptr : &before,
              static_cast<double>(study.residuals().size()));
    step.curve = specimen_curve(studied, study.campaign(), fall.strain_rate_per_s);
    step.relief = before.empty() ? 0.0 : penalty - studied.fit.penalty;
    fall.steps.push_back(std::move(step));
    penalty = studied.fit.penalty;
    before = squares;
    if (&own == &lineage.back()) {
      const double all = static_cast<double>(study.residuals().size());
      fall.floor = fall.shots > 1 ? studied.misfit.noise_scale : 1.0;
      fall.signal = study.residuals().signal_energy() / all;
      fall.repeats = studied.misfit.repeatable_share * fall.signal;
      for (WaterfallStep& made : fall.steps) {
        const EffectUse* use = made.removed ? nullptr : studied.model.find(made.effect);
        if (use != nullptr) {
          made.strengths = numbers_of(*use, "");
        }
      }
    }
  }
  return fall;
}

}  // namespace kolsky
