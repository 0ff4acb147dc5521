#include "processing/criticism/search/slow_noise.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/noise/smooth_power.hpp"
#include "processing/criticism/search/search_trials.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/search/slow_waves.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostBins = 12;
constexpr int kRepeats = 200;
/// Of a gauge's quiet part: slope, bend, turn.
constexpr Eigen::Index kQuietRows = 3;

/// What a record does before its pulse: its part along orthonormal polynomials of order 1 to 3.
Eigen::VectorXd quiet_rows(const CampaignShot& shot, std::span<const double> record) {
  const auto count = static_cast<Eigen::Index>(shot.quiet_samples);
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(kQuietRows);
  if (count <= 4 * kQuietRows) {
    return rows;
  }
  const Eigen::Map<const Eigen::VectorXd> quiet(record.data(), count);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(count, -1.0, 1.0);
  Eigen::VectorXd before = Eigen::VectorXd::Ones(count);
  Eigen::VectorXd legendre = x;
  for (Eigen::Index order = 1; order <= kQuietRows; ++order) {
    const Eigen::VectorXd centred = legendre.array() - legendre.mean();
    rows[order - 1] = centred.dot(quiet) / centred.norm();
    const auto n = static_cast<double>(order);
    const Eigen::VectorXd next =
        ((2.0 * n + 1.0) * x.cwiseProduct(legendre) - n * before) / (n + 1.0);
    before = std::exchange(legendre, next);
  }
  return rows;
}

/// What is added to a shot's records, by gauge; empty where nothing is.
std::vector<std::vector<double>> additions_of(const Composition& composition,
                                              const std::vector<double>& theta,
                                              const Campaign& campaign, std::size_t shot) {
  Scene scene(campaign.bench, campaign.shots[shot].facts, {});
  scene.record.additions.resize(campaign.gauges());
  for (const AppliedEffect& effect : composition.applied(theta, shot)) {
    if (effect.effect->about().stage == Stage::record) {
      effect.effect->apply(scene, effect.values, effect.gauge);
    }
  }
  return std::move(scene.record.additions);
}

/// Of all gauges of a shot, less what is added to them.
Eigen::VectorXd quiet_rows_of(const CampaignShot& shot,
                              std::span<const std::vector<double>> records) {
  Eigen::VectorXd rows =
      Eigen::VectorXd::Zero(kQuietRows * static_cast<Eigen::Index>(records.size()));
  for (std::size_t j = 0; j < records.size(); ++j) {
    if (!records[j].empty()) {
      rows.segment(static_cast<Eigen::Index>(j) * kQuietRows, kQuietRows) =
          quiet_rows(shot, records[j]);
    }
  }
  return rows;
}

/// A wave's unit of power, spread over all frequencies, as variance of each of a record's samples.
double white_per_sample(const JudgedBand& band) {
  return 0.5 * static_cast<double>(band.judged * band.decimation);
}

/// ln of the chance of more than this, of a variable of that mean and variance (a gamma variable).
double log_tail(double value, double mean, double variance) {
  const double scale = variance / mean;
  return log_chi2_tail(2.0 * std::max(value, 0.0) / scale, 2.0 * mean / scale);
}

/// Of the waves, what is looked at: the lowest residuals, and below them the quiet parts.
SlowWaves seen_of(SlowWaves waves, const CampaignShot& shot, Eigen::Index lowest) {
  const std::size_t gauges = waves.at.size();
  for (std::size_t j = 0; j < gauges; ++j) {
    for (std::size_t q = 0; q < waves.at[j].size(); ++q) {
      const Eigen::Index rows = lowest + kQuietRows * static_cast<Eigen::Index>(gauges);
      Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(rows, 2);
      seen.topRows(lowest) = waves.at[j][q].topRows(lowest);
      for (const int part : {0, 1}) {
        seen.col(part).segment(lowest + kQuietRows * static_cast<Eigen::Index>(j), kQuietRows) =
            quiet_rows(shot, wave_of(waves, shot, q, part));
      }
      waves.at[j][q] = std::move(seen);
    }
  }
  return waves;
}

double strengths_of(std::span<const Eigen::MatrixXd> columns) {
  double sum = 0.0;
  for (const Eigen::MatrixXd& own : columns) {
    sum += static_cast<double>(own.cols());
  }
  return sum;
}

}  // namespace

