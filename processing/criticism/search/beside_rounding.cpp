#include "processing/criticism/search/beside_rounding.hpp"

#include <cmath>
#include <random>
#include <vector>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// How many draws of rounding tell what chances are worth beside it.
constexpr Eigen::Index kDraws = 24;

}  // namespace

Eigen::MatrixXd drawn_rounding_and_noise(Study& study, const Studied& studied, StepsLie lie) {
  WhiteResiduals& residuals = study.residuals();
  const DrawnRounding rounding(residuals, lie);
  Eigen::MatrixXd list(studied.fit.residual.size(), rounding.any() ? kDraws : 0);
  const auto per_shot = static_cast<Eigen::Index>(residuals.per_shot());
  std::mt19937_64 random;
  for (Eigen::Index d = 0; d < list.cols(); ++d) {
    auto white = list.col(d);
    for (std::size_t n = 0; n < study.campaign().shots.size(); ++n) {
      white.segment(static_cast<Eigen::Index>(n) * per_shot, per_shot) = residuals.whiten_records(
          studied.composition, studied.fit.theta, rounding.records(n, static_cast<std::size_t>(d)),
          study.executor().first);
    }
    const double power = (studied.fit.residual.squaredNorm() - white.squaredNorm()) /
                         static_cast<double>(white.size());
    std::normal_distribution<double> noise(0.0, std::sqrt(std::max(0.0, power)));
    for (double& value : white) {
      value += noise(random);
    }
  }
  return list;
}

Eigen::VectorXd gains_by_chance(const Studied& studied, const std::string& id,
                                const Eigen::MatrixXd& drawn) {
  const ModelFit& fit = studied.fit;
  std::vector<Eigen::Index> own;
  Eigen::MatrixXd rest = fit.information;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (studied.composition.uses()[number.use].id() == id) {
      const auto column = static_cast<Eigen::Index>(i);
      own.push_back(column);
      rest.row(column).setZero();
      rest.col(column).setZero();
      rest(column, column) = 1.0;
    }
  }
  Eigen::MatrixXd clear(fit.jacobian.rows(), static_cast<Eigen::Index>(own.size()));
  for (std::size_t i = 0; i < own.size(); ++i) {
    clear.col(static_cast<Eigen::Index>(i)) = fit.jacobian.col(own[i]);
  }
  Eigen::MatrixXd share = fit.jacobian.transpose() * clear;
  for (const Eigen::Index row : own) {
    share.row(row).setZero();
  }
  for (Eigen::Index i = 0; i < clear.cols(); ++i) {
    clear.col(i) -= fit.jacobian * solve_symmetric(rest, share.col(i));
  }
  clear.colwise().normalize();
  constexpr double kResolved = 1e-4;
  const SymmetricEigen eigen(clear.transpose() * clear);
  Eigen::VectorXd gains = Eigen::VectorXd::Zero(drawn.cols());
  for (Eigen::Index i = 0; i < clear.cols(); ++i) {
    if (const double power = eigen.eigenvalues()[i]; power > kResolved) {
      const Eigen::VectorXd along = clear * eigen.eigenvectors().col(i);
      gains += (drawn.transpose() * along).array().square().matrix() / power;
    }
  }
  return gains;
}

}  // namespace kolsky
