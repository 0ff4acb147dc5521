#include "processing/criticism/waterfall/impact_waterfall.hpp"

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

namespace {

/// What is free of core and cover.
std::vector<MovedNumber> layers_of(const Model& model) {
  std::vector<MovedNumber> list;
  for (const char* part : {"core", "cover"}) {
    const EffectUse* layer = model.find(std::string("three-element-") + part);
    if (layer == nullptr) {
      continue;
    }
    const std::vector<MovedNumber> own = numbers_of(*layer, std::string(part) + ".");
    for (std::size_t p = 0; p < own.size(); ++p) {
      if (layer->values[p].free) {
        list.push_back(own[p]);
      }
    }
  }
  return list;
}

std::vector<SpeedMisfit> speeds_of(ImpactStudy& study, const Studied& studied) {
  std::vector<SpeedMisfit> list;
  for (const SpeedSummary& speed : study.compare(studied).speeds) {
    list.push_back({speed.speed_m_per_s, speed.rms_percent, speed.noise_percent,
                    speed.restitution_foretold, speed.restitution_measured});
  }
  return list;
}

std::vector<double> squares_of(ImpactStudy& study, const Studied& studied, bool by_speed) {
  const ImpactResiduals& residuals = study.residuals();
  return by_speed ? held_out_speeds(studied, residuals.records(), residuals.per_shot())
                  : held_out_squares(studied, residuals.per_shot());
}

}  // namespace

Waterfall waterfall(ImpactStudy& study, const std::vector<LineageStep>& lineage) {
  const Studied last = study.fit(lineage.back().model);
  const ImpactResiduals& residuals = study.residuals();
  Waterfall fall;
  fall.shots = study.campaign().shots.size();
  const std::size_t speeds = residuals.records().groups.size();
  const bool by_speed = speeds > 1;
  fall.fold = by_speed ? "speeds" : "shots";
  fall.folds = by_speed ? speeds : fall.shots;
  const auto all = static_cast<double>(fall.shots * residuals.per_shot());
  fall.pull_counts = false;
  fall.allowance = "what the calculation may be off by";
  LeftOnFolds before;
  double penalty = 0.0;
  for (const LineageStep& own : lineage) {
    const Studied studied = study.settled(study.refit_near(own.model, last));
    WaterfallStep step;
    step.effect = own.effect;
    step.removed = own.removed;
    step.misfit = studied.misfit;
    step.numbers = layers_of(studied.model);
    step.speeds = speeds_of(study, studied);
    LeftOnFolds left{squares_of(study, studied, by_speed), 0.0};
    const bool first = before.squares.empty();
    take_drop(step, left, first ? nullptr : &before, all);
    step.relief = first ? 0.0 : penalty - studied.fit.penalty;
    if (const EffectUse* use = step.removed ? nullptr : last.model.find(step.effect)) {
      step.strengths = numbers_of(*use, "");
    }
    penalty = studied.fit.penalty;
    fall.within_allowance = study.within_calculation(studied.fit.residual);
    before = std::move(left);
    fall.steps.push_back(std::move(step));
  }
  const Misfit& rest = fall.steps.back().misfit;
  // Arrivals and offsets take up their share of the noise.
  const double left = 1.0 - residuals.eliminated() / static_cast<double>(residuals.per_shot());
  fall.floor = left * (fall.shots > speeds ? rest.noise_scale : 1.0);
  fall.signal = residuals.energy().signal() / all;
  fall.repeats = rest.repeatable_share * fall.signal;
  return fall;
}

}  // namespace kolsky
