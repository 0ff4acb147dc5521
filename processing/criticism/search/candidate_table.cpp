#include "processing/criticism/search/candidate_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/amplitude_over_shots.hpp"
#include "processing/criticism/search/search_trials.hpp"
#include "processing/criticism/search/shot_strengths.hpp"

namespace kolsky {

namespace {

constexpr double kToldApart = 5.0;  ///< sigma beside a rival

/// Which number an effect is told by: its strength, or where only others are free, as where a
/// specimen's diameter alone is filed with a deviation, the first of these.
std::size_t told_by(const EffectUse& use) {
  const EffectAbout& about = use.effect->about();
  std::size_t at = about.strength;
  for (std::size_t p = 0; p < use.values.size() && !use.values[at].free; ++p) {
    at = use.values[p].free && !about.parameters[p].auxiliary() ? p : at;
  }
  return at;
}

const EffectParameter& told(const Candidate& candidate) {
  return candidate.use.effect->about().parameters[told_by(candidate.use)];
}

/// What a step of one is in a strength's unit. Of an amplitude, cosine and sine.
double step_of(const Candidate& candidate) {
  const EffectAbout& about = candidate.use.effect->about();
  const double scale = scale_of(candidate.use.values[told_by(candidate.use)], told(candidate));
  return about.quadrature ? scale * std::numbers::sqrt2 : scale;
}

/// What squares of deviates are over.
double doubt(const Tried& tried, std::size_t i) {
  return doubt_of_gain(tried.candidates[i], tried.directions[i], tried.scale);
}

/// The strength that stands at 5 sigma beside whichever other effect resembles it most.
void set_identifiable(const Tried& tried, std::size_t i, double power, CandidateResult& result) {
  const Direction& own = tried.directions[i];
  result.identifiable = result.detectable;
  if (own.information.rows() != 1) {
    return;
  }
  double closest = 0.0;
  for (std::size_t k = 0; k < tried.directions.size(); ++k) {
    const Direction& other = tried.directions[k];
    if (tried.candidates[k].id() == tried.candidates[i].id() || other.information.rows() != 1 ||
        other.freedom != 1.0) {
      continue;
    }
    // Less what both share through the model's own numbers.
    const double shared =
        tried.base.fit.covariance.size() > 0
            ? own.model_share.col(0).dot(tried.base.fit.covariance * other.model_share.col(0))
            : 0.0;
    const double cross = (own.columns.col(0).dot(other.columns.col(0)) - shared) /
                         std::sqrt(own.information(0, 0) * other.information(0, 0));
    if (cross * cross > closest) {
      closest = std::min(1.0, cross * cross);
      result.nearest_rival = tried.candidates[k].id();
    }
  }
  result.identifiable =
      std::max(result.detectable, result.sd * root(kToldApart * std::sqrt(doubt(tried, i)) /
                                                       std::sqrt(std::max(1e-12, 1.0 - closest)),
                                                   power));
}

/// Where first order says the strength is, in its unit, and the gain there.
struct Place {
  double strength = 0.0;
  double gain = 0.0;
};

/// How far a step of several strengths may go until one of them is at its bound. Where the model
/// takes up nearly all that they do together, the best of first order is beyond all measure.
double share_in_bounds(const EffectUse& use, const Eigen::VectorXd& step) {
  const std::vector<EffectParameter>& parameters = use.effect->about().parameters;
  std::vector<std::size_t> strengths;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!parameters[p].auxiliary()) {
      strengths.push_back(p);
    }
  }
  if (static_cast<Eigen::Index>(strengths.size()) != step.size()) {
    return 1.0;  // strengths of every shot or gauge, which a prior bounds
  }
  double share = 1.0;
  for (std::size_t k = 0; k < strengths.size(); ++k) {
    const EffectParameter& own = parameters[strengths[k]];
    const double off = scale_of(use.values[strengths[k]], own) * step[static_cast<Eigen::Index>(k)];
    const double room = off > 0.0 ? own.upper - own.null_value : own.null_value - own.lower;
    share = std::abs(off) > room ? std::min(share, room / std::abs(off)) : share;
  }
  return share;
}

