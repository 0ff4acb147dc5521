#include "processing/criticism/product_test.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "processing/criticism/search_trials.hpp"
#include "processing/criticism/statistics.hpp"

namespace kolsky {

namespace {

constexpr int kDraws = 40;
constexpr int kSteps = 8;
constexpr double kSeen = 1e-2;  ///< of the prior's information

/// Products sought by alternating least squares.
class Products {
 public:
  /// @param root  from strengths to measurements of unit noise
  Products(const Eigen::MatrixXd& root, std::size_t shots, std::size_t gauges)
      : root_(root),
        shots_(static_cast<Eigen::Index>(shots)),
        gauges_(static_cast<Eigen::Index>(gauges)) {}

  /// The square of what the best products explain of measurements.
  [[nodiscard]] double explained(const Eigen::VectorXd& z) const {
    double best = 0.0;
    const Eigen::VectorXd strengths = root_.transpose() * z;
    const Eigen::Map<const Eigen::MatrixXd> by_gauge(strengths.data(), gauges_, 2 * shots_);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(by_gauge, Eigen::ComputeThinU);
    const Eigen::Index starts = std::min<Eigen::Index>(2, svd.matrixU().cols());
    for (Eigen::Index start = 0; start < starts; ++start) {
      Eigen::VectorXd shares = svd.matrixU().col(start);
      double found = 0.0;
      for (int step = 0; step < kSteps; ++step) {
        const Eigen::MatrixXd of_shots = by_shot(shares);
        const Eigen::VectorXd amplitudes = solved(of_shots, z);
        const Eigen::MatrixXd of_gauges = by_share(amplitudes);
        shares = solved(of_gauges, z);
        found = share_of(of_gauges, shares, z);
        shares.normalize();
      }
      best = std::max(best, found);
    }
    return best;
  }

  /// The same for strengths at one gauge only, each shot's its own.
  [[nodiscard]] double at_one_gauge(const Eigen::VectorXd& z) const {
    double best = 0.0;
    for (Eigen::Index gauge = 0; gauge < gauges_; ++gauge) {
      const Eigen::MatrixXd of_shots = by_shot(Eigen::VectorXd::Unit(gauges_, gauge));
      best = std::max(best, share_of(of_shots, solved(of_shots, z), z));
    }
    return best;
  }

 private:
  static Eigen::VectorXd solved(const Eigen::MatrixXd& columns, const Eigen::VectorXd& z) {
    return columns.colPivHouseholderQr().solve(z);
  }
  static double share_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& z) {
    return z.squaredNorm() - (z - columns * x).squaredNorm();
  }
  /// Columns of the amplitudes (cosine parts, then sine parts, by shot) for given shares.
  [[nodiscard]] Eigen::MatrixXd by_shot(const Eigen::VectorXd& shares) const {
    Eigen::MatrixXd columns(root_.rows(), 2 * shots_);
    for (Eigen::Index c = 0; c < 2 * shots_; ++c) {
      columns.col(c).noalias() = root_.middleCols(c * gauges_, gauges_) * shares;
    }
    return columns;
  }
  [[nodiscard]] Eigen::MatrixXd by_share(const Eigen::VectorXd& amplitudes) const {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(root_.rows(), gauges_);
    for (Eigen::Index c = 0; c < 2 * shots_; ++c) {
      columns.noalias() += amplitudes[c] * root_.middleCols(c * gauges_, gauges_);
    }
    return columns;
  }

  const Eigen::MatrixXd& root_;
  Eigen::Index shots_;
  Eigen::Index gauges_;
};

}  // namespace

ProductTest test_products(const Eigen::VectorXd& strengths, const Eigen::MatrixXd& information,
                          std::size_t shots, std::size_t gauges) {
  if (shots < 2 || gauges < 3) {
    return {};
  }
  // What the records say without the prior, in the directions in which they say anything.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
  const Eigen::VectorXd lambda = solver.eigenvalues().array() - 1.0;
  const Eigen::Index seen = (lambda.array() > kSeen).count();
  const Eigen::MatrixXd root = lambda.tail(seen).cwiseSqrt().asDiagonal() *
                               solver.eigenvectors().rightCols(seen).transpose();
  const Eigen::VectorXd white =
      lambda.tail(seen).cwiseSqrt().cwiseInverse().asDiagonal() *
      (solver.eigenvectors().rightCols(seen).transpose() * (information * strengths));
  const Products products(root, shots, gauges);
  const double all = white.squaredNorm();
  const double explained = products.explained(white);

  std::mt19937_64 random(kSearchSeed);
  std::normal_distribution<double> normal;
  double taken = 0.0;
  for (int n = 0; n < kDraws; ++n) {
    const Eigen::VectorXd noise =
        Eigen::VectorXd::NullaryExpr(seen, [&](Eigen::Index) { return normal(random); });
    taken += products.explained(noise) / noise.squaredNorm() * static_cast<double>(seen) / kDraws;
  }
  const double left = static_cast<double>(seen) - taken;
  if (left < 1.0 || all <= 0.0) {
    return {};
  }
  const double rest = std::max(all - explained, 1e-12 * all);
  ProductTest test;
  test.log_p = log_f_tail(explained / taken * left / rest, taken, left);
  test.beyond_one_gauge = (explained - products.at_one_gauge(white)) / (rest / left);
  return test;
}

}  // namespace kolsky
