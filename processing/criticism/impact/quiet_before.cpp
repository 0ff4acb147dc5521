#include "processing/criticism/impact/quiet_before.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/algebra/algebra.hpp"
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

/// What an effect adds to a shot's records, by gauge; empty where nothing.
std::vector<std::vector<double>> added_by(const EffectUse& use, const Composition& composition,
                                          const std::vector<double>& theta,
                                          const Campaign& campaign, std::size_t n) {
  Scene scene(campaign.bench, campaign.shots[n].facts, {});
  scene.record.additions.resize(campaign.gauges());
  for (const AppliedEffect& own : composition.applied(theta, n)) {
    if (own.effect == use.effect &&
        (!use.effect->about().per_gauge || campaign.bench.gauges[own.gauge].name == use.gauge)) {
      own.effect->apply(scene, own.values, own.gauge);
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

/// By columns: what each strength adds to a shot's records, what all of them add.
std::vector<std::vector<std::vector<double>>> additions_of(const EffectUse& use,
                                                           const std::vector<Eigen::Index>& own,
                                                           const Studied& studied,
                                                           const Campaign& campaign,
                                                           std::size_t n) {
  const std::vector<double>& theta = studied.fit.theta;
  std::vector<std::vector<std::vector<double>>> columns;
  std::vector<double> none = theta;
  for (const Eigen::Index i : own) {
    const auto at = static_cast<std::size_t>(i);
    none[at] = studied.composition.numbers()[at].theta_of(0.0);
  }
  for (const Eigen::Index i : own) {
    std::vector<double> one = none;
    one[static_cast<std::size_t>(i)] += 1.0;
    columns.push_back(added_by(use, studied.composition, one, campaign, n));
  }
  columns.push_back(added_by(use, studied.composition, theta, campaign, n));
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
    const auto columns = additions_of(use, own, studied, campaign, n);
    const auto count = static_cast<Eigen::Index>(places.size());
    for (std::size_t j = 0; j < campaign.gauges() && places.size() > 2; ++j) {
      if (columns.back()[j].empty()) {
        continue;
      }
      Eigen::MatrixXd all(count, static_cast<Eigen::Index>(own.size()) + 2);
      const auto fill = [&](Eigen::Index column, const std::vector<double>& samples) {
        for (Eigen::Index i = 0; i < count; ++i) {
          all(i, column) = samples.empty() ? 0.0 : samples[places[static_cast<std::size_t>(i)]];
        }
      };
      const auto low_passed = [&](const std::vector<double>& samples) {
        return samples.empty()
                   ? samples
                   : impact::low_passed(samples, records.sample_period_s, records.window.cutoff_Hz);
      };
      fill(0, records.low_passed[n][j]);
      fill(1, low_passed(columns.back()[j]));
      for (std::size_t a = 0; a < own.size(); ++a) {
        fill(static_cast<Eigen::Index>(a) + 2, low_passed(columns[a][j]));
      }
      append(white(all, noise_among(records.noise[j], count)), quiet);
    }
  }
  return quiet;
}

/// Takes what is added where quiet and pulses together have it, as far as the pulses leave it open:
/// within 400 us a hum's slope is known and its size is not.
/// @param covariance  of the strengths, by the pulses
/// @return how many strengths the quiet had to say
double take_from_quiet(const Eigen::MatrixXd& covariance, Quiet& quiet) {
  const Eigen::MatrixXd told = quiet.strengths.transpose() * quiet.strengths;
  const Eigen::MatrixXd both = inverse_of(covariance) + told;
  const Eigen::VectorXd off =
      solve_symmetric(both, quiet.strengths.transpose() * (quiet.record - quiet.added));
  quiet.added += quiet.strengths * off;
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
  const bool open = !own.empty() && studied.fit.covariance.size() > 0;
  const double taken = open ? take_from_quiet(studied.fit.covariance(own, own), quiet) : 0.0;
  constexpr double kOff = 0.5;
  constexpr double kDeviations = 4.0;
  const double square = quiet.added.squaredNorm();
  const double share = quiet.added.dot(quiet.record) / square;
  const double left = (quiet.record - share * quiet.added).squaredNorm() /
                      std::max(1.0, quiet.freedom - 1.0 - taken);
  const double shown = share * share * square / std::max(1.0, left);
  return std::abs(share - 1.0) < kOff && shown > kDeviations * kDeviations + taken;
}

}  // namespace kolsky