/// Strengths within their bounds: the line that first order is may lead out of them. Of several
/// numbers their root mean square.
Place place_of(const Tried& tried, std::size_t i) {
  const Candidate& candidate = tried.candidates[i];
  const Direction& direction = tried.directions[i];
  const EffectParameter& parameter = told(candidate);
  const double scale = step_of(candidate);
  const auto numbers = direction.step.size();
  if (numbers > 1) {
    const double share = share_in_bounds(candidate.use, direction.step);
    const double step = share * direction.step.norm() / std::sqrt(static_cast<double>(numbers));
    return {parameter.null_value + scale * root(step, parameter.power),
            direction.gain * share * (2.0 - share)};
  }
  const double off = scale * root(direction.step[0], parameter.power);
  const double strength =
      std::clamp(parameter.null_value + off, std::min(parameter.lower, parameter.null_value),
                 std::max(parameter.upper, parameter.null_value));
  if (candidate.frees_prior || strength == parameter.null_value + off) {
    return {parameter.null_value + off, direction.gain};
  }
  // A parabola in the step, the best of which is beyond the bound.
  const double share = std::pow(std::abs((strength - parameter.null_value) / off), parameter.power);
  return {strength, direction.gain * share * (2.0 - share)};
}

/// ln of the chance of a candidate's gain at first order. One that has one sign only has a chance
/// above one half where the records ask for the other.
double first_order_log_p(const Tried& tried, std::size_t i) {
  const Direction& direction = tried.directions[i];
  if (!(direction.freedom > 0.0)) {
    return 0.0;
  }
  const auto two_sided = [&](double gain) {
    const double over = gain / doubt(tried, i);
    return tried.known.empty()
               ? log_gain_tail(over, direction.freedom, Signs::both)
               : log_f_tail(over / direction.freedom, direction.freedom, tried.known[i]);
  };
  const Candidate& candidate = tried.candidates[i];
  if (candidate.signs == Signs::both || direction.information.rows() != 1) {
    return two_sided(place_of(tried, i).gain);
  }
  const EffectParameter& strength = candidate.use.effect->about().parameters.front();
  const bool up = strength.null_value <= strength.lower;
  const bool asked = (direction.pull[0] > 0.0) == up;
  const double both =
      two_sided(asked ? place_of(tried, i).gain
                      : direction.pull[0] * direction.pull[0] / direction.information(0, 0));
  return asked ? both - std::log(2.0) : std::log1p(-0.5 * std::exp(both));
}

/// Chances of an effect, of whose variants the best counts: by itself, and among all that was
/// tried.
void set_chances(const Tried& tried, const std::vector<std::size_t>& variants,
                 CandidateResult& result) {
  double least = 0.0;
  for (const std::size_t i : variants) {
    least = std::min(least, first_order_log_p(tried, i));
  }
  const double trials = variants.size() > 1 ? independent_trials(tried.base, tried.candidates,
                                                                 tried.directions, variants)
                                            : 1.0;
  constexpr double kTiny = -20.0;
  result.own_log_p = least < kTiny ? least + std::log(trials)
                                   : std::log(-std::expm1(trials * std::log1p(-std::exp(least))));
  result.log_p = std::min(0.0, least + std::max(std::log(trials), tried.log_trials));
}

/// A candidate's column less what the model's own numbers take up of it.
Eigen::VectorXd clear_column(const Tried& tried, const Direction& direction) {
  const ModelFit& fit = tried.base.fit;
  Eigen::VectorXd column = direction.columns.col(0);
  if (fit.jacobian.cols() > 0) {
    column -= fit.jacobian * (fit.covariance * direction.model_share.col(0));
  }
  return column;
}

