#include "processing/criticism/fitting/composition.hpp"

#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/known_unknowns.hpp"

namespace kolsky {

namespace {

EffectUse filed(const std::string& id, std::vector<double> sds) {
  EffectUse use = use_named(id);
  for (std::size_t i = 0; i < sds.size(); ++i) {
    use.values[i].prior_sd = sds[i];
    use.values[i].prior_mean = use.effect->about().parameters[i].null_value;
    use.values[i].free = sds[i] > 0.0;
  }
  return use;
}

/// Each bar's number is off by itself, but an effect on the first moves both.
double beside(double first_sd, const Measured& second) {
  return std::hypot(first_sd, relative_sd(second));
}

/// Without waves, or with a material that nobody states, nothing can be foretold.
void require_whole(const Model& model, const Bench& bench) {
  std::vector<std::string> needed;
  if (bench.kind != BenchKind::impact) {
    needed.emplace_back("elementary-waves");
    if (!bench.input.youngs_modulus_Pa || (bench.output && !bench.output->youngs_modulus_Pa)) {
      needed.emplace_back("three-element-bar");
    }
  }
  if (bench.kind == BenchKind::shpb) {
    needed.emplace_back("three-element-specimen");
  }
  for (const std::string& id : needed) {
    if (model.find(id) == nullptr) {
      throw InputError("model", "lacks " + id + ", without which nothing can be foretold here",
                       "add it with `kolsky model add`");
    }
  }
}

}  // namespace

std::vector<EffectUse> known_unknowns_of(const Bench& bench) {
  std::vector<EffectUse> list;
  for (const Gauge& gauge : bench.gauges) {
    if (const double sd = gain_sd(gauge); sd > 0.0) {
      list.push_back(filed("gauge-factor:" + gauge.name, {sd}));
    }
    if (gauge.position_m.sd > 0.0) {
      list.push_back(filed("gauge-position:" + gauge.name, {gauge.position_m.sd}));
    }
    if (gauge.length_m && gauge.length_m->sd > 0.0) {
      list.push_back(filed("gauge-length-offset:" + gauge.name, {gauge.length_m->sd}));
    }
    if (gauge.delay_s.sd > 0.0) {
      list.push_back(filed("channel-delay:" + gauge.name, {gauge.delay_s.sd}));
    }
  }
  if (bench.kind != BenchKind::impact && bench.sampling_frequency_Hz.sd > 0.0) {
    list.push_back(filed("sampling-clock", {relative_sd(bench.sampling_frequency_Hz)}));
  }
  if (bench.input.length_m.sd > 0.0) {
    list.push_back(filed("bar-length", {bench.input.length_m.sd}));
  }
  if (bench.input.density_kg_m3.sd > 0.0) {
    list.push_back(filed("bar-density", {relative_sd(bench.input.density_kg_m3)}));
  }
  if (bench.output && bench.output->length_m.sd > 0.0) {
    list.push_back(filed("output-bar-length", {bench.output->length_m.sd}));
  }
  if (bench.output && bench.output->density_kg_m3.sd > 0.0) {
    list.push_back(filed("output-bar-density", {relative_sd(bench.output->density_kg_m3)}));
  }
  // What waves in one bar alone do depends on it only where they are dispersed, as a strength of
  // that dispersion does.
  if (bench.kind != BenchKind::bar && bench.input.diameter_m.sd > 0.0) {
    list.push_back(filed("bar-diameter", {relative_sd(bench.input.diameter_m)}));
  }
  if (bench.output && bench.output->diameter_m.sd > 0.0) {
    list.push_back(filed("output-bar-diameter", {relative_sd(bench.output->diameter_m)}));
  }
  const bool viscoelastic =
      !bench.input.youngs_modulus_Pa || (bench.output && !bench.output->youngs_modulus_Pa);
  if (viscoelastic && bench.kind != BenchKind::impact && bench.temperature_K &&
      bench.temperature_K->sd > 0.0) {
    list.push_back(filed("bar-temperature", {bench.temperature_K->sd}));
    list.back().per_shot = true;  // read anew for each
  }
  const double modulus_sd =
      bench.input.youngs_modulus_Pa ? relative_sd(*bench.input.youngs_modulus_Pa) : 0.0;
  if (modulus_sd > 0.0) {
    list.push_back(filed("bar-modulus", {modulus_sd}));
  }
  if (bench.output && bench.output->youngs_modulus_Pa) {
    const double sd = beside(modulus_sd, *bench.output->youngs_modulus_Pa);
    if (sd > 0.0) {
      list.push_back(filed("output-bar-modulus", {sd}));
    }
  }
  if (bench.ball &&
      (bench.ball->core_diameter_m.sd > 0.0 || bench.ball->outer_diameter_m.sd > 0.0)) {
    list.push_back(filed("ball-dimensions",
                         {bench.ball->core_diameter_m.sd, bench.ball->outer_diameter_m.sd}));
  }
  if (bench.ball && bench.ball->mass_kg && bench.ball->mass_kg->sd > 0.0) {
    list.push_back(filed("ball-mass", {relative_sd(*bench.ball->mass_kg)}));
  }
  if (bench.specimen &&
      (bench.specimen->length_m.sd > 0.0 || bench.specimen->diameter_m.sd > 0.0)) {
    list.push_back(
        filed("specimen-dimensions", {bench.specimen->length_m.sd, bench.specimen->diameter_m.sd}));
  }
  return list;
}

Composition::Composition(const Model& model, const Campaign& campaign)
    : shots_(campaign.shots.size()), gauges_(campaign.gauges()) {
  if (model.kind != campaign.bench.kind) {
    throw InputError(
        "the model",
        "is of a bench of kind " + name_of(model.kind) + ", and the captures of one of kind " +
            name_of(campaign.bench.kind),
        "make one with `kolsky model new --kind " + name_of(campaign.bench.kind) + "`");
  }
  require_whole(model, campaign.bench);
  for (const EffectUse& use : model.effects) {
    add(use, campaign);
  }
  for (const EffectUse& use : known_unknowns_of(campaign.bench)) {
    if (model.find(use.id()) == nullptr) {
      add(use, campaign);
    }
  }
}

double scale_of(const ModelValue& value, const EffectParameter& parameter) {
  return value.prior_sd > 0.0 ? value.prior_sd : parameter.typical;
}

void bound_strengths(EffectUse& use) {
  const EffectAbout& about = use.effect->about();
  if (!about.each_gauge) {
    return;
  }
  constexpr double kLargest = 30.0;
  double slower = 1.0;
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    if (about.parameters[p].unit == "Hz") {
      slower = about.parameters[p].starts.back() / use.values[p].value;
    }
  }
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    if (!about.parameters[p].auxiliary()) {
      use.values[p].prior_sd = kLargest * slower * about.parameters[p].typical;
    }
  }
}

