#include "processing/criticism/search/slow_weights.hpp"

#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/search/slow_waves.hpp"

namespace kolsky {

namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

SlowWeights::SlowWeights(Eigen::MatrixXd parts, const Eigen::MatrixXd& residual) {
  // A residual's own variance is 1, whatever of it is slow.
  for (auto one : parts.rowwise()) {
    one /= std::max(1.0, one.norm());
  }
  const Eigen::VectorXd slow = parts.rowwise().squaredNorm();
  const SymmetricEigen strengths(parts.transpose() * parts);
  const Eigen::Index all = parts.cols();
  constexpr double kFelt = 1.1;
  modes_.resize(parts.rows(), all);
  Eigen::VectorXd variances(all);
  Eigen::Index count = 0;
  // From the strongest.
  for (Eigen::Index i = all - 1; i >= 0 && strengths.eigenvalues()[i] > kFelt - 1.0; --i) {
    modes_.col(count) =
        parts * strengths.eigenvectors().col(i) / std::sqrt(strengths.eigenvalues()[i]);
    variances[count] = 1.0 + strengths.eigenvalues()[i] - modes_.col(count).cwiseAbs2().dot(slow);
    count += variances[count] > kFelt ? 1 : 0;
  }
  modes_.conservativeResize(Eigen::NoChange, count);
  variances.conservativeResize(count);
  double share = 1.0;
  if (count > 0) {
    std::vector<double> found;
    const Eigen::MatrixXd of_modes = modes_.transpose() * residual;
    for (const auto own : of_modes.colwise()) {
      found.push_back(own.cwiseAbs2().cwiseQuotient(variances).mean());
    }
    share = std::min(1.0, median(std::move(found)));
  }
  loss_ = 1.0 - (share * variances).cwiseMax(1.0).cwiseSqrt().cwiseInverse().array();
}

void SlowWeights::weigh(Eigen::Ref<Eigen::MatrixXd> rows, std::size_t per_shot) const {
  const auto size = static_cast<Eigen::Index>(per_shot);
  for (Eigen::Index first = 0; first < rows.rows(); first += size) {
    auto own = rows.middleRows(first, size);
    own -= (modes_ * (loss_.asDiagonal() * (modes_.transpose() * own))).eval();
  }
}

Studied SlowWeights::refitted(const Studied& studied, std::size_t per_shot) const {
  Studied out = studied;
  ModelFit& fit = out.fit;
  const Eigen::MatrixXd priors = fit.information - fit.jacobian.transpose() * fit.jacobian;
  // At its best a fit's residuals pull as much one way as its priors do the other.
  const Eigen::VectorXd of_priors = -fit.jacobian.transpose() * fit.residual;
  weigh(fit.residual, per_shot);
  weigh(fit.jacobian, per_shot);
  fit.information = fit.jacobian.transpose() * fit.jacobian + priors;
  fit.covariance = symmetric_inverse(fit.information);
  const Eigen::VectorXd step =
      -fit.covariance * (fit.jacobian.transpose() * fit.residual + of_priors);
  fit.residual += fit.jacobian * step;
  fit.chi2 = fit.residual.squaredNorm();
  fit.penalty += 2.0 * of_priors.dot(step) + step.dot(priors * step);
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    fit.theta[i] += step[static_cast<Eigen::Index>(i)];
  }
  return out;
}

std::vector<SlowWeights> slow_weights(Study& study, const Studied& studied) {
  const std::vector<SmoothPower> spectra = spectra_of_waves(study.residuals());
  const auto power = [&](std::size_t j, double f) { return slow_power(spectra[j], f); };
  // What whitens white noise leaves nothing that hangs together.
  constexpr double kSlow = 1.0;
  const bool slow = std::ranges::any_of(
      spectra, [](const SmoothPower& own) { return slow_power(own, 1.0) > kSlow * own.white; });
  if (!slow) {
    return {};
  }
  const SlowWaves waves = slow_waves(studied, study);
  const auto per_shot = static_cast<Eigen::Index>(study.residuals().per_shot());
  const Eigen::MatrixXd by_shot = studied.fit.residual.reshaped(
      per_shot, static_cast<Eigen::Index>(study.campaign().shots.size()));
  std::vector<SlowWeights> list;
  list.emplace_back(parts_of_own(waves, power), by_shot);
  list.emplace_back(parts_in_common(waves, power), by_shot);
  return list;
}

}  // namespace kolsky
