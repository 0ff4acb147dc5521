#include "processing/criticism/unexplained.hpp"

#include <algorithm>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/candidates.hpp"
#include "processing/criticism/distortion.hpp"
#include "processing/criticism/statistics.hpp"
#include "processing/criticism/wander.hpp"

namespace kolsky {

namespace {

/// Degrees of freedom by which the quiet before a single pulse tells slow noise.
constexpr double kOneStretch = 3.0;

/// Residuals of the records, and below them those of the priors.
struct Extended {
  Eigen::MatrixXd columns;
  Eigen::VectorXd residual;
};

Eigen::MatrixXd unit_columns(Study& study, const Studied& studied) {
  const Wander wander(study.residuals());
  std::vector<EffectUse> uses{null_use(bent_scale_effect())};
  for (const std::size_t j : study.residuals().others()) {
    const std::string& gauge = study.campaign().bench.gauges[j].name;
    uses.push_back(null_use(distortion_effect(), gauge));
    uses.push_back(null_use(wander, gauge));
  }
  std::vector<Eigen::MatrixXd> list(uses.size());
  study.executor().run(uses.size(), [&](std::size_t i, std::size_t worker) {
    list[i] = direction_of({uses[i], false, false}, studied, study, worker).columns;
  });
  Eigen::Index total = 0;
  for (const Eigen::MatrixXd& own : list) {
    total += own.cols();
  }
  Eigen::MatrixXd columns(studied.fit.residual.size(), total);
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& own : list) {
    columns.middleCols(at, own.cols()) = own;
    at += own.cols();
  }
  columns.colwise().normalize();
  return columns;
}

/// Every distortion, less what the model's own numbers take up of it.
Extended clear_columns(Study& study, const Studied& studied) {
  const ModelFit& fit = studied.fit;
  const Eigen::MatrixXd columns = unit_columns(study, studied);
  const Eigen::MatrixXd taken = fit.covariance * (fit.jacobian.transpose() * columns);
  const Eigen::Index rows = columns.rows();
  const auto numbers = static_cast<Eigen::Index>(fit.theta.size());
  Extended out{Eigen::MatrixXd::Zero(rows + numbers, columns.cols()),
               Eigen::VectorXd::Zero(rows + numbers)};
  out.columns.topRows(rows) = columns - fit.jacobian * taken;
  out.residual.head(rows) = fit.residual;
  for (Eigen::Index i = 0; i < numbers; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const FreeNumber& number = studied.composition.numbers()[at];
    if (number.prior_sd > 0.0) {
      out.columns.row(rows + i) = -number.scale / number.prior_sd * taken.row(i);
      out.residual[rows + i] =
          (number.value_at(fit.theta[at]) - number.prior_mean) / number.prior_sd;
    }
  }
  return out;
}

/// Orthonormal directions that the distortions span.
Eigen::MatrixXd directions_of(const Eigen::MatrixXd& columns) {
  constexpr double kResolved = 1e-4;
  const SymmetricEigen solver(columns.transpose() * columns);
  const Eigen::VectorXd& values = solver.eigenvalues();
  const Eigen::Index count = (values.array() > kResolved).count();
  return columns * solver.eigenvectors().rightCols(count) *
         values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
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

}  // namespace

Unexplained unexplained(Study& study, const Studied& studied) {
  const Extended extended = clear_columns(study, studied);
  const Eigen::MatrixXd directions = directions_of(extended.columns);
  const std::size_t per_shot = study.residuals().per_shot();
  const std::size_t shots = study.campaign().shots.size();
  const auto freedom = static_cast<double>(directions.cols());
  if (freedom == 0.0) {
    return {};
  }
  const double found = (directions.transpose() * extended.residual).squaredNorm();
  if (shots < 2) {
    // Nothing shows that it would come back: noise is known by one short stretch alone.
    return {log_f_tail(found / freedom, freedom, kOneStretch), std::max(0.0, found - freedom)};
  }
  const Eigen::VectorXd powers = between_shots(directions, extended.residual, per_shot, shots);
  const double noise = powers.mean();
  const auto further = static_cast<double>(shots - 1);
  const double equal = equal_directions(powers, further);
  return {log_f_tail(found / freedom / noise, equal, equal * further),
          std::max(0.0, found / noise - freedom)};
}

}  // namespace kolsky