bool has_own_strengths(const EffectUse& use) {
  return use.per_shot || (use.effect->about().each_gauge && !use.alike);
}

Model all_but_own_held(Model model, const Bench& bench) {
  for (EffectUse& filed : known_unknowns_of(bench)) {
    if (model.find(filed.id()) == nullptr) {
      model.effects.push_back(std::move(filed));
    }
  }
  for (EffectUse& use : model.effects) {
    const auto& parameters = use.effect->about().parameters;
    bool any = false;
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      const bool own = has_own_strengths(use) && !parameters[p].auxiliary();
      use.values[p].free = use.values[p].free && own;
      any = any || use.values[p].free;
    }
    if (!any) {
      use.prior_correlation.clear();
    }
  }
  return model;
}

void Composition::add(const EffectUse& use, const Campaign& campaign) {
  const EffectAbout& about = use.effect->about();
  std::size_t gauge = 0;
  if (about.per_gauge) {
    const auto& gauges = campaign.bench.gauges;
    const auto found = std::find_if(gauges.begin(), gauges.end(),
                                    [&](const Gauge& g) { return g.name == use.gauge; });
    if (found == gauges.end()) {
      std::string names;
      for (const Gauge& own : gauges) {
        names += (names.empty() ? "" : ", ") + own.name;
      }
      throw InputError("the model's effect " + use.id(),
                       "names a gauge that the captures' bench does not have",
                       "take it out, or name one of " + names);
    }
    gauge = static_cast<std::size_t>(found - gauges.begin());
  }
  differs_by_shot_ = differs_by_shot_ || about.shot_facts;
  changes_records_ = changes_records_ || about.stage == Stage::record;
  std::vector<Slots> slots(about.parameters.size());
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const EffectParameter& parameter = about.parameters[p];
    const ModelValue& value = use.values[p];
    const std::size_t by_shot = use.per_shot && !parameter.auxiliary() ? shots_ : 1;
    const std::size_t by_gauge =
        about.each_gauge && !use.alike && !parameter.auxiliary() ? gauges_ : 1;
    Slots own{by_shot, by_gauge, std::vector<Slot>(by_shot * by_gauge)};
    for (std::size_t place = 0; place < own.of.size(); ++place) {
      Slot& slot = own.of[place];
      slot.fixed = value.value;
      // What is chosen among a few has no neighbourhood to search.
      if (value.free && !parameter.chosen) {
        slot.number = static_cast<std::ptrdiff_t>(numbers_.size());
        const double scale = scale_of(value, parameter);
        const auto [least, most] =
            value.bounds.value_or(std::array{parameter.lower, parameter.upper});
        numbers_.push_back(
            {uses_.size(), p, value.value, scale, least, most, value.prior_mean, value.prior_sd,
             by_shot > 1 ? static_cast<std::ptrdiff_t>(place / by_gauge) : -1, parameter.difference,
             parameter.power, p == about.strength ? use.effect->filed_share(campaign.bench) : 0.0});
      }
    }
    slots[p] = std::move(own);
  }
  uses_.push_back(use);
  gauge_of_use_.push_back(gauge);
  slots_.push_back(std::move(slots));
}

