#include "processing/criticism/own_strengths.hpp"

#include <cmath>

namespace kolsky {

namespace {

/// Least-squares slope of a gauge's record over time before the pulse.
double slope_before(const CampaignShot& shot, std::size_t gauge) {
  const auto count = static_cast<double>(shot.quiet_samples);
  double t_mean = 0.0;
  double y_mean = 0.0;
  for (std::size_t n = 0; n < shot.quiet_samples; ++n) {
    t_mean += shot.facts.time_s[n] / count;
    y_mean += shot.strain[gauge][n] / count;
  }
  double cross = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < shot.quiet_samples; ++n) {
    const double t = shot.facts.time_s[n] - t_mean;
    cross += t * (shot.strain[gauge][n] - y_mean);
    square += t * t;
  }
  return cross / square;
}

/// The slopes before the pulses must follow those found: regression through the origin.
bool slopes_agree(const std::vector<double>& found, const std::vector<double>& before) {
  double cross = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    cross += found[n] * before[n];
    square += found[n] * found[n];
  }
  const double share = cross / square;
  double rest = 0.0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const double e = before[n] - share * found[n];
    rest += e * e;
  }
  const double sd = std::sqrt(rest / (static_cast<double>(found.size()) - 1.0) / square);
  constexpr double kSigma = 4.0;
  return found.size() > 2 && share > 0.5 && share < 1.5 && share > kSigma * sd;
}

bool one_phase(Eigen::MatrixXcd amplitudes) {
  // What all gauges have alike the shot's source takes up: it is not there to be judged.
  const Eigen::VectorXcd common = amplitudes.rowwise().mean();
  amplitudes.colwise() -= common;
  const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(amplitudes);
  constexpr double kOfOneProduct = 0.85;
  const double all = svd.singularValues().squaredNorm();
  return amplitudes.cols() > 2 && amplitudes.rows() > 2 &&
         svd.singularValues()[0] * svd.singularValues()[0] > kOfOneProduct * all;
}

}  // namespace

bool own_strengths_confirmed(const Studied& studied, const std::string& id,
                             const Campaign& campaign) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || !use->per_shot) {
    return true;
  }
  // In the order of the composition: by parameter, then shot, then gauge.
  std::vector<std::vector<double>> found(2);
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.shot >= 0 && studied.composition.uses()[number.use].id() == id &&
        number.parameter < found.size()) {
      found[number.parameter].push_back(studied.fit.theta[i] * number.scale);
    }
  }
  const std::size_t shots = campaign.shots.size();
  if (!use->effect->about().each_gauge) {
    std::size_t gauge = 0;
    while (gauge < campaign.gauges() && campaign.bench.gauges[gauge].name != use->gauge) {
      ++gauge;
    }
    std::vector<double> before;
    for (const CampaignShot& shot : campaign.shots) {
      before.push_back(slope_before(shot, gauge));
    }
    return slopes_agree(found[0], before);
  }
  Eigen::MatrixXcd amplitudes(static_cast<Eigen::Index>(shots),
                              static_cast<Eigen::Index>(campaign.gauges()));
  for (std::size_t n = 0; n < shots; ++n) {
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      const std::size_t at = n * campaign.gauges() + j;
      amplitudes(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(j)) = {found[0][at],
                                                                                found[1][at]};
    }
  }
  return one_phase(amplitudes);
}

}  // namespace kolsky
