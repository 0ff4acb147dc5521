#include "processing/criticism/impact/quiet_before.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/impact/filter.hpp"

namespace kolsky {

namespace {

/// All stretches of quiet, one below the other and by their noise.
struct Quiet {
  Eigen::VectorXd record;
  Eigen::VectorXd added;      ///< as fitted to the pulses
  Eigen::MatrixXd strengths;  ///< what each strength of the effect adds, in its scale
  double freedom = 0.0;
};

using Additions = std::vector<std::vector<double>>;  ///< by gauge; empty where nothing

enum class Added { by_it, by_others };

/// What an effect, or all others, add to a shot's records.
Additions additions(Added added, const EffectUse& use, const Composition& composition,
                    const std::vector<double>& theta, const Campaign& campaign, std::size_t n) {
  Scene scene(campaign.bench, campaign.shots[n].facts, {});
  scene.record.additions.resize(campaign.gauges());
  for (const AppliedEffect& one : composition.applied(theta, n)) {
    const bool its =
        one.effect == use.effect &&
        (!use.effect->about().per_gauge || campaign.bench.gauges[one.gauge].name == use.gauge);
    if (is_addition(*one.effect) && its == (added == Added::by_it)) {
      one.effect->apply(scene, one.values, one.gauge);
    }
  }
  return std::move(scene.record.additions);
}

/// Samples of the quiet that are clear of the record's beginning and of the pulse's foot by what
/// the low-pass reaches, as far apart as judged ones.
std::vector<std::size_t> quiet_places(const ImpactRecords& records, std::size_t quiet) {
  const double step = records.window.period_s / records.sample_period_s;
  constexpr double kReach = 4.0;  // deviations of its weights
  const double edge =
      kReach * impact::low_pass_sigma_s(records.window.cutoff_Hz) / records.sample_period_s;
  std::vector<std::size_t> places;
  for (double place = edge; place + edge < static_cast<double>(quiet); place += step) {
    places.push_back(static_cast<std::size_t>(place));
  }
  return places;
}

Eigen::MatrixXd noise_among(const std::vector<double>& covariance, Eigen::Index count) {
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) {
      if (const auto lag = static_cast<std::size_t>(std::abs(a - b)); lag < covariance.size()) {
        noise(a, b) = covariance[lag];
      }
    }
  }
  return noise;
}

/// Whitened with the noise, the mean taken off.
Eigen::MatrixXd white(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& noise) {
  const Eigen::MatrixXd root = symmetric_power(noise, -0.5);
  const Eigen::VectorXd mean = (root * Eigen::VectorXd::Ones(noise.rows())).normalized();
  const Eigen::MatrixXd out = root * columns;
  return out - mean * (mean.transpose() * out);
}

/// Strengths of an effect among a composition's numbers.
std::vector<Eigen::Index> strengths_of(const std::string& id, const Composition& composition) {
  std::vector<Eigen::Index> own;
  for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    const EffectUse& use = composition.uses()[number.use];
    if (use.id() == id && !use.effect->about().parameters[number.parameter].auxiliary()) {
      own.push_back(static_cast<Eigen::Index>(i));
    }
  }
  return own;
}

/// What each strength adds to a shot's records, in its scale.
std::vector<Additions> of_strengths(const EffectUse& use, const std::vector<Eigen::Index>& own,
                                    const Studied& studied, const Campaign& campaign,
                                    std::size_t n) {
  const std::vector<double>& theta = studied.fit.theta;
  std::vector<Additions> columns;
  std::vector<double> none = theta;
  for (const Eigen::Index i : own) {
    const auto at = static_cast<std::size_t>(i);
    none[at] = studied.composition.numbers()[at].theta_of(0.0);
  }
  for (const Eigen::Index i : own) {
    std::vector<double> one = none;
    one[static_cast<std::size_t>(i)] += 1.0;
    columns.push_back(additions(Added::by_it, use, studied.composition, one, campaign, n));
  }
  return columns;
}

void append(const Eigen::MatrixXd& white, Quiet& quiet) {
  const Eigen::Index rows = quiet.record.size() + white.rows();
  const Eigen::Index strengths = white.cols() - 2;
  quiet.record.conservativeResize(rows);
  quiet.added.conservativeResize(rows);
  quiet.strengths.conservativeResize(rows, strengths);
  quiet.record.tail(white.rows()) = white.col(0);
  quiet.added.tail(white.rows()) = white.col(1);
  quiet.strengths.bottomRows(white.rows()) = white.rightCols(strengths);
  quiet.freedom += static_cast<double>(white.rows()) - 1.0;
}

