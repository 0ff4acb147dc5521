#include "processing/criticism/search/candidates.hpp"
#include "processing/algebra/algebra.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

bool belongs(const EffectAbout& about, BenchKind kind) {
  return std::find(about.kinds.begin(), about.kinds.end(), kind) != about.kinds.end();
}

bool has_temperatures(const Campaign& campaign) {
  double least = INFINITY;
  double most = -INFINITY;
  for (const CampaignShot& shot : campaign.shots) {
    if (shot.facts.warmer_by_K) {
      least = std::min(least, *shot.facts.warmer_by_K);
      most = std::max(most, *shot.facts.warmer_by_K);
    }
  }
  return most > least;
}

/// Whether a variant says anything at all here (a neighbour that is not there, temperatures that
/// nobody logged).
bool means_something(const EffectUse& use, const Campaign& campaign) {
  const std::string& id = use.effect->about().id;
  if (id == "temperature") {
    return has_temperatures(campaign);
  }
  if (id == "crosstalk") {
    const auto& gauges = campaign.bench.gauges;
    const bool before = use.values[1].value < 0.0;
    return before ? use.gauge != gauges.front().name : use.gauge != gauges.back().name;
  }
  return true;
}

Signs signs_of(const EffectUse& use) {
  const auto& parameters = use.effect->about().parameters;
  const auto strengths = std::count_if(parameters.begin(), parameters.end(),
                                       [](const auto& p) { return !p.auxiliary(); });
  const EffectParameter& first = parameters.front();
  const bool at_end = first.null_value <= first.lower || first.null_value >= first.upper;
  return strengths == 1 && !use.per_shot && at_end ? Signs::one : Signs::both;
}

void hold_auxiliaries(EffectUse& use) {
  const auto& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    use.values[p].free = !parameters[p].auxiliary();
  }
}

void add_variants(const Effect& effect, const std::string& gauge, const Campaign& campaign,
                  std::vector<Candidate>& list) {
  const EffectAbout& about = effect.about();
  EffectUse use = null_use(effect, gauge);
  hold_auxiliaries(use);
  const auto auxiliary = std::find_if(about.parameters.begin(), about.parameters.end(),
                                      [](const auto& p) { return p.auxiliary(); });
  std::vector<EffectUse> variants{use};
  if (auxiliary != about.parameters.end()) {
    variants.clear();
    for (const double start : auxiliary->starts) {
      use.values[static_cast<std::size_t>(auxiliary - about.parameters.begin())].value = start;
      variants.push_back(use);
    }
  }
  for (EffectUse& variant : variants) {
    bound_strengths(variant);
    for (const bool per_shot : {false, true}) {
      if ((per_shot && (!about.per_shot || campaign.shots.size() < 2)) ||
          !means_something(variant, campaign)) {
        continue;
      }
      variant.per_shot = per_shot;
      variant.alike = false;
      list.push_back({.use = variant, .signs = signs_of(variant)});
      if (about.each_gauge) {
        variant.alike = true;
        list.push_back({.use = variant, .signs = signs_of(variant)});
      }
    }
  }
}

}  // namespace

std::vector<Candidate> candidates_for(const Studied& studied, const Campaign& campaign) {
  std::vector<Candidate> list;
  for (const EffectUse& use : studied.composition.uses()) {
    const bool filed = std::any_of(use.values.begin(), use.values.end(),
                                   [](const auto& value) { return value.prior_sd > 0.0; });
    if (filed && !use.effect->about().base && !use.effect->about().each_gauge) {
      list.push_back({.use = use, .frees_prior = true});
    }
  }
  for (const Effect* effect : effects_known_to(studied.model)) {
    const EffectAbout& about = effect->about();
    if (about.base || about.told_only || !belongs(about, campaign.bench.kind)) {
      continue;
    }
    std::vector<std::string> gauges{""};
    if (about.per_gauge) {
      gauges.clear();
      for (const Gauge& gauge : campaign.bench.gauges) {
        gauges.push_back(gauge.name);
      }
    }
    for (const std::string& gauge : gauges) {
      const std::string id = gauge.empty() ? about.id : about.id + ":" + gauge;
      const auto& uses = studied.composition.uses();
      if (std::none_of(uses.begin(), uses.end(), [&](const auto& use) { return use.id() == id; })) {
        add_variants(*effect, gauge, campaign, list);
      }
    }
  }
  return list;
}

Model with(const Model& model, const Candidate& candidate, Auxiliaries auxiliaries) {
  Model out = model;
  EffectUse use = candidate.use;
  if (candidate.frees_prior) {
    for (ModelValue& value : use.values) {
      value.prior_sd = 0.0;
    }
  }
  const auto& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size() && auxiliaries == Auxiliaries::free; ++p) {
    if (parameters[p].is_switch) {
      use.values[p].value = parameters[p].upper;
      use.values[p].free = false;
    }
    // What is chosen among a few (a neighbour, a harmonic) stays chosen.
    if (parameters[p].auxiliary() && !parameters[p].chosen) {
      use.values[p].free = true;
    }
  }
  if (EffectUse* own = out.find(use.id())) {
    *own = use;
  } else {
    out.effects.push_back(use);
  }
  return out;
}

