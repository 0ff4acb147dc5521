#include "processing/criticism/selftest/selftest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>

#include "processing/base/error.hpp"
#include "processing/criticism/selftest/planting.hpp"
#include "processing/criticism/selftest/selftest_ground.hpp"

namespace kolsky {

namespace {

/// One diagnosis to be made.
struct Case {
  EffectUse use;
  std::size_t effect = 0;  ///< of the result's list
  std::size_t size = 0;
  bool null = false;
  std::uint64_t seed = 0;
};

bool holds(const std::vector<std::string>& list, const std::string& id) {
  return std::find(list.begin(), list.end(), id) != list.end();
}

PlantOutcome outcome_of(const Diagnosis& diagnosis, const std::string& id,
                        const std::vector<std::string>& before) {
  if (diagnosis.verdict == DiagnosisVerdict::unknown) {
    return PlantOutcome::unknown;
  }
  if (diagnosis.verdict == DiagnosisVerdict::bad_data) {
    return PlantOutcome::unusable;
  }
  bool own = false;
  bool tied = false;
  bool other = false;
  for (const std::string& claimed : diagnosis.effects) {
    const auto ties = diagnosis.tied_with.find(claimed);
    const bool among = ties != diagnosis.tied_with.end() && holds(ties->second, id);
    own = own || claimed == id;
    tied = tied || among;
    other = other || (claimed != id && !among && !holds(before, claimed));
  }
  if (own || tied) {
    return other ? PlantOutcome::beside : (own ? PlantOutcome::named : PlantOutcome::tied);
  }
  return other ? PlantOutcome::wrong : PlantOutcome::unseen;
}

class Run {
 public:
  Run(const std::vector<Shot>& shots, const Model& model, const SelftestOptions& options,
      const Workers& workers)
      : last_gauge_(shots.empty() ? "" : shots.front().bench.gauges.back().name),
        model_(model),
        options_(options),
        workers_(workers),
        ground_(ground_of(shots, model, options.band_limit_Hz, options.meshes, workers)) {}

  Selftest operator()() {
    const Diagnosis untouched = ground_->untouched();
    result_.untouched = untouched.verdict;
    result_.untouched_effects = untouched.effects;
    choose_effects(untouched);
    add_nulls();
    options_.progress(1, cases_.size() + 1);
    std::vector<Diagnosis> said(cases_.size());
    std::atomic<std::size_t> done{1};
    workers_.run(cases_.size(), [&](std::size_t i, std::size_t worker) {
      said[i] = diagnosed(cases_[i], worker);
      options_.progress(++done, cases_.size() + 1);
    });
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      take(cases_[i], said[i]);
    }
    return std::move(result_);
  }

 private:
  /// What is said of one case; bad data where the shots no longer serve.
  [[nodiscard]] Diagnosis diagnosed(const Case& own, std::size_t worker) const {
    Diagnosis unusable;
    unusable.verdict = DiagnosisVerdict::bad_data;
    try {
      const std::vector<Shot> shots =
          own.null ? ground_->drawn_anew(own.seed, worker) : ground_->planted(own.use, worker);
      const bool bad = std::any_of(shots.begin(), shots.end(),
                                   [](const Shot& shot) { return !bad_data(shot).empty(); });
      return bad ? unusable : ground_->diagnosed(shots);
    } catch (const InputError&) {
      // A ball that no solver carries through, or whose rebound the beams no longer see.
      return unusable;
    }
  }

  /// All that first-order theory can tell on these shots; of effects of one gauge those of the
  /// last.
  void choose_effects(const Diagnosis& untouched) {
    std::vector<std::string> ids = options_.effects;
    std::map<std::string, std::pair<double, double>> limits;  ///< detectable, identifiable
    for (const CandidateResult& candidate : untouched.candidates) {
      limits[candidate.effect] = {candidate.detectable, candidate.identifiable};
      const EffectUse use = use_named(candidate.effect, model_);
      if (options_.effects.empty() && std::isfinite(candidate.detectable) &&
          (use.gauge.empty() || use.gauge == last_gauge_)) {
        ids.push_back(candidate.effect);
      }
    }
    for (const std::string& id : ids) {
      constexpr double kNone = std::numeric_limits<double>::infinity();
      const auto known = limits.find(id);
      const auto [detectable, identifiable] =
          known == limits.end() ? std::pair(kNone, kNone) : known->second;
      add_effect(id, detectable, identifiable);
    }
  }

  void add_effect(const std::string& id, double detectable, double identifiable) {
    EffectUse use = use_named(id, model_);
    const EffectParameter& parameter = use.effect->about().parameters.front();
    PlantedEffect planted{id, parameter.name, parameter.unit, identifiable, detectable, {}, {}};
    const double bound = std::max(std::abs(parameter.upper - parameter.null_value),
                                  std::abs(parameter.lower - parameter.null_value));
    const bool by_identifiable = identifiable < bound;
    const double unit_size = by_identifiable ? identifiable : detectable;
    use.values.front().value = parameter.null_value + parameter.typical;
    planted.skipped = ground_->impossible_because(use);
    std::vector<std::pair<double, double>> sizes;  ///< with its multiple
    for (const double size : options_.sizes) {
      sizes.emplace_back(size, by_identifiable ? size / identifiable : 0.0);
    }
    if (options_.sizes.empty() && planted.skipped.empty()) {
      if (!std::isfinite(unit_size)) {
        planted.skipped = "cannot be seen on these shots at any size";
      }
      for (const double multiple : options_.multiples) {
        sizes.emplace_back(multiple * unit_size, by_identifiable ? multiple : 0.0);
      }
    }
    const std::size_t at = result_.effects.size();
    double sign = use.effect->about().parameters.front().upper > parameter.null_value ? 1.0 : -1.0;
    for (const auto& [size, multiple] : sizes) {
      const double value = parameter.null_value + sign * size;
      // Beyond what is physical nothing is planted.
      if (!planted.skipped.empty() || value < parameter.lower || value > parameter.upper) {
        continue;
      }
      use.values.front().value = value;
      cases_.push_back({.use = use, .effect = at, .size = planted.sizes.size()});
      planted.sizes.push_back({sign * size, multiple, PlantOutcome::unseen, {}, 0.0, 0.0});
      sign = two_sided(use) ? -sign : sign;
    }
    if (planted.sizes.empty() && planted.skipped.empty()) {
      planted.skipped = "every size asked for is beyond its bounds";
    }
    result_.effects.push_back(std::move(planted));
  }