SlowNoise::SlowNoise(const Studied& base, Study& study)
    : base_(base),
      campaign_(study.campaign()),
      per_shot_(static_cast<Eigen::Index>(study.residuals().per_shot())) {
  const WhiteResiduals& residuals = study.residuals();
  const std::size_t bins = std::min(kMostBins, residuals.band().bins_judged);
  lowest_ = static_cast<Eigen::Index>(2 * bins * residuals.others().size());
  rows_ = lowest_ + kQuietRows * static_cast<Eigen::Index>(campaign_.gauges());
  seen_.resize(rows_, static_cast<Eigen::Index>(campaign_.shots.size()));
  for (Eigen::Index n = 0; n < seen_.cols(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    const CampaignShot& shot = campaign_.shots[at];
    seen_.col(n) << base.fit.residual.segment(n * per_shot_, lowest_),
        quiet_rows_of(shot, shot.strain) -
            quiet_rows_of(shot, additions_of(base.composition, base.fit.theta, campaign_, at));
  }

  of_model_ = of_model();

  const std::vector<SmoothPower> spectra = spectra_of_waves(residuals);
  const SlowWaves waves = seen_of(slow_waves(base, study), campaign_.shots.front(), lowest_);
  // Of white noise the quiet parts hold much that is quicker than these waves.
  const Eigen::MatrixXd white =
      parts_of_own(waves, [&](std::size_t j, double) { return spectra[j].white; });
  const SymmetricEigen lowest(white.topRows(lowest_) * white.topRows(lowest_).transpose());
  constexpr double kNothing = 1e-9;
  const Eigen::VectorXd variances =
      lowest.eigenvalues().cwiseMax(kNothing * lowest.eigenvalues().maxCoeff());
  Eigen::MatrixXd whiten = Eigen::MatrixXd::Zero(rows_, rows_);
  whiten.topLeftCorner(lowest_, lowest_) =
      variances.cwiseSqrt().cwiseInverse().asDiagonal() * lowest.eigenvectors().transpose();
  for (Eigen::Index i = lowest_; i < rows_; ++i) {
    const auto j = static_cast<std::size_t>((i - lowest_) / kQuietRows);
    whiten(i, i) = 1.0 / std::sqrt(spectra[j].white * white_per_sample(residuals.band()));
  }
  const auto power = [&](std::size_t j, double f) { return slow_power(spectra[j], f); };
  for (const bool own : {true, false}) {
    const Eigen::MatrixXd parts = own ? parts_of_own(waves, power) : parts_in_common(waves, power);
    const Eigen::MatrixXd slow = parts * parts.transpose();
    const SymmetricEigen both(whiten * slow * whiten.transpose());
    forms_.push_back(
        {own, both.eigenvectors().transpose() * whiten, both.eigenvalues().cwiseMax(0.0)});
  }
}

/// What one more of an addition's number is to what is seen of a shot: in the residuals and, by
/// what it adds there, in the quiet parts.
Eigen::VectorXd SlowNoise::column_of(const Composition& composition,
                                     const std::vector<double>& theta, std::size_t number,
                                     const Eigen::VectorXd& in_residuals) const {
  const std::ptrdiff_t shot = composition.numbers()[number].shot;
  const auto at = static_cast<std::size_t>(shot);
  std::vector<double> moved = theta;
  moved[number] += 1.0;
  Eigen::VectorXd column(rows_);
  column << in_residuals.segment(shot * per_shot_, lowest_),
      quiet_rows_of(campaign_.shots[at], additions_of(composition, theta, campaign_, at)) -
          quiet_rows_of(campaign_.shots[at], additions_of(composition, moved, campaign_, at));
  return column;
}

void SlowNoise::append(Columns& columns, std::ptrdiff_t shot, const Eigen::VectorXd& column) {
  Eigen::MatrixXd& own = columns[static_cast<std::size_t>(shot)];
  own.conservativeResize(Eigen::NoChange, own.cols() + 1);
  own.rightCols(1) = column;
}

SlowNoise::Columns SlowNoise::of_model() const {
  Columns columns(campaign_.shots.size(), Eigen::MatrixXd(rows_, 0));
  const Composition& composition = base_.composition;
  for (std::size_t i = 0; i < base_.fit.theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    const EffectAbout& about = composition.uses()[number.use].effect->about();
    if (number.shot >= 0 && is_addition(*composition.uses()[number.use].effect) &&
        !about.parameters[number.parameter].auxiliary()) {
      append(columns, number.shot,
             column_of(composition, base_.fit.theta, i,
                       base_.fit.jacobian.col(static_cast<Eigen::Index>(i))));
    }
  }
  return columns;
}

void SlowNoise::add_columns(const Addition& addition, Columns& columns) const {
  const Composition composition(with(base_.model, addition.candidate, Auxiliaries::held),
                                campaign_);
  const std::vector<double> theta = carry(base_.composition, base_.fit.theta, composition);
  Eigen::Index strength = 0;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (composition.uses()[number.use].id() == addition.candidate.id()) {
      append(columns, number.shot,
             column_of(composition, theta, i, addition.direction.columns.col(strength)));
      ++strength;
    }
  }
}

SlowNoise::Levels SlowNoise::best_levels(const Eigen::ArrayXd& slow, const Eigen::MatrixXd& seen,
                                         Levels levels) {
  constexpr int kMostSteps = 60;
  constexpr double kSettled = 1e-3;
  const Eigen::ArrayXd power = seen.rowwise().squaredNorm() / static_cast<double>(seen.cols());
  // Expectation and maximisation, as of smooth spectra.
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::ArrayXd per_total = (levels.white + levels.slow * slow).inverse();
    const Eigen::ArrayXd over = power * per_total.square();
    const double white = over.sum() / per_total.sum();
    const double rest = (over * slow).sum() / std::max(1e-300, (per_total * slow).sum());
    levels.white *= white;
    levels.slow *= rest;
    if (std::abs(white - 1.0) < kSettled && std::abs(rest - 1.0) < kSettled) {
      break;
    }
  }
  return levels;
}

