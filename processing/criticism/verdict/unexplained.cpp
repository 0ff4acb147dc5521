#include "processing/criticism/verdict/unexplained.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/beside_rounding.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/search/slow_weights.hpp"
#include "processing/criticism/verdict/departure.hpp"
#include "processing/criticism/verdict/distortion.hpp"
#include "processing/criticism/verdict/single_shots.hpp"
#include "processing/criticism/verdict/wander.hpp"

namespace kolsky {

namespace {

/// Degrees of freedom by which the quiet before a single pulse tells slow noise.
constexpr double kOneStretch = 3.0;

/// What is asked of the residuals, and how much each question weighs. Smooth distortions are few,
/// and find what is small; what repeats finds what is of no smooth shape.
constexpr double kOfDistortions = 0.5;
constexpr double kOfRepeats = 0.2;
constexpr double kOfOwnNumbers = 0.1;
constexpr double kOfOwnReadings = 0.1;
constexpr double kOfAll = 0.1;

/// Chances (ln) that need no second look.
constexpr double kOrdinary = -3.0;

/// Columns of one kind of distortion at one place, and where they stand among all.
struct Kind {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

struct Distortions {
  Eigen::MatrixXd columns;
  std::vector<Kind> kinds;
  Eigen::VectorXd sizes;  ///< what each does at its usual size, of which the columns are a unit
  std::vector<SensorColumns> sensors;  ///< by gauge but the reference
};

/// Residuals of the records, and below them those of the priors.
struct Extended {
  Distortions distortions;
  Eigen::VectorXd residual;
};

/// Per unit of gain and per microsecond of delay.
Eigen::MatrixXd gain_and_delay(const Eigen::MatrixXd& distortions) {
  Eigen::MatrixXd columns =
      distortions.leftCols(kGainAndRate) / distortion_effect().about().parameters.front().typical;
  columns.col(1) *= -1e-6 * kRateUnit_rad_per_s;
  return columns;
}

Distortions unit_columns(Study& study, const Studied& studied) {
  const Wander wander(study.residuals());
  std::optional<Departure> departure;
  std::vector<EffectUse> uses{null_use(bent_scale_effect())};
  std::vector<std::size_t> at;  // which of them filter a gauge
  if (study.campaign().bench.specimen) {
    departure.emplace(study, studied);
    uses.push_back(null_use(*departure));
  }
  for (const std::size_t j : study.residuals().others()) {
    const std::string& gauge = study.campaign().bench.gauges[j].name;
    at.push_back(uses.size());
    uses.push_back(null_use(distortion_effect(), gauge));
    uses.push_back(null_use(wander, gauge));
  }
  std::vector<Eigen::MatrixXd> list(uses.size());
  study.executor().run(uses.size(), [&](std::size_t i, std::size_t worker) {
    list[i] = direction_of({.use = uses[i]}, studied, study, worker).columns;
  });
  Distortions out;
  Eigen::Index total = 0;
  for (const Eigen::MatrixXd& own : list) {
    out.kinds.push_back({total, own.cols()});
    total += own.cols();
  }
  out.columns.resize(studied.fit.residual.size(), total);
  for (std::size_t i = 0; i < list.size(); ++i) {
    out.columns.middleCols(out.kinds[i].first, out.kinds[i].count) = list[i];
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    out.sensors.push_back({study.residuals().others()[i], gain_and_delay(list[at[i]])});
  }
  out.sizes = out.columns.colwise().norm();
  out.columns.colwise().normalize();
  return out;
}

/// Every distortion, less what the model's own numbers take up of it.
Extended clear_columns(const Studied& studied, const Distortions& unit) {
  const ModelFit& fit = studied.fit;
  const Eigen::MatrixXd taken = fit.covariance * (fit.jacobian.transpose() * unit.columns);
  const Eigen::Index rows = unit.columns.rows();
  const auto numbers = static_cast<Eigen::Index>(fit.theta.size());
  Extended out{{Eigen::MatrixXd::Zero(rows + numbers, unit.columns.cols()), unit.kinds, unit.sizes,
                unit.sensors},
               Eigen::VectorXd::Zero(rows + numbers)};
  Eigen::MatrixXd& columns = out.distortions.columns;
  columns.topRows(rows) = unit.columns - fit.jacobian * taken;
  out.residual.head(rows) = fit.residual;
  for (Eigen::Index i = 0; i < numbers; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const FreeNumber& number = studied.composition.numbers()[at];
    if (number.prior_sd > 0.0) {
      columns.row(rows + i) = -number.scale / number.prior_sd * taken.row(i);
      out.residual[rows + i] =
          (number.value_at(fit.theta[at]) - number.prior_mean) / number.prior_sd;
    }
  }
  return out;
}

/// Orthonormal directions that the distortions span.
///
/// Those along which a distortion as large as the signal would not show by three deviations are
/// left out: where the model or the source takes up so much of them, what stays is made of the
/// noise that is in the signal, and finds itself in the residuals.
Eigen::MatrixXd directions_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& sizes) {
  constexpr double kResolved = 1e-4;
  constexpr double kUsual = 1e-3;  // of the signal: what a distortion is at its usual size
  constexpr double kShown = 3.0;
  const SymmetricEigen solver(columns.transpose() * columns);
  Eigen::MatrixXd directions(columns.rows(), columns.cols());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const Eigen::VectorXd share = solver.eigenvectors().col(i);
    const double power = solver.eigenvalues()[i];
    if (power > kResolved &&
        std::sqrt(power) > kShown * kUsual * share.cwiseQuotient(sizes).norm()) {
      directions.col(count++) = columns * share / std::sqrt(power);
    }
  }
  return directions.leftCols(count);
}

/// Power of what differs between the shots in each direction, over its expectation under noise of
/// unit variance.
Eigen::VectorXd between_shots(const Eigen::MatrixXd& directions, const Eigen::VectorXd& residual,
                              std::size_t per_shot, std::size_t count) {
  const auto size = static_cast<Eigen::Index>(per_shot);
  const auto shots = static_cast<Eigen::Index>(count);
  Eigen::VectorXd powers(directions.cols());
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    double q = 0.0;
    double all = 0.0;
    double whole = 0.0;
    for (Eigen::Index n = 0; n < shots; ++n) {
      const auto part = directions.col(i).segment(n * size, size);
      const double pull = part.dot(residual.segment(n * size, size));
      const double weight = part.squaredNorm();
      all += pull;
      whole += weight;
      q += weight > 0.0 ? pull * pull / weight : 0.0;
    }
    q -= whole > 0.0 ? all * all / whole : 0.0;
    powers[i] = q / static_cast<double>(shots - 1);
  }
  return powers;
}

