#include "processing/criticism/search/slow_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/noise/smooth_power.hpp"
#include "processing/criticism/search/search_trials.hpp"
#include "processing/reduction/pulse.hpp"

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

/// What waves of a few frequencies at one gauge each are in what is looked at, their cosine and
/// sine parts.
struct Carried {
  std::vector<double> frequency;                 ///< in judged bins
  std::vector<std::vector<Eigen::MatrixXd>> at;  ///< by gauge and frequency, two columns
};

std::vector<double> wave(const CampaignShot& shot, double w_rad_s, double phase) {
  std::vector<double> record;
  for (const double t : shot.facts.time_s) {
    record.push_back(std::cos(w_rad_s * t - phase));
  }
  const double baseline = quiet_before(record, shot.quiet_samples).baseline;
  for (double& value : record) {
    value -= baseline;
  }
  return record;
}

/// Closer than the bins, so that what is slower than the window is there.
Carried carried(const Studied& base, Study& study, Eigen::Index lowest) {
  constexpr std::size_t kPerBin = 4;
  constexpr std::size_t kBins = 16;  ///< what is beyond the lowest leaks into them, too
  WhiteResiduals& residuals = study.residuals();
  const CampaignShot& shot = study.campaign().shots.front();
  const std::size_t gauges = study.campaign().gauges();
  Carried out;
  for (std::size_t q = 1; q <= kPerBin * kBins; ++q) {
    out.frequency.push_back(static_cast<double>(q) / static_cast<double>(kPerBin));
  }
  const std::size_t count = out.frequency.size();
  const Eigen::Index rows = lowest + kQuietRows * static_cast<Eigen::Index>(gauges);
  out.at.assign(gauges, std::vector<Eigen::MatrixXd>(count, Eigen::MatrixXd(rows, 2)));
  study.executor().run(count * gauges, [&](std::size_t i, std::size_t worker) {
    const std::size_t j = i / count;
    const std::size_t q = i % count;
    const double w = 2.0 * std::numbers::pi * out.frequency[q] * residuals.band().bin_width_Hz;
    std::vector<std::vector<double>> records(gauges,
                                             std::vector<double>(shot.strain[j].size(), 0.0));
    for (const int part : {0, 1}) {
      records[j] = wave(shot, w, 0.5 * std::numbers::pi * part);
      out.at[j][q].col(part) << residuals
                                    .whitened_noise(base.composition, base.fit.theta, records,
                                                    worker)
                                    .head(lowest),
          quiet_rows_of(shot, records);
    }
  });
  return out;
}

/// Spectra of the gauges as they are known, as white noise and the rest.
std::vector<SmoothPower> spectra_of(const WhiteResiduals& residuals) {
  std::vector<SmoothPower> list;
  for (std::size_t j = 0; j < residuals.campaign().gauges(); ++j) {
    std::vector<double> power;
    for (std::size_t k = 0; k < residuals.band().bins_judged; ++k) {
      power.push_back(residuals.noise().power(j, k));
    }
    // A wave of unit amplitude has this power at its bin: it stands for those up to the next.
    const auto judged = static_cast<double>(residuals.band().judged);
    const double unit = 2.0 * power.back() / (judged * judged);
    const double last = power.back();
    for (double& value : power) {
      value /= last;
    }
    const SmoothPower smooth = smooth_power(power);
    list.push_back({unit * smooth.white, unit * smooth.pink, unit * smooth.walk});
  }
  return list;
}

/// A wave's unit of power, spread over all frequencies, as variance of each of a record's samples.
double white_per_sample(const JudgedBand& band) {
  return 0.5 * static_cast<double>(band.judged * band.decimation);
}

double slow_power(const SmoothPower& power, double f) {
  return power.at(f) - power.white;
}

/// Covariance of residuals, of noise that gauges have of their own.
template <class Power>
Eigen::MatrixXd covariance_of_own(const Carried& carried, const Power& power) {
  const double step = carried.frequency.front();
  const Eigen::Index size = carried.at.front().front().rows();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t j = 0; j < carried.at.size(); ++j) {
    for (std::size_t q = 0; q < carried.frequency.size(); ++q) {
      const Eigen::MatrixXd& both = carried.at[j][q];
      sum.noalias() += step * power(j, carried.frequency[q]) * both * both.transpose();
    }
  }
  return sum;
}

/// The same where all gauges have the same noise, each as much of it as its power says.
template <class Power>
Eigen::MatrixXd covariance_of_common(const Carried& carried, const Power& power) {
  const double step = carried.frequency.front();
  const Eigen::Index size = carried.at.front().front().rows();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t q = 0; q < carried.frequency.size(); ++q) {
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(size, 2);
    for (std::size_t j = 0; j < carried.at.size(); ++j) {
      both += std::sqrt(power(j, carried.frequency[q])) * carried.at[j][q];
    }
    sum.noalias() += step * both * both.transpose();
  }
  return sum;
}

