#include "processing/criticism/search/beside.hpp"

#include <algorithm>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// What a prior adds to the information on strengths, in scales: those of its deviations.
double prior_information(const Candidate& candidate) {
  return candidate.use.values.front().prior_sd > 0.0 ? 1.0 : 0.0;
}

}  // namespace

double share_beside(const Direction& own, const Candidate& other, const Direction& of_other,
                    const Eigen::MatrixXd& covariance) {
  if (!(own.gain > 0.0)) {
    return 1.0;
  }
  const Eigen::MatrixXd shared = own.columns.transpose() * of_other.columns -
                                 own.model_share.transpose() * covariance * of_other.model_share;
  Eigen::MatrixXd taken = of_other.information;
  constexpr double kRounding = 1e-9;
  taken.diagonal() +=
      (prior_information(other) + kRounding * of_other.unprojected.diagonal().array()).matrix();
  const Eigen::MatrixXd inverse = symmetric_inverse(taken);
  const Eigen::VectorXd pull = own.pull - shared * (inverse * of_other.pull);
  const Eigen::MatrixXd information = own.information - shared * inverse * shared.transpose();
  const Eigen::VectorXd step = least_norm_solution(information, pull);
  if (step.dot(own.step) <= 0.0) {
    return 0.0;
  }
  return std::clamp(pull.dot(step) / own.gain, 0.0, 1.0);
}

}  // namespace kolsky