/// As how many directions of equal noise these count: a sum of squares of unequal variances v
/// spreads as one of (sum v)^2 / sum v^2 (Box 1954).
/// @param powers   estimates of v, each of so many degrees of freedom, which spreads them too
double equal_directions(const Eigen::VectorXd& powers, double freedom) {
  const double squares = powers.squaredNorm() / (1.0 + 2.0 / freedom);
  const auto all = static_cast<double>(powers.size());
  return squares > 0.0 ? std::min(all, powers.sum() * powers.sum() / squares) : all;
}

/// What all kinds together tell of the noise: that which whitened the residuals or more. What the
/// filed numbers leave is not less where the shots agree by chance.
struct Noise {
  double power = 1.0;
  double freedom = 1.0;
};

/// ln of the chance that noise finds as much along these directions.
double log_chance(const Eigen::MatrixXd& directions, const Eigen::VectorXd& residual,
                  double own_power, const Noise& noise) {
  const auto count = static_cast<double>(directions.cols());
  const double found = (directions.transpose() * residual).squaredNorm();
  return log_f_tail(found / count / std::max(noise.power, own_power), count, noise.freedom);
}

/// All together weigh as much as every kind by itself does.
double combined(double log_p, const std::vector<double>& by_kind) {
  std::vector<double> log_ps{log_p};
  std::vector<double> weights{0.5};
  for (const double own : by_kind) {
    log_ps.push_back(own);
    weights.push_back(0.5 / static_cast<double>(by_kind.size()));
  }
  return combined_log_p(log_ps, weights);
}

/// ln of the chance that noise leaves as much in all directions together, by what differs between
/// the shots.
double log_p_of_all(const Misfit& misfit, std::size_t shots) {
  const double freedom = misfit.degrees_of_freedom;
  return log_f_tail(misfit.chi2_reduced / noise_of(misfit, shots), freedom,
                    freedom * (1.0 - 1.0 / static_cast<double>(shots)));
}

