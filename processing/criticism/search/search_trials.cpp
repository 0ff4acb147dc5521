#include "processing/criticism/search/search_trials.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

constexpr int kSimulatedRepeats = 2000;

}  // namespace

double independent_trials(const Studied& studied, const std::vector<Candidate>& candidates,
                          const std::vector<Direction>& directions,
                          std::span<const std::size_t> which) {
  std::vector<std::size_t> single;
  double others = 0.0;
  for (const std::size_t i : which) {
    const Direction& direction = directions[i];
    if (direction.freedom == 1.0 && direction.information.rows() == 1) {
      single.push_back(i);
    }
    others += direction.information.rows() > 1 && direction.freedom > 0.0 ? 1.0 : 0.0;
  }
  const auto count = static_cast<Eigen::Index>(single.size());
  if (count == 0) {
    return std::max(1.0, others);
  }
  Eigen::MatrixXd columns(studied.fit.residual.size(), count);
  Eigen::MatrixXd shares(static_cast<Eigen::Index>(studied.fit.theta.size()), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Direction& direction = directions[single[static_cast<std::size_t>(i)]];
    const double scale = 1.0 / std::sqrt(direction.information(0, 0));
    columns.col(i) = direction.columns.col(0) * scale;
    shares.col(i) = direction.model_share.col(0) * scale;
  }
  Eigen::MatrixXd gram =
      columns.transpose() * columns - shares.transpose() * studied.fit.covariance * shares;
  const SymmetricEigen solver(gram);
  const Eigen::MatrixXd root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  std::mt19937_64 random(kSearchSeed);
  std::normal_distribution<double> normal;
  std::vector<double> best;
  Eigen::VectorXd draw(count);
  for (int n = 0; n < kSimulatedRepeats; ++n) {
    for (Eigen::Index i = 0; i < count; ++i) {
      draw[i] = normal(random);
    }
    const Eigen::VectorXd z = root * draw;
    double two_sided = 0.0;
    double one_sided = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (candidates[single[static_cast<std::size_t>(i)]].signs == Signs::both) {
        two_sided = std::max(two_sided, z[i] * z[i]);
      } else if (z[i] > 0.0) {
        one_sided = std::max(one_sided, z[i] * z[i]);
      }
    }
    // One-sided tests have half the tail: the same chance lies at a smaller square.
    best.push_back(-std::min(log_gain_tail(two_sided, 1.0, Signs::both),
                             one_sided > 0.0 ? log_gain_tail(one_sided, 1.0, Signs::one) : 0.0));
  }
  // Chance 5 % for the best of all: n tests have p = 1 - 0.95^(1/n) each.
  std::nth_element(best.begin(), best.begin() + kSimulatedRepeats * 95 / 100, best.end());
  const double p = std::exp(-best[static_cast<std::size_t>(kSimulatedRepeats) * 95 / 100]);
  return std::max(1.0, std::log(0.95) / std::log1p(-std::min(p, 0.5))) + others;
}

double independent_trials(const Studied& studied, const std::vector<Candidate>& candidates,
                          const std::vector<Direction>& directions) {
  std::vector<std::size_t> all(directions.size());
  std::iota(all.begin(), all.end(), 0);
  return independent_trials(studied, candidates, directions, all);
}

}  // namespace kolsky