/// ln of the chance of more than this, of a variable of that mean and variance (a gamma variable).
double log_tail(double value, double mean, double variance) {
  const double scale = variance / mean;
  return log_chi2_tail(2.0 * std::max(value, 0.0) / scale, 2.0 * mean / scale);
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

  const std::vector<SmoothPower> spectra = spectra_of(residuals);
  const Carried waves = carried(base, study, lowest_);
  // Of white noise the quiet parts hold much that is quicker than these waves.
  const Eigen::MatrixXd white =
      covariance_of_own(waves, [&](std::size_t j, double) { return spectra[j].white; });
  const SymmetricEigen lowest(white.topLeftCorner(lowest_, lowest_));
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
    const Eigen::MatrixXd slow =
        own ? covariance_of_own(waves, power) : covariance_of_common(waves, power);
    const SymmetricEigen both(whiten * slow * whiten.transpose());
    forms_.push_back(
        {own, both.eigenvectors().transpose() * whiten, both.eigenvalues().cwiseMax(0.0)});
  }
}

SlowNoise::Columns SlowNoise::columns_of(const Candidate& candidate,
                                         const Direction& direction) const {
  Columns columns(static_cast<std::size_t>(seen_.cols()), Eigen::MatrixXd(rows_, 0));
  const Composition composition(with(base_.model, candidate, false), campaign_);
  const std::vector<double> theta = carry(base_.composition, base_.fit.theta, composition);
  Eigen::Index strength = 0;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (composition.uses()[number.use].id() != candidate.id()) {
      continue;
    }
    const auto at = static_cast<std::size_t>(number.shot);
    std::vector<double> moved = theta;
    moved[i] += 1.0;
    Eigen::MatrixXd& own = columns[at];
    own.conservativeResize(Eigen::NoChange, own.cols() + 1);
    own.rightCols(1) << direction.columns.col(strength).segment(number.shot * per_shot_, lowest_),
        quiet_rows_of(campaign_.shots[at], additions_of(composition, theta, campaign_, at)) -
            quiet_rows_of(campaign_.shots[at], additions_of(composition, moved, campaign_, at));
    ++strength;
  }
  return columns;
}

double SlowNoise::at_best_levels(const Form& form, const Eigen::MatrixXd& seen, Levels& levels) {
  constexpr int kMostSteps = 60;
  constexpr double kSettled = 1e-3;
  const Eigen::ArrayXd power = seen.rowwise().squaredNorm() / static_cast<double>(seen.cols());
  const Eigen::ArrayXd slow = form.slow;
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
  const Eigen::ArrayXd total = levels.white + levels.slow * slow;
  return static_cast<double>(seen.cols()) * (power / total + total.log()).sum();
}

SlowNoise::Gain SlowNoise::gain(const Form& form, const Eigen::MatrixXd& seen,
                                const Columns& columns) const {
  constexpr int kIterations = 3;
  constexpr double kRidge = 1e-9;
  Gain gain;
  const double without = at_best_levels(form, seen, gain.without);
  gain.with = gain.without;
  Eigen::MatrixXd left(seen.rows(), seen.cols());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::VectorXd weights =
        (gain.with.white + gain.with.slow * form.slow.array()).inverse();
    for (Eigen::Index n = 0; n < seen.cols(); ++n) {
      const Eigen::MatrixXd& own = columns[static_cast<std::size_t>(n)];
      const Eigen::MatrixXd weighted = weights.asDiagonal() * own;
      Eigen::MatrixXd normal = own.transpose() * weighted;
      normal.diagonal() *= 1.0 + kRidge;
      left.col(n) = seen.col(n) - own * solve_symmetric(normal, weighted.transpose() * seen.col(n));
    }
    const double with = at_best_levels(form, left, gain.with);
    gain.twice_log_likelihood = std::max(gain.twice_log_likelihood, without - with);
  }
  return gain;
}

double SlowNoise::log_chance(const Form& form, Columns columns) const {
  double strengths = 0.0;
  for (Eigen::MatrixXd& own : columns) {
    own = form.turn * own;
    strengths += static_cast<double>(own.cols());
  }
  const Gain found = gain(form, form.turn * seen_, columns);
  // Even if the levels of noise were known.
  constexpr double kOrdinary = -5.0;
  const double known = log_chi2_tail(found.twice_log_likelihood, strengths);
  if (known > kOrdinary) {
    return known;
  }
  // Of what is named nothing stays: what wanders as quickly as it turns is something else.
  constexpr double kStays = 0.1;
  if (form.own && found.with.slow > kStays * found.without.slow) {
    return 0.0;
  }
  const Eigen::VectorXd deviation =
      (found.without.white + found.without.slow * form.slow.array()).sqrt();
  std::mt19937_64 random(kSearchSeed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd drawn(seen_.rows(), seen_.cols());
  double mean = 0.0;
  double square = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    for (double& value : drawn.reshaped()) {
      value = normal(random);
    }
    const double gained = gain(form, deviation.asDiagonal() * drawn, columns).twice_log_likelihood;
    mean += gained / kRepeats;
    square += gained * gained / kRepeats;
  }
  const double variance = square - mean * mean;
  return mean > 0.0 && variance > 0.0 ? log_tail(found.twice_log_likelihood, mean, variance) : 0.0;
}

double SlowNoise::log_chance(const Candidate& candidate, const Direction& direction) const {
  const Columns columns = columns_of(candidate, direction);
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

}  // namespace kolsky