double FreeNumber::theta_of(double value) const {
  const double ratio = value / scale;
  return power == 1.0 ? ratio : std::copysign(std::pow(std::abs(ratio), power), ratio);
}

double FreeNumber::value_at(double theta) const {
  return scale * root(theta, power);
}

double FreeNumber::sd_at(double theta, double theta_sd) const {
  const double value = value_at(theta);
  const double below = std::max(theta - theta_sd, theta_of(lower));
  return power == 1.0 ? theta_sd * scale
                      : std::max(value_at(theta + theta_sd) - value, value - value_at(below));
}

double FreeNumber::inside(double theta) const {
  return std::clamp(theta, theta_of(lower), theta_of(upper));
}

std::vector<double> Composition::start() const {
  std::vector<double> theta;
  for (const FreeNumber& number : numbers_) {
    theta.push_back(number.theta_of(number.start));
  }
  return theta;
}

Eigen::MatrixXd Composition::prior_precision() const {
  const auto count = static_cast<Eigen::Index>(numbers_.size());
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const FreeNumber& number = numbers_[static_cast<std::size_t>(i)];
    if (number.prior_sd > 0.0) {
      precision(i, i) = number.scale * number.scale / (number.prior_sd * number.prior_sd);
    }
  }
  for (std::size_t u = 0; u < uses_.size(); ++u) {
    const std::vector<double>& correlation = uses_[u].prior_correlation;
    if (correlation.empty()) {
      continue;
    }
    // Of the numbers that are free and have a deviation: what is held narrows none of them.
    std::vector<std::size_t> own = numbers_of(u);
    std::erase_if(own, [&](std::size_t number) { return !(numbers_[number].prior_sd > 0.0); });
    const std::size_t all = uses_[u].values.size();
    Eigen::MatrixXd among(own.size(), own.size());
    for (std::size_t a = 0; a < own.size(); ++a) {
      for (std::size_t b = 0; b < own.size(); ++b) {
        among(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
            correlation[numbers_[own[a]].parameter * all + numbers_[own[b]].parameter];
      }
    }
    const Eigen::MatrixXd inverse = inverse_of(among);
    for (std::size_t a = 0; a < own.size(); ++a) {
      for (std::size_t b = 0; b < own.size(); ++b) {
        const FreeNumber& p = numbers_[own[a]];
        const FreeNumber& q = numbers_[own[b]];
        precision(static_cast<Eigen::Index>(own[a]), static_cast<Eigen::Index>(own[b])) =
            p.scale * q.scale / (p.prior_sd * q.prior_sd) *
            inverse(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }
  return precision;
}

std::vector<AppliedEffect> Composition::applied(const std::vector<double>& theta,
                                                std::size_t shot) const {
  std::vector<AppliedEffect> list;
  for (std::size_t u = 0; u < uses_.size(); ++u) {
    const EffectUse& use = uses_[u];
    const bool each_gauge = use.effect->about().each_gauge;
    const std::size_t copies = each_gauge ? gauges_ : 1;
    for (std::size_t copy = 0; copy < copies; ++copy) {
      AppliedEffect effect{use.effect, each_gauge ? copy : gauge_of_use_[u], {}};
      for (const Slots& own : slots_[u]) {
        const Slot& slot = own.at(shot, copy);
        effect.values.push_back(slot.number < 0
                                    ? slot.fixed
                                    : numbers_[static_cast<std::size_t>(slot.number)].value_at(
                                          theta[static_cast<std::size_t>(slot.number)]));
      }
      list.push_back(std::move(effect));
    }
  }
  return list;
}

std::vector<std::size_t> Composition::numbers_of(std::size_t use) const {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (numbers_[i].use == use) {
      list.push_back(i);
    }
  }
  return list;
}

}  // namespace kolsky
