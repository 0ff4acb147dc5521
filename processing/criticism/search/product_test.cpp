#include "processing/criticism/search/product_test.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/search/search_trials.hpp"

namespace kolsky {

namespace {

constexpr int kDraws = 100;
constexpr int kSteps = 8;
constexpr double kSeen = 1e-2;  ///< of the prior's information

/// What the records say of strengths without the prior, in the directions in which they say
/// anything, as measurements of unit noise.
struct Seen {
  Eigen::MatrixXd root;   ///< from strengths to measurements
  Eigen::VectorXd white;  ///< the measurements

  Seen(const Eigen::VectorXd& strengths, const Eigen::MatrixXd& information) {
    const SymmetricEigen solver(information);
    const Eigen::VectorXd lambda = solver.eigenvalues().array() - 1.0;
    const Eigen::Index seen = (lambda.array() > kSeen).count();
    const Eigen::MatrixXd directions = solver.eigenvectors().rightCols(seen).transpose();
    const Eigen::VectorXd roots = lambda.tail(seen).cwiseSqrt();
    root = roots.asDiagonal() * directions;
    white = roots.cwiseInverse().asDiagonal() * (directions * (information * strengths));
  }
};

/// Products sought by alternating least squares.
class Products {
 public:
  /// @param root  from strengths to measurements of unit noise
  Products(const Eigen::MatrixXd& root, std::size_t shots, std::size_t gauges)
      : root_(root),
        shots_(static_cast<Eigen::Index>(shots)),
        gauges_(static_cast<Eigen::Index>(gauges)) {}

  /// Products of some shares, and the square of what they explain of measurements.
  struct Found {
    double explained = 0.0;
    Eigen::VectorXd amplitudes;  ///< cosine parts, then sine parts, by shot
    Eigen::VectorXd shares;

    /// In the order of strengths.
    [[nodiscard]] Eigen::VectorXd strengths() const {
      const Eigen::MatrixXd by_gauge = shares * amplitudes.transpose();
      return by_gauge.reshaped();
    }
  };

  [[nodiscard]] Found best(const Eigen::VectorXd& z) const {
    Found best;
    const Eigen::VectorXd strengths = root_.transpose() * z;
    const Eigen::Map<const Eigen::MatrixXd> by_gauge(strengths.data(), gauges_, 2 * shots_);
    const Eigen::MatrixXd left = singular_values(by_gauge).left;
    const Eigen::Index starts = std::min<Eigen::Index>(2, left.cols());
    for (Eigen::Index start = 0; start < starts; ++start) {
      Found own;
      own.shares = left.col(start);
      for (int step = 0; step < kSteps; ++step) {
        own.shares.normalize();
        own.amplitudes = least_squares(by_shot(own.shares), z);
        const Eigen::MatrixXd of_gauges = by_share(own.amplitudes);
        own.shares = least_squares(of_gauges, z);
        own.explained = share_of(of_gauges, own.shares, z);
      }
      best = own.explained > best.explained ? std::move(own) : best;
    }
    return best;
  }

  /// The square of what the best products explain of measurements.
  [[nodiscard]] double explained(const Eigen::VectorXd& z) const { return best(z).explained; }

  /// The same with equal shares.
  [[nodiscard]] double explained_alike(const Eigen::VectorXd& z) const {
    const Eigen::MatrixXd of_shots = by_shot(Eigen::VectorXd::Ones(gauges_));
    return share_of(of_shots, least_squares(of_shots, z), z);
  }

  /// The same for strengths at one gauge only, each shot's its own.
  [[nodiscard]] double at_one_gauge(const Eigen::VectorXd& z) const {
    double best = 0.0;
    for (Eigen::Index gauge = 0; gauge < gauges_; ++gauge) {
      const Eigen::MatrixXd of_shots = by_shot(Eigen::VectorXd::Unit(gauges_, gauge));
      best = std::max(best, share_of(of_shots, least_squares(of_shots, z), z));
    }
    return best;
  }

