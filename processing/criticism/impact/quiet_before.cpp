#include "processing/criticism/impact/quiet_before.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/impact/filter.hpp"

namespace kolsky {

namespace {

/// Sums over all stretches of quiet: of records r and additions a, by the noise.
struct Sums {
  double aa = 0.0;
  double ar = 0.0;
  double rr = 0.0;
  double freedom = 0.0;
};

/// What an effect adds to a shot's records, by gauge; empty where nothing.
std::vector<std::vector<double>> added_by(const EffectUse& use, const Studied& studied,
                                          const Campaign& campaign, std::size_t n) {
  Scene scene(campaign.bench, campaign.shots[n].facts, {});
  scene.record.additions.resize(campaign.gauges());
  for (const AppliedEffect& own : studied.composition.applied(studied.fit.theta, n)) {
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

void add(const std::vector<double>& record, const std::vector<double>& addition,
         const std::vector<std::size_t>& places, const std::vector<double>& covariance,
         Sums& sums) {
  const auto count = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd both(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t place = places[static_cast<std::size_t>(i)];
    both(i, 0) = record[place];
    both(i, 1) = addition[place];
  }
  both = white(both, noise_among(covariance, count));
  sums.rr += both.col(0).squaredNorm();
  sums.ar += both.col(0).dot(both.col(1));
  sums.aa += both.col(1).squaredNorm();
  sums.freedom += static_cast<double>(count) - 1.0;
}

}  // namespace

bool stands_before_pulse(const Studied& studied, const std::string& id,
                         const ImpactResiduals& residuals) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || !is_addition(*use->effect)) {
    return true;
  }
  const ImpactRecords& records = residuals.records();
  const Campaign& campaign = residuals.campaign();
  Sums sums;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const auto places = quiet_places(records, campaign.shots[n].quiet_samples);
    const auto additions = added_by(*use, studied, campaign, n);
    for (std::size_t j = 0; j < campaign.gauges() && places.size() > 2; ++j) {
      if (!additions[j].empty()) {
        add(records.low_passed[n][j],
            impact::low_passed(additions[j], records.sample_period_s, records.window.cutoff_Hz),
            places, records.noise[j], sums);
      }
    }
  }
  if (!(sums.aa > 0.0) || sums.freedom < 2.0) {
    return false;
  }
  constexpr double kOff = 0.5;
  constexpr double kDeviations = 4.0;
  const double share = sums.ar / sums.aa;
  const double left = std::max(0.0, sums.rr - share * sums.ar) / (sums.freedom - 1.0);
  const double sd = std::sqrt(std::max(1.0, left) / sums.aa);
  return std::abs(share - 1.0) < kOff && share > kDeviations * sd;
}

}  // namespace kolsky