std::optional<std::size_t> place_in(const Composition& from, const Composition& to,
                                    std::size_t number, const std::vector<bool>& taken) {
  const FreeNumber& wanted = to.numbers()[number];
  for (std::size_t k = 0; k < taken.size(); ++k) {
    const FreeNumber& held = from.numbers()[k];
    if (!taken[k] && held.parameter == wanted.parameter &&
        from.uses()[held.use].id() == to.uses()[wanted.use].id()) {
      return k;
    }
  }
  return std::nullopt;
}

std::vector<double> carry(const Composition& from, const std::vector<double>& theta,
                          const Composition& to) {
  std::vector<double> out = to.start();
  std::vector<bool> taken(theta.size(), false);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (const auto held = place_in(from, to, i, taken)) {
      out[i] = to.numbers()[i].theta_of(from.numbers()[*held].value_at(theta[*held]));
      taken[*held] = true;
    }
  }
  return out;
}

double doubt_of_gain(const Candidate& candidate, const Direction& direction, double scale) {
  if (!candidate.frees_prior || direction.information.rows() != 1) {
    return scale;
  }
  // In filed deviations: 1 / (1 + what the records' own variance is of the filed one).
  const double filed = std::clamp(direction.information(0, 0), 0.0, 1.0);
  return filed + scale * (1.0 - filed);
}

namespace {

/// Numbers of one effect.
std::vector<std::size_t> numbers_of(const Composition& composition, const std::string& id) {
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
    if (composition.uses()[composition.numbers()[i].use].id() == id) {
      own.push_back(i);
    }
  }
  return own;
}

/// The records' own view of filed numbers: their columns are the model's, their prior goes.
Direction freed_of_prior(const Candidate& candidate, const Studied& studied) {
  const ModelFit& fit = studied.fit;
  std::vector<std::size_t> own = numbers_of(studied.composition, candidate.id());
  std::erase_if(own,
                [&](std::size_t i) { return !(studied.composition.numbers()[i].prior_sd > 0.0); });
  const std::vector<Eigen::Index> places(own.begin(), own.end());
  const Eigen::MatrixXd prior = studied.composition.prior_precision()(places, places);
  Eigen::VectorXd off(prior.rows());
  for (std::size_t i = 0; i < own.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[own[i]];
    off[static_cast<Eigen::Index>(i)] = fit.theta[own[i]] - number.theta_of(number.prior_mean);
  }
  Direction direction;
  // Adding a number x with columns C beside the same column under a prior equals dropping it.
  direction.columns = fit.jacobian(Eigen::all, places);
  // Against the prior's pull, with which the data are in balance.
  direction.pull = prior * off;
  return direction;
}

Direction added(const Candidate& candidate, const Studied& studied, const Campaign& campaign,
                ShotResiduals& residuals, std::size_t worker) {
  const Composition composition(with(studied.model, candidate, Auxiliaries::held), campaign);
  const std::vector<double> theta = carry(studied.composition, studied.fit.theta, composition);
  Direction direction;
  direction.columns = derivatives(composition, residuals, theta, studied.fit.residual,
                                  numbers_of(composition, candidate.id()), serial_on(worker));
  direction.pull = -direction.columns.transpose() * studied.fit.residual;
  return direction;
}

}  // namespace

Direction direction_of(const Candidate& candidate, const Studied& studied, const Campaign& campaign,
                       ShotResiduals& residuals, std::size_t worker) {
  const ModelFit& fit = studied.fit;
  Direction direction = candidate.frees_prior
                            ? freed_of_prior(candidate, studied)
                            : added(candidate, studied, campaign, residuals, worker);
  direction.model_share = fit.jacobian.transpose() * direction.columns;
  direction.unprojected = direction.columns.transpose() * direction.columns;
  direction.information = direction.unprojected - direction.model_share.transpose() *
                                                      fit.covariance * direction.model_share;
  const auto count = direction.information.rows();
  direction.freedom = static_cast<double>(count);
  // What the model takes up to rounding is not there to be tested.
  constexpr double kAbsorbed = 1e-6;
  Eigen::MatrixXd information = direction.information;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (information(i, i) <= kAbsorbed * direction.unprojected(i, i)) {
      information.row(i).setZero();
      information.col(i).setZero();
      direction.freedom -= 1.0;
    }
  }
  direction.step = least_norm_solution(information, direction.pull);
  if (candidate.signs == Signs::one && count > 0) {
    const EffectParameter& p = candidate.use.effect->about().parameters.front();
    const bool up = p.null_value <= p.lower;
    if ((direction.step[0] < 0.0) == up) {
      direction.step.setZero();
    }
  }
  direction.gain = direction.freedom > 0.0 ? 2.0 * direction.pull.dot(direction.step) -
                                                 direction.step.dot(information * direction.step)
                                           : 0.0;
  return direction;
}

}  // namespace kolsky