  void add_nulls() {
    result_.nulls = options_.nulls;
    for (std::size_t i = 0; i < options_.nulls; ++i) {
      // No two seeds share a campaign.
      constexpr std::uint64_t kMostNulls = 10000;
      cases_.push_back({.use = {}, .null = true, .seed = options_.seed * kMostNulls + i});
    }
  }

  void take(const Case& own, const Diagnosis& diagnosis) {
    if (own.null) {
      result_.false_claims += diagnosis.effects.empty() ? 0 : 1;
      result_.false_unknown += diagnosis.verdict == DiagnosisVerdict::unknown ? 1 : 0;
      for (const std::string& id : diagnosis.effects) {
        result_.falsely_claimed.push_back(id);
      }
      return;
    }
    PlantedEffect& effect = result_.effects[own.effect];
    PlantedSize& size = effect.sizes[own.size];
    size.outcome = outcome_of(diagnosis, effect.id, result_.untouched_effects);
    size.said = diagnosis.effects;
    const auto candidate =
        std::find_if(diagnosis.candidates.begin(), diagnosis.candidates.end(),
                     [&](const CandidateResult& c) { return c.effect == effect.id; });
    if (size.found() && candidate != diagnosis.candidates.end()) {
      size.strength = candidate->strength;
      size.sd = candidate->sd;
    }
  }

  std::string last_gauge_;
  const Model& model_;
  const SelftestOptions& options_;
  const Workers& workers_;
  std::unique_ptr<SelftestGround> ground_;
  std::vector<Case> cases_;
  Selftest result_;
};

}  // namespace

std::string name_of(PlantOutcome outcome) {
  switch (outcome) {
    case PlantOutcome::named:
      return "named";
    case PlantOutcome::tied:
      return "tied";
    case PlantOutcome::beside:
      return "named beside another";
    case PlantOutcome::unknown:
      return "unknown";
    case PlantOutcome::wrong:
      return "wrong";
    case PlantOutcome::unseen:
      return "unseen";
    case PlantOutcome::unusable:
      return "bad data";
  }
  return {};
}

bool PlantedSize::found() const {
  return outcome == PlantOutcome::named || outcome == PlantOutcome::tied ||
         outcome == PlantOutcome::beside;
}

double PlantedEffect::smallest_found() const {
  std::vector<const PlantedSize*> ordered;
  for (const PlantedSize& size : sizes) {
    ordered.push_back(&size);
  }
  std::sort(ordered.begin(), ordered.end(), [](const PlantedSize* a, const PlantedSize* b) {
    return std::abs(a->size) > std::abs(b->size);
  });
  double smallest = std::numeric_limits<double>::infinity();
  for (const PlantedSize* size : ordered) {
    if (!size->found()) {
      break;
    }
    smallest = std::abs(size->size);
  }
  return smallest;
}

std::vector<Selftest::Power> Selftest::power() const {
  std::map<double, Power> by_multiple;
  for (const PlantedEffect& effect : effects) {
    for (const PlantedSize& size : effect.sizes) {
      if (size.multiple > 0.0) {
        Power& power = by_multiple[size.multiple];
        power.multiple = size.multiple;
        power.found += size.found() ? 1 : 0;
        ++power.planted;
      }
    }
  }
  std::vector<Power> list;
  for (const auto& [multiple, power] : by_multiple) {
    list.push_back(power);
  }
  return list;
}

namespace {

/// Before any work: that one of the sizes asked for can be planted.
void require_size_in_bounds(const EffectUse& use, const std::vector<double>& sizes) {
  const EffectParameter& own = use.effect->about().parameters.front();
  const double room = std::max(own.upper - own.null_value, own.null_value - own.lower);
  if (!sizes.empty() && *std::ranges::min_element(sizes) > room) {
    throw InputError("sizes",
                     fmt::format("are all beyond what {} can be: {:g} {} to {:g} {}", use.id(),
                                 own.lower, own.unit, own.upper, own.unit),
                     "give sizes within");
  }
}

}  // namespace

Selftest selftest(const std::vector<Shot>& shots, const Model& model,
                  const SelftestOptions& options, const Workers& workers) {
  for (const double size : options.sizes) {
    if (!(size > 0.0) || !std::isfinite(size)) {
      throw InputError("sizes", "must be above 0", "give sizes off the effect's null, in its unit");
    }
  }
  for (const std::string& id : options.effects) {
    if (model.find(id) != nullptr &&
        std::none_of(model.find(id)->values.begin(), model.find(id)->values.end(),
                     [](const ModelValue& value) { return value.prior_sd > 0.0; })) {
      throw InputError("effect " + id, "is in the model already", "plant one that it lacks");
    }
    require_size_in_bounds(use_named(id, model), options.sizes);
  }
  return Run(shots, model, options, workers)();
}

}  // namespace kolsky