double SlowNoise::twice_log_likelihood(const Eigen::ArrayXd& slow, const Eigen::MatrixXd& seen,
                                       const Levels& levels) {
  const Eigen::ArrayXd power = seen.rowwise().squaredNorm() / static_cast<double>(seen.cols());
  const Eigen::ArrayXd total = levels.white + levels.slow * slow;
  return -static_cast<double>(seen.cols()) * (power / total + total.log()).sum();
}

SlowNoise::Fitted SlowNoise::fitted(const Form& form, const Eigen::MatrixXd& seen,
                                    const Columns& columns, Levels levels) {
  constexpr int kIterations = 3;
  constexpr double kRidge = 1e-9;
  if (columns.front().cols() == 0) {
    levels = best_levels(form.slow, seen, levels);
    return {twice_log_likelihood(form.slow, seen, levels), levels};
  }
  Fitted out;
  Eigen::MatrixXd left(seen.rows(), seen.cols());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::VectorXd weights = (levels.white + levels.slow * form.slow.array()).inverse();
    for (Eigen::Index n = 0; n < seen.cols(); ++n) {
      const Eigen::MatrixXd& own = columns[static_cast<std::size_t>(n)];
      const Eigen::MatrixXd weighted = weights.asDiagonal() * own;
      Eigen::MatrixXd normal = own.transpose() * weighted;
      normal.diagonal() *= 1.0 + kRidge;
      left.col(n) = seen.col(n) - own * solve_symmetric(normal, weighted.transpose() * seen.col(n));
    }
    levels = best_levels(form.slow, left, levels);
    out.twice_log_likelihood =
        std::max(out.twice_log_likelihood, twice_log_likelihood(form.slow, left, levels));
    out.levels = levels;
  }
  return out;
}

SlowNoise::Columns SlowNoise::turned(const Form& form, Columns columns) {
  for (Eigen::MatrixXd& own : columns) {
    own = form.turn * own;
  }
  return columns;
}

double SlowNoise::gain(const Form& form, const Eigen::MatrixXd& seen, const Columns& columns,
                       const Columns& beside) {
  const Fitted without = fitted(form, seen, beside, {});
  const Fitted with = fitted(form, seen, columns, without.levels);
  return std::max(0.0, with.twice_log_likelihood - without.twice_log_likelihood);
}

double SlowNoise::log_chance(const Form& form, Columns columns) const {
  columns = turned(form, std::move(columns));
  const Eigen::MatrixXd seen = form.turn * seen_;
  const Columns beside = turned(form, of_model_);
  const Fitted without = fitted(form, seen, beside, {});
  const Fitted with = fitted(form, seen, columns, without.levels);
  const double found = std::max(0.0, with.twice_log_likelihood - without.twice_log_likelihood);
  // Even if the levels of noise were known.
  constexpr double kOrdinary = -5.0;
  const double known = log_chi2_tail(found, strengths_of(columns) - strengths_of(beside));
  if (known > kOrdinary) {
    return known;
  }
  // Of what is named nothing stays: what wanders as quickly as it turns is something else.
  constexpr double kStays = 0.1;
  if (form.own && with.levels.slow > kStays * without.levels.slow) {
    return 0.0;
  }
  const Eigen::VectorXd deviation =
      (without.levels.white + without.levels.slow * form.slow.array()).sqrt();
  std::mt19937_64 random(kSearchSeed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd drawn(seen_.rows(), seen_.cols());
  double mean = 0.0;
  double square = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    for (double& value : drawn.reshaped()) {
      value = normal(random);
    }
    const double gained = gain(form, deviation.asDiagonal() * drawn, columns, beside);
    mean += gained / kRepeats;
    square += gained * gained / kRepeats;
  }
  const double variance = square - mean * mean;
  return mean > 0.0 && variance > 0.0 ? log_tail(found, mean, variance) : 0.0;
}

double SlowNoise::log_chance(std::span<const Addition> additions) const {
  Columns columns = of_model_;
  for (const Addition& addition : additions) {
    add_columns(addition, columns);
  }
  double chance = -HUGE_VAL;
  for (const Form& form : forms_) {
    chance = std::max(chance, log_chance(form, columns));
    constexpr double kOrdinary = -3.0;
    if (chance > kOrdinary) {
      break;
    }
  }
  return chance;
}

double SlowNoise::log_chance_beside(const Addition& addition,
                                    std::span<const Addition> others) const {
  Columns beside = of_model_;
  for (const Addition& other : others) {
    add_columns(other, beside);
  }
  Columns columns = beside;
  add_columns(addition, columns);
  double chance = -HUGE_VAL;
  for (const Form& form : forms_) {
    const double found = gain(form, form.turn * seen_, turned(form, columns), turned(form, beside));
    chance = std::max(chance, log_chi2_tail(found, strengths_of(columns) - strengths_of(beside)));
  }
  return chance;
}

}  // namespace kolsky