/// What a strength common to all shots gains on each of them, found in the others: first order, the
/// model's own numbers where they are.
double foretold_gain(const Tried& tried, std::size_t i) {
  const Direction& direction = tried.directions[i];
  const auto size = static_cast<Eigen::Index>(tried.residuals_per_shot);
  const bool common = direction.freedom == 1.0 && direction.information.rows() == 1 &&
                      !tried.candidates[i].frees_prior && !tried.candidates[i].use.per_shot;
  const Eigen::VectorXd& residual = tried.base.fit.residual;
  if (!common || size == 0 || residual.size() < 2 * size) {
    return 0.0;
  }
  const Eigen::VectorXd column = clear_column(tried, direction);
  const Eigen::Index shots = residual.size() / size;
  Eigen::VectorXd pull(shots);
  Eigen::VectorXd information(shots);
  for (Eigen::Index n = 0; n < shots; ++n) {
    const auto own = column.segment(n * size, size);
    pull[n] = -own.dot(residual.segment(n * size, size));
    information[n] = own.squaredNorm();
  }
  const EffectParameter& parameter = tried.candidates[i].use.effect->about().parameters.front();
  const double side = parameter.null_value <= parameter.lower ? 1.0 : -1.0;
  double gain = 0.0;
  for (Eigen::Index n = 0; n < shots; ++n) {
    const double others = information.sum() - information[n];
    double strength = others > 0.0 ? (pull.sum() - pull[n]) / others : 0.0;
    if (tried.candidates[i].signs == Signs::one && side * strength < 0.0) {
      strength = 0.0;
    }
    gain += strength * (2.0 * pull[n] - strength * information[n]);
  }
  return gain;
}

/// Root mean square over shots and gauges of an amplitude in cosine and sine parts.
void set_amplitude(const Studied& studied, const std::string& id, CandidateResult& result) {
  const ModelFit& fit = studied.fit;
  Eigen::VectorXd parts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit.theta.size()));
  double scale = 1.0;
  double count = 0.0;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.parameter < 2 && studied.composition.uses()[number.use].id() == id) {
      parts[static_cast<Eigen::Index>(i)] = fit.theta[i];
      scale = number.scale;
      count += number.parameter == 0 ? 1.0 : 0.0;
    }
  }
  const double amplitude = count > 0.0 ? std::sqrt(parts.squaredNorm() / count) : 0.0;
  result.strength = scale * amplitude;
  if (amplitude > 0.0) {
    result.sd = scale * std::sqrt(parts.dot(fit.covariance * parts)) / (count * amplitude);
  }
}

/// Root mean square of strengths that shots have of their own, about none, without what their
/// deviations add to it, and of the sign of their sum where that is known: a mean of slopes to
/// either side would say that there is none.
void set_over_shots(const Studied& studied, const std::string& id, CandidateResult& result) {
  const ModelFit& fit = studied.fit;
  const EffectUse& use = *studied.model.find(id);
  const std::size_t strength = use.effect->about().strength;
  const double null_value = use.effect->about().parameters[strength].null_value;
  Eigen::VectorXd off = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit.theta.size()));
  Eigen::VectorXd own = off;
  double scale = 1.0;
  double count = 0.0;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.shot >= 0 && number.parameter == strength && number.power == 1.0 &&
        studied.composition.uses()[number.use].id() == id) {
      off[static_cast<Eigen::Index>(i)] = fit.theta[i] - number.theta_of(null_value);
      own[static_cast<Eigen::Index>(i)] = 1.0;
      scale = number.scale;
      count += 1.0;
    }
  }
  const double by_noise = own.dot(fit.covariance.diagonal());
  const double size = std::sqrt(std::max(0.0, off.squaredNorm() - by_noise) / std::max(1.0, count));
  if (size > 0.0) {
    const bool known = off.sum() * off.sum() > own.dot(fit.covariance * own);
    result.strength = null_value + (known ? std::copysign(scale * size, off.sum()) : scale * size);
    result.sd = scale * std::sqrt(off.dot(fit.covariance * off)) / (count * size);
  }
}

}  // namespace

double within_reach(const Candidate& candidate, double size) {
  const EffectParameter& own = told(candidate);
  const double reach = std::max(own.upper - own.null_value, own.null_value - own.lower);
  return candidate.frees_prior || size <= reach ? size : INFINITY;
}

