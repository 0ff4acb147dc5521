#include "processing/criticism/held_out.hpp"

namespace kolsky {

std::vector<double> held_out_squares(const Studied& studied, std::size_t residuals_per_shot) {
  const ModelFit& fit = studied.fit;
  const auto size = static_cast<Eigen::Index>(residuals_per_shot);
  const Eigen::Index shots = fit.residual.size() / size;
  std::vector<double> squares;
  if (shots < 2 || fit.theta.empty()) {
    for (Eigen::Index n = 0; n < shots; ++n) {
      squares.push_back(fit.residual.segment(n * size, size).squaredNorm());
    }
    return squares;
  }
  for (Eigen::Index n = 0; n < shots; ++n) {
    const auto rows = fit.jacobian.middleRows(n * size, size);
    const auto residual = fit.residual.segment(n * size, size);
    // Shared numbers move to where the other shots alone would have them; those of this shot stay.
    std::vector<Eigen::Index> shared;
    double own = 0.0;
    for (std::size_t i = 0; i < fit.theta.size(); ++i) {
      const std::ptrdiff_t shot = studied.composition.numbers()[i].shot;
      if (shot < 0) {
        shared.push_back(static_cast<Eigen::Index>(i));
      } else if (shot == n) {
        own += 1.0;
      }
    }
    if (shared.empty()) {
      squares.push_back(residual.squaredNorm() + 2.0 * own);
      continue;
    }
    const auto count = static_cast<Eigen::Index>(shared.size());
    Eigen::MatrixXd information(count, count);
    Eigen::MatrixXd columns(size, count);
    for (Eigen::Index a = 0; a < count; ++a) {
      columns.col(a) = rows.col(shared[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < count; ++b) {
        information(a, b) = fit.information(shared[static_cast<std::size_t>(a)],
                                            shared[static_cast<std::size_t>(b)]);
      }
    }
    const Eigen::MatrixXd others = information - columns.transpose() * columns;
    const Eigen::VectorXd move =
        others.completeOrthogonalDecomposition().solve(columns.transpose() * residual);
    squares.push_back((residual + columns * move).squaredNorm() + 2.0 * own);
  }
  return squares;
}

Certification certification(const Studied& before, const Studied& after,
                            std::size_t residuals_per_shot) {
  const auto a = held_out_squares(before, residuals_per_shot);
  const auto b = held_out_squares(after, residuals_per_shot);
  Certification certified;
  for (std::size_t n = 0; n < a.size(); ++n) {
    certified.gain += a[n] - b[n];
    certified.better += a[n] > b[n] ? 1 : 0;
  }
  return certified;
}

}  // namespace kolsky