/// What distortions find, all together and each kind by itself. Where the model or the source takes
/// up all of them they find nothing, which says nothing of the other questions.
Unexplained in_distortions(const Extended& extended, std::size_t per_shot, std::size_t shots) {
  const auto& [distortions, residual] = extended;
  const Eigen::MatrixXd directions = directions_of(distortions.columns, distortions.sizes);
  const auto freedom = static_cast<double>(directions.cols());
  if (freedom == 0.0) {
    return {};
  }
  const double found = (directions.transpose() * residual).squaredNorm();
  if (shots < 2) {
    // Nothing shows that it would come back: noise is known by one short stretch alone.
    const double log_p = log_f_tail(found / freedom, freedom, kOneStretch);
    return {log_p, log_p, std::max(0.0, found - freedom)};
  }
  const Eigen::VectorXd powers = between_shots(directions, residual, per_shot, shots);
  const double equal = equal_directions(powers, static_cast<double>(shots - 1));
  const Noise noise{std::max(1.0, powers.mean()), equal * static_cast<double>(shots - 1)};
  std::vector<double> by_kind;
  for (const Kind& kind : distortions.kinds) {
    const Eigen::MatrixXd own =
        directions_of(distortions.columns.middleCols(kind.first, kind.count),
                      distortions.sizes.segment(kind.first, kind.count));
    if (own.cols() > 0) {
      const double power = between_shots(own, residual, per_shot, shots).mean();
      by_kind.push_back(log_chance(own, residual, power, noise));
    }
  }
  const double log_p = log_f_tail(found / freedom / noise.power, equal, noise.freedom);
  return {combined(log_p, by_kind), 0.0, std::max(0.0, found / noise.power - freedom)};
}

Unexplained unexplained_by(Study& study, const Studied& studied, const Distortions& unit) {
  const Extended extended = clear_columns(studied, unit);
  const std::size_t per_shot = study.residuals().per_shot();
  const std::size_t shots = study.campaign().shots.size();
  Unexplained left = in_distortions(extended, per_shot, shots);
  if (shots < 2) {
    return left;
  }
  const double known = belief_in(distortion_effect(), study.residuals().noise(), shots);
  left.apart = readings_apart(studied, extended.distortions.sensors, shots, per_shot, known);
  const std::array log_ps{left.log_p, studied.misfit.repeatable_log_p,
                          log_p_of_own_numbers(studied, shots, per_shot, known),
                          log_p_of_all(studied.misfit, shots)};
  constexpr double kInCommon = 1.0 - kOfOwnReadings;
  constexpr std::array weights{kOfDistortions / kInCommon, kOfRepeats / kInCommon,
                               kOfOwnNumbers / kInCommon, kOfAll / kInCommon};
  left.common_log_p = combined_log_p(log_ps, weights);
  left.log_p = combined_log_p(std::array{left.common_log_p, left.apart.log_p},
                              std::array{kInCommon, kOfOwnReadings});
  return left;
}

/// What a fit leaves of other residuals.
Studied fitted_to(Study& study, const Studied& studied, const Eigen::VectorXd& white) {
  const ModelFit& fit = studied.fit;
  Studied other = studied;
  other.fit.residual = white - fit.jacobian * (fit.covariance * (fit.jacobian.transpose() * white));
  other.misfit =
      misfit_of(study.residuals(), other.fit.residual, studied.misfit.degrees_of_freedom);
  return other;
}

/// What coarse converters leave is where records creep, alike in shots that are alike, and passes
/// for what repeats by all measures of noise that is the same everywhere. These are told by what
/// they say where rounding is all there is.
void allow_for_rounding(Study& study, const Studied& studied, const Distortions& unit,
                        Unexplained& left) {
  const Eigen::MatrixXd drawn = drawn_rounding_and_noise(study, studied, StepsLie::alike);
  Exaggerated all;
  Exaggerated common;
  Exaggerated apart;
  for (Eigen::Index d = 0; d < drawn.cols(); ++d) {
    const Unexplained own = unexplained_by(study, fitted_to(study, studied, drawn.col(d)), unit);
    all.add(own.log_p);
    common.add(own.common_log_p);
    apart.add(own.apart.log_p);
  }
  left.log_p /= all.times();
  left.common_log_p /= common.times();
  left.apart.log_p /= apart.times();
}

/// Without what coarse converters leave.
Unexplained unexplained_by_noise(Study& study, const Studied& studied, const Distortions& unit) {
  Unexplained left = unexplained_by(study, studied, unit);
  if (left.log_p > kOrdinary || study.campaign().shots.size() < 3) {
    return left;
  }
  // It stands only if slow noise does not do it.
  const std::size_t per_shot = study.residuals().per_shot();
  for (const SlowWeights& slow : slow_weights(study, studied)) {
    Distortions weighed = unit;
    slow.weigh(weighed.columns, per_shot);
    for (SensorColumns& sensor : weighed.sensors) {
      slow.weigh(sensor.columns, per_shot);
    }
    const Unexplained beside = unexplained_by(study, slow.refitted(studied, per_shot), weighed);
    if (beside.log_p > left.log_p) {
      left = beside;
    }
  }
  return left;
}

}  // namespace

Unexplained unexplained(Study& study, const Studied& studied) {
  const Distortions unit = unit_columns(study, studied);
  Unexplained left = unexplained_by_noise(study, studied, unit);
  if (left.log_p < kOrdinary) {
    allow_for_rounding(study, studied, unit, left);
  }
  return left;
}

}  // namespace kolsky
