#include "processing/criticism/verdict/slow_ties.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/search/common_amplitude.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/quiet_slopes.hpp"
#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/refits.hpp"

namespace kolsky {

namespace {

constexpr const char* kDrift = "baseline-drift";
constexpr const char* kHum = "mains-hum";

/// The model with a drift at a gauge, alike in all shots; as it is where it has one there.
Model with_drift(const Model& model, const std::string& gauge) {
  Model drifting = model;
  EffectUse drift = null_use(*find_effect(kDrift), gauge);
  if (drifting.find(drift.id()) == nullptr) {
    drifting.effects.push_back(std::move(drift));
  }
  return drifting;
}

Model with_drifts(const Model& model, const Bench& bench) {
  Model drifting = model;
  for (const Gauge& gauge : bench.gauges) {
    drifting = with_drift(drifting, gauge.name);
  }
  return drifting;
}

/// Of a fitted model, the drifts that are more than three of their deviations: "baseline-drift:g2".
std::vector<std::string> drifting_gauges(const Model& fitted) {
  constexpr double kKnown = 3.0;
  std::vector<std::string> list;
  for (const EffectUse& use : fitted.effects) {
    const ModelValue& rate = use.values.front();
    if (use.effect->about().id == kDrift && std::abs(rate.value) > kKnown * rate.sd) {
      list.push_back(use.id());
    }
  }
  return list;
}

bool is_drift(const EffectUse* use) {
  return use != nullptr && !use->gauge.empty() && is_addition(*use->effect);
}

/// Whether a drift at any other gauge, alike in all shots, is missed beside those claimed. All of
/// them at once tell less: a slope at every gauge is the source's.
bool others_drift(Study& study, const Studied& current) {
  return std::ranges::any_of(study.campaign().bench.gauges, [&](const Gauge& gauge) {
    const Model more = with_drift(current.model, gauge.name);
    return more.effects.size() > current.model.effects.size() &&
           missed_in(study, current, changed(study, current, more));
  });
}

/// Where records do not tell which gauge drifts, for only what differs between them shows, both
/// may: as a hum does that they pick up the other way.
bool at_either(const std::vector<std::string>& ties) {
  return std::ranges::any_of(
      ties, [](const std::string& id) { return id.starts_with(std::string(kDrift) + ":"); });
}

/// Before the pulses, which noise does once in 1e5 campaigns.
bool others_slope(const Campaign& campaign, const std::string& gauge) {
  const std::vector<double> chances = log_chances_of_slopes(campaign);
  for (std::size_t j = 0; j < chances.size(); ++j) {
    if (campaign.bench.gauges[j].name != gauge && chances[j] < kSure) {
      return true;
    }
  }
  return false;
}

/// Of a hum's strengths, which go by parameter, shot and gauge, each shot's at one gauge.
std::vector<QuadratureParts> parts_at(const Campaign& campaign, const Direction& direction,
                                      double noise, const std::string& gauge) {
  const auto& gauges = campaign.bench.gauges;
  const auto at = std::ranges::find(gauges, gauge, &Gauge::name) - gauges.begin();
  const auto count = static_cast<Eigen::Index>(gauges.size());
  const auto shots = static_cast<Eigen::Index>(campaign.shots.size());
  std::vector<QuadratureParts> parts;
  for (Eigen::Index n = 0; n < shots; ++n) {
    const std::vector<Eigen::Index> own{n * count + at, (shots + n) * count + at};
    parts.push_back({direction.pull(own) / noise, direction.information(own, own) / noise});
  }
  return parts;
}

/// A hum has one amplitude in all shots and any phase, a drift any slope: the likelihoods of
/// both, to first order, which for additions is all there is.
bool hum_does_as_well(Study& study, const Studied& neither, const EffectUse& drift) {
  const Campaign& campaign = study.campaign();
  const double noise = noise_of(neither.misfit, campaign.shots.size());
  double of_drift = 0.0;
  double of_hum = -HUGE_VAL;
  for (const Candidate& candidate : candidates_for(neither, campaign)) {
    const EffectUse& use = candidate.use;
    if (!use.per_shot || use.alike || !is_addition(*use.effect)) {
      continue;
    }
    if (use.id() == drift.id()) {
      const Direction direction = direction_of(candidate, neither, study);
      of_drift = log_likelihood_of_drawn_strengths(direction.pull / noise,
                                                   direction.information.diagonal() / noise);
    } else if (use.effect->about().quadrature) {
      const Direction direction = direction_of(candidate, neither, study);
      of_hum = std::max(of_hum, log_likelihood_of_common_amplitude(
                                    parts_at(campaign, direction, noise, drift.gauge)));
    }
  }
  return 2.0 * of_hum > 2.0 * of_drift - kTie;
}

}  // namespace

void tie_with_drifts(Study& study, const Studied& current, Diagnosis& diagnosis) {
  for (const std::string& id : diagnosis.effects) {
    const EffectUse* hum = current.model.find(id);
    if (hum == nullptr || !hum->effect->about().quadrature) {
      continue;
    }
    const Studied neither = without(study, current, id);
    const Studied drifts =
        changed(study, neither, with_drifts(neither.model, study.campaign().bench));
    const double noise = noise_of(current.misfit, study.campaign().shots.size());
    if (evidence(neither, drifts, noise) < evidence(neither, current, noise) - kTie) {
      continue;
    }
    std::vector<std::string>& ties = diagnosis.tied_with[id];
    for (const std::string& drift : drifting_gauges(drifts.model)) {
      if (std::ranges::count(ties, drift) == 0) {
        ties.push_back(drift);
      }
    }
  }
}

void tie_with_hum(Study& study, const Studied& current, Diagnosis& diagnosis) {
  if (std::ranges::count(diagnosis.effects, kHum) > 0) {
    return;
  }
  const auto drifts = std::ranges::count_if(
      diagnosis.effects, [&](const std::string& id) { return is_drift(current.model.find(id)); });
  for (const std::string& id : diagnosis.effects) {
    const EffectUse* drift = current.model.find(id);
    std::vector<std::string>& ties = diagnosis.tied_with[id];
    if (!is_drift(drift) || std::ranges::count(ties, kHum) > 0) {
      continue;
    }
    const bool may_be_hum = drift->per_shot
                                ? others_slope(study.campaign(), drift->gauge) ||
                                      hum_does_as_well(study, without(study, current, id), *drift)
                                : drifts > 1 || at_either(ties) || others_drift(study, current);
    if (may_be_hum) {
      ties.emplace_back(kHum);
    }
  }
}

std::optional<HumInShares> hum_in_shares(Study& study, const Studied& current,
                                         const std::vector<std::string>& effects) {
  const EffectUse* hum = current.model.find(kHum);
  if (std::ranges::count(effects, kHum) == 0 || !hum->per_shot || !hum->alike) {
    return std::nullopt;
  }
  std::vector<std::string> drifts;
  std::ranges::copy_if(effects, std::back_inserter(drifts),
                       [&](const std::string& id) { return is_drift(current.model.find(id)); });
  if (drifts.empty()) {
    return std::nullopt;
  }
  Model model = current.model;
  std::erase_if(model.effects,
                [&](const EffectUse& use) { return std::ranges::count(drifts, use.id()) > 0; });
  const Studied alike = changed(study, current, model);
  const Studied neither = without(study, alike, kHum);
  model.find(kHum)->alike = false;
  Studied shared = changed(study, alike, model);
  // Each gauge's own in every shot would be many hums: shares are a number a gauge.
  const OwnStrengths own = own_strengths_in(shared, kHum);
  const double many = nearest_products(own.found, own.information, study.campaign().shots.size(),
                                       study.campaign().gauges())
                          .left;
  const double noise = noise_of(current.misfit, study.campaign().shots.size());
  const double gain = (neither.fit.objective() - shared.fit.objective() - many) / noise;
  const double freedom = neither.fit.degrees_of_freedom(neither.composition) -
                         alike.fit.degrees_of_freedom(alike.composition) +
                         static_cast<double>(study.campaign().gauges() - 1);
  if (equivalent_square(log_gain_tail(gain, freedom, Signs::both)) <
      evidence(neither, current, noise) - kTie) {
    return std::nullopt;
  }
  return HumInShares{std::move(shared), std::move(drifts)};
}

}  // namespace kolsky