namespace {

/// Strength of an effect as one of its variants has it. One of several numbers counts by their root
/// mean square, and is as uncertain as all of them tell together.
CandidateResult first_order_result(const Tried& tried, std::size_t i) {
  const Candidate& candidate = tried.candidates[i];
  const Direction& direction = tried.directions[i];
  const EffectAbout& about = candidate.use.effect->about();
  const EffectParameter& parameter = told(candidate);
  CandidateResult result;
  result.effect = candidate.id();
  result.parameter = about.quadrature ? "A" : parameter.name;
  result.unit = parameter.unit;
  result.per_shot = candidate.use.per_shot;
  if (!(direction.freedom > 0.0) || direction.information.rows() == 0) {
    result.detectable = result.identifiable = INFINITY;
    // Nothing is known of it but its bounds: the deviation of an even distribution between them.
    result.strength = parameter.null_value;
    result.sd = (parameter.upper - parameter.lower) / std::sqrt(12.0);
    result.verdict = CandidateVerdict::untestable;
    return result;
  }
  const double scale = step_of(candidate);
  const Place place = place_of(tried, i);
  const double sd = 1.0 / std::sqrt(direction.information.trace());
  result.gain = place.gain;
  result.held_out_gain = foretold_gain(tried, i);
  result.strength = place.strength;
  result.sd = scale * root(sd, parameter.power);
  result.detectable = scale * root(kDetected * std::sqrt(doubt(tried, i)) * sd, parameter.power);
  set_identifiable(tried, i, parameter.power, result);
  result.detectable = within_reach(candidate, result.detectable);
  result.identifiable = within_reach(candidate, result.identifiable);
  result.verdict = CandidateVerdict::not_needed;
  return result;
}

/// The variant that noise makes least likely, and of those as likely the one that gains most.
std::size_t best_variant(const Tried& tried, const std::vector<std::size_t>& variants) {
  return *std::ranges::min_element(variants, {}, [&](std::size_t i) {
    return std::pair(first_order_log_p(tried, i), -tried.directions[i].gain);
  });
}

}  // namespace

std::vector<CandidateResult> first_order_table(const Tried& tried) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<std::size_t>> variants;
  for (std::size_t i = 0; i < tried.candidates.size(); ++i) {
    const std::string id = tried.candidates[i].id();
    if (variants[id].empty()) {
      order.push_back(id);
    }
    variants[id].push_back(i);
  }
  std::vector<CandidateResult> table;
  for (const std::string& id : order) {
    CandidateResult result = first_order_result(tried, best_variant(tried, variants[id]));
    if (result.verdict != CandidateVerdict::untestable) {
      set_chances(tried, variants[id], result);
    }
    table.push_back(std::move(result));
  }
  return table;
}

void note_refits(const Search& search, const std::vector<Refit>& refits,
                 const std::vector<Certification>& held_out, const std::vector<std::size_t>& which,
                 std::size_t residuals_per_shot, std::vector<CandidateResult>& table) {
  std::set<std::string> noted;
  for (const std::size_t i : which) {
    const Refit& refit = refits[i];
    const Candidate& candidate = search.candidates()[refit.candidate];
    const auto result = std::ranges::find(table, candidate.id(), &CandidateResult::effect);
    if (result == table.end() || !noted.insert(candidate.id()).second) {
      continue;
    }
    result->gain = refit.over_noise;
    result->log_p = search.with_search(refit.log_p);
    result->own_log_p = search.without_search(refit);
    result->held_out_gain = refit.beside * held_out[i].gain;
    result->refitted = true;
    result->per_shot = candidate.use.per_shot;
    set_strength(refit.studied, result->effect, residuals_per_shot, *result);
  }
}

void set_strength(const Studied& studied, const std::string& id, CandidateResult& result) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || use->values.empty()) {
    return;
  }
  const auto& parameters = use->effect->about().parameters;
  const std::size_t at = told_by(*use);
  result.parameter = parameters[at].name;
  result.unit = parameters[at].unit;
  result.strength = use->values[at].value;
  result.sd = use->values[at].sd;
  if (use->effect->about().quadrature) {
    result.parameter = "A";
    if (use->alike && use->per_shot) {
      // One that is the same at all gauges is the same in all shots, too.
      const Amplitude amplitude = amplitude_over_shots(studied, id);
      result.strength = amplitude.value;
      result.sd = amplitude.sd;
    } else {
      set_amplitude(studied, id, result);
    }
  } else if (use->per_shot) {
    set_over_shots(studied, id, result);
  }
}

void set_strength(const Studied& studied, const std::string& id, std::size_t residuals_per_shot,
                  CandidateResult& result) {
  set_strength(studied, id, result);
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr) {
    return;
  }
  result.sd *= std::sqrt(scatter_over_noise(studied, id, residuals_per_shot) *
                         std::max(1.0, studied.misfit.noise_scale));
  if (use->effect->about().quadrature && result.sd > 0.0) {
    // First order speaks of single cosines and sines, a refit of their amplitude.
    result.detectable = result.identifiable = kDetected * result.sd;
  }
}

}  // namespace kolsky
