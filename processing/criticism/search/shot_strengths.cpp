#include "processing/criticism/search/shot_strengths.hpp"

#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

double ShotStrengths::departure_from(const std::vector<double>& like) const {
  double cross = 0.0;
  double square = 0.0;
  double all = 0.0;
  for (std::size_t n = 0; n < weight.size(); ++n) {
    cross += weight[n] * like[n] * over_common[n];
    square += weight[n] * like[n] * like[n];
    all += weight[n] * over_common[n] * over_common[n];
  }
  return square > 0.0 ? all - cross * cross / square : all;
}

double ShotStrengths::disagreement() const {
  return departure_from(std::vector<double>(weight.size(), 1.0));
}

double ShotStrengths::freedom() const {
  return weight.empty() ? 1.0 : static_cast<double>(weight.size()) - 1.0;
}

bool is_addition(const Effect& effect) {
  return effect.about().stage == Stage::record && effect.about().per_shot;
}

double belief_in(const Effect& effect) {
  return is_addition(effect) ? 3.0 : 20.0;
}

double belief_in(const Effect& effect, const GaugeNoise& noise, std::size_t shots) {
  constexpr double kSteep = 0.5;  // slow noise is most of it
  constexpr double kMost = 100.0;
  // Of additions, which stand where slow noise does: a little of it lies all at their frequencies.
  constexpr double kHardlySteep = 0.9;
  constexpr double kMostOfSlow = 20.0;
  const double least = belief_in(effect);
  if (shots < 3) {
    return least;
  }
  const double steep = is_addition(effect) ? kHardlySteep : kSteep;
  const double most = is_addition(effect) ? kMostOfSlow : kMost;
  const double flat = std::clamp((noise.flatness() - steep) / (1.0 - steep), 0.0, 1.0);
  return least + flat * (most - least);
}

double scatter_over_noise(const Studied& studied, const std::string& id, std::size_t per_shot) {
  const Effect& effect = *studied.model.find(id)->effect;
  const double belief = belief_in(effect);
  const ShotStrengths shots = shot_strengths(studied, id, per_shot);
  const double q = shots.disagreement();
  constexpr double kOrdinary = -4.6;
  if (!is_addition(effect) && log_chi2_tail(q, shots.freedom()) > kOrdinary) {
    return 1.0;  // chance alone must not rank rivals
  }
  return std::max(1.0, (belief + q) / (belief + shots.freedom()));
}

ShotStrengths shot_strengths(const Studied& studied, const std::string& id, std::size_t per_shot) {
  const ModelFit& fit = studied.fit;
  std::vector<Eigen::Index> own;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    const EffectUse& use = studied.composition.uses()[number.use];
    if (use.id() == id && number.shot < 0 &&
        !use.effect->about().parameters[number.parameter].auxiliary()) {
      own.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const auto size = static_cast<Eigen::Index>(per_shot);
  const Eigen::Index shots = fit.residual.size() / size;
  if (own.empty() || shots < 3) {
    return {};
  }
  // What its strengths add to the residuals, clear of the other numbers, over all shots.
  Eigen::VectorXd clear = Eigen::VectorXd::Zero(fit.residual.size());
  Eigen::MatrixXd rest = fit.information;
  for (const Eigen::Index column : own) {
    const FreeNumber& number = studied.composition.numbers()[static_cast<std::size_t>(column)];
    const EffectUse& use = studied.composition.uses()[number.use];
    const double null_value = use.effect->about().parameters[number.parameter].null_value;
    const double strength =
        fit.theta[static_cast<std::size_t>(column)] - number.theta_of(null_value);
    clear += strength * fit.jacobian.col(column);
    rest.row(column).setZero();
    rest.col(column).setZero();
    rest(column, column) = 1.0;
  }
  Eigen::VectorXd share = fit.jacobian.transpose() * clear;
  for (const Eigen::Index column : own) {
    share[column] = 0.0;
  }
  clear -= fit.jacobian * solve_symmetric(rest, share);
  ShotStrengths list;
  const double noise = std::max(1.0, studied.misfit.noise_scale);
  for (Eigen::Index n = 0; n < shots; ++n) {
    const auto part = clear.segment(n * size, size);
    const double information = part.squaredNorm();
    const double pull = part.dot(fit.residual.segment(n * size, size));
    list.over_common.push_back(information > 0.0 ? 1.0 - pull / information : 1.0);
    list.weight.push_back(information / noise);
  }
  return list;
}

bool shots_agree(const Studied& studied, double gain, const std::string& id,
                 const Campaign& campaign, std::size_t per_shot) {
  constexpr double kChance = -9.2;
  constexpr double kPart = 0.02;
  const ShotStrengths shots = shot_strengths(studied, id, per_shot);
  const double q = shots.disagreement();
  if (log_chi2_tail(q, shots.freedom()) > kChance || q < kPart * gain) {
    return true;
  }
  std::vector<double> peaks;
  for (const CampaignShot& shot : campaign.shots) {
    peaks.push_back(shot.facts.peak_strain);
  }
  const double departure = shots.departure_from(peaks);
  constexpr double kSquare = 9.0;
  return studied.model.find(id)->effect->about().per_shot &&
         q - departure < kSquare * departure / shots.freedom();
}

}  // namespace kolsky