Quiet quiet_of(const EffectUse& use, const std::vector<Eigen::Index>& own, const Studied& studied,
               const ImpactResiduals& residuals) {
  const ImpactRecords& records = residuals.records();
  const Campaign& campaign = residuals.campaign();
  Quiet quiet;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const auto places = quiet_places(records, campaign.shots[n].quiet_samples);
    const auto count = static_cast<Eigen::Index>(places.size());
    const auto all_of = [&](Added added) {
      return additions(added, use, studied.composition, studied.fit.theta, campaign, n);
    };
    const Additions its = all_of(Added::by_it);
    const Additions of_others = all_of(Added::by_others);
    const std::vector<Additions> strengths = of_strengths(use, own, studied, campaign, n);
    const auto at_places = [&](const std::vector<double>& low_passed) {
      Eigen::VectorXd column(count);
      for (Eigen::Index i = 0; i < count; ++i) {
        column[i] = low_passed[places[static_cast<std::size_t>(i)]];
      }
      return column;
    };
    const auto added = [&](const std::vector<double>& samples) -> Eigen::VectorXd {
      return samples.empty() ? Eigen::VectorXd(Eigen::VectorXd::Zero(count))
                             : at_places(impact::low_passed(samples, records.sample_period_s,
                                                            records.window.cutoff_Hz));
    };
    for (std::size_t j = 0; j < campaign.gauges() && places.size() > 2; ++j) {
      if (its[j].empty()) {
        continue;
      }
      Eigen::MatrixXd columns(count, static_cast<Eigen::Index>(own.size()) + 2);
      columns.col(0) = at_places(records.low_passed[n][j]) - added(of_others[j]);
      columns.col(1) = added(its[j]);
      for (std::size_t a = 0; a < own.size(); ++a) {
        columns.col(static_cast<Eigen::Index>(a) + 2) = added(strengths[a][j]);
      }
      append(white(columns, noise_among(records.noise[j], count)), quiet);
    }
  }
  return quiet;
}

/// Whether what is added stands in the quiet as it is, its strengths as they are fitted.
/// @param told  how many of these the quiet had to tell
bool stands_in(const Quiet& quiet, double told) {
  constexpr double kOff = 0.5;
  constexpr double kByChance = -9.7;  ///< ln of the chance of four deviations
  const double square = quiet.added.squaredNorm();
  const double share = quiet.added.dot(quiet.record) / square;
  const double left = (quiet.record - share * quiet.added).squaredNorm() /
                      std::max(1.0, quiet.freedom - 1.0 - told);
  return std::abs(share - 1.0) < kOff && share > 0.0 &&
         log_chi2_tail(share * share * square / std::max(1.0, left), 1.0 + told) < kByChance;
}

/// Takes what is added where quiet and pulses together have it: within 400 us of a pulse a hum's
/// slope is known and its size is not.
/// @param covariance  of the strengths, by the pulses
/// @return how many strengths the quiet had to tell; nothing where the two contradict each other
std::optional<double> take_from_quiet(const Eigen::MatrixXd& covariance, Quiet& quiet) {
  constexpr double kByChance = -9.2;
  const Eigen::MatrixXd told = quiet.strengths.transpose() * quiet.strengths;
  const Eigen::VectorXd pull = quiet.strengths.transpose() * (quiet.record - quiet.added);
  const Eigen::VectorXd apart = least_norm_solution(told + told * covariance * told, pull);
  if (log_chi2_tail(pull.dot(apart), static_cast<double>(pull.size())) < kByChance) {
    return std::nullopt;
  }
  const Eigen::MatrixXd both = inverse_of(covariance) + told;
  quiet.added += quiet.strengths * solve_symmetric(both, pull);
  return (inverse_of(both) * told).trace();
}

}  // namespace

bool stands_before_pulse(const Studied& studied, const std::string& id,
                         const ImpactResiduals& residuals) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || !is_addition(*use->effect)) {
    return true;
  }
  const std::vector<Eigen::Index> own = strengths_of(id, studied.composition);
  Quiet quiet = quiet_of(*use, own, studied, residuals);
  if (!(quiet.added.squaredNorm() > 0.0) || quiet.freedom < 2.0) {
    return false;
  }
  if (stands_in(quiet, 0.0)) {
    return true;
  }
  const ModelFit& fit = studied.fit;
  if (own.empty() || fit.covariance.size() == 0) {
    return false;
  }
  Eigen::MatrixXd covariance = fit.covariance(own, own);
  if (fit.doubt.size() > 0) {
    covariance += fit.doubt(own, own);
  }
  const auto told = take_from_quiet(covariance, quiet);
  return told && stands_in(quiet, *told);
}

}  // namespace kolsky