 private:
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

/// Of a share over draws.
class Moments {
 public:
  void add(double share) {
    sum_ += share;
    squares_ += share * share;
  }
  [[nodiscard]] double mean() const { return sum_ / kDraws; }
  [[nodiscard]] double variance() const { return squares_ / kDraws - mean() * mean(); }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
};

/// Shares that products explain.
struct NoiseShares {
  Moments any;
  Moments alike;
};

/// What products explain of noise: of strengths that are independent from place to place, with the
/// powers of cosine and sine that were found over all places.
NoiseShares shares_of_noise(const Products& products, const Eigen::MatrixXd& root,
                            const Eigen::VectorXd& white, std::size_t places) {
  const auto count = static_cast<Eigen::Index>(places);
  const Eigen::VectorXd found = root.transpose() * solve_symmetric(root * root.transpose(), white);
  const Eigen::Map<const Eigen::MatrixXd> parts(found.data(), count, 2);
  const Eigen::Matrix2d power = parts.transpose() * parts / static_cast<double>(places);
  const Eigen::Matrix2d spread = power.llt().matrixU();
  std::mt19937_64 random(kSearchSeed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd drawn(count, 2);
  NoiseShares shares;
  for (int n = 0; n < kDraws; ++n) {
    for (double& value : drawn.reshaped()) {
      value = normal(random);
    }
    const Eigen::MatrixXd noise = drawn * spread;
    const Eigen::VectorXd z = root * noise.reshaped();
    shares.any.add(products.explained(z) / z.squaredNorm());
    shares.alike.add(products.explained_alike(z) / z.squaredNorm());
  }
  return shares;
}

/// ln of the chance that a beta-distributed share with these moments is as large.
double log_beta_tail(double share, const Moments& noise) {
  const double mean = noise.mean();
  const double both = mean * (1.0 - mean) / noise.variance() - 1.0;
  const double tail = boost::math::ibetac(mean * both, (1.0 - mean) * both, std::min(share, 1.0));
  return std::log(std::max(tail, std::numeric_limits<double>::min()));
}

/// What products of one form say, beside what a single gauge would explain.
ProductTest judged(double explained, double at_one_gauge, double all, double seen,
                   const Moments& noise) {
  const double share = all > 0.0 ? explained / all : 0.0;
  if (share <= noise.mean() || noise.variance() <= 0.0) {
    return {};
  }
  const double freedom = seen * (1.0 - noise.mean());
  const double rest = std::max(all - explained, 1e-12 * all) / freedom;
  return {.log_p = log_beta_tail(share, noise),
          .beyond_one_gauge = (explained - at_one_gauge) / rest};
}

}  // namespace

ProductTest test_products(const Eigen::VectorXd& strengths, const Eigen::MatrixXd& information,
                          std::size_t shots, std::size_t gauges) {
  if (shots < 2 || gauges < 3) {
    return {};
  }
  const Seen seen(strengths, information);
  const Eigen::VectorXd& white = seen.white;
  const Products products(seen.root, shots, gauges);
  const NoiseShares noise = shares_of_noise(products, seen.root, white, shots * gauges);
  const double all = white.squaredNorm();
  const double at_one_gauge = products.at_one_gauge(white);
  const auto count = static_cast<double>(white.size());
  const ProductTest any = judged(products.explained(white), at_one_gauge, all, count, noise.any);
  const ProductTest alike =
      judged(products.explained_alike(white), at_one_gauge, all, count, noise.alike);
  ProductTest better = alike.log_p < any.log_p ? alike : any;
  better.log_p = std::min(0.0, better.log_p + std::log(2.0));
  return better;
}

NearestProducts nearest_products(const Eigen::VectorXd& strengths,
                                 const Eigen::MatrixXd& information, std::size_t shots,
                                 std::size_t gauges) {
  const Seen seen(strengths, information);
  const Products::Found found = Products(seen.root, shots, gauges).best(seen.white);
  return {found.explained > 0.0 ? found.strengths() : Eigen::VectorXd::Zero(strengths.size()),
          seen.white.squaredNorm() - found.explained};
}

}  // namespace kolsky
