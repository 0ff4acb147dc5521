#include "processing/criticism/fitting/fixed_point.hpp"

#include <algorithm>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// Of each change, squared: directions that hardly differ may not undo each other.
constexpr double kRidge = 1e-14;

}  // namespace

void FixedPoint::begin(std::size_t places) {
  const auto size = static_cast<Eigen::Index>(2 * places);
  steps_.resize(size, kDepth);
  changes_.resize(size, kDepth);
  products_.resize(kDepth, kDepth);
  taken_ = 0;
}

void FixedPoint::step(std::vector<Complex>& x, const std::vector<Complex>& of_x) {
  // A complex vector is one of twice as many real numbers.
  const auto size = static_cast<Eigen::Index>(2 * x.size());
  Eigen::Map<Eigen::VectorXd> now(reinterpret_cast<double*>(x.data()), size);
  const Eigen::Map<const Eigen::VectorXd> there(reinterpret_cast<const double*>(of_x.data()), size);
  const Eigen::VectorXd rest = there - now;
  const Eigen::Index known = std::min(taken_, kDepth);
  if (known > 0) {
    const Eigen::Index last = (taken_ - 1) % kDepth;
    steps_.col(last) = now - x_;
    changes_.col(last) = rest - rest_;
    products_.col(last).head(known) = changes_.leftCols(known).transpose() * changes_.col(last);
    products_.row(last).head(known) = products_.col(last).head(known).transpose();
  }
  x_ = now;
  rest_ = rest;
  now = there;
  if (known > 0) {
    const auto changes = changes_.leftCols(known);
    Eigen::MatrixXd products = products_.topLeftCorner(known, known);
    products.diagonal() *= 1.0 + kRidge;
    const Eigen::VectorXd shares = solve_symmetric(products, changes.transpose() * rest);
    now -= steps_.leftCols(known) * shares + changes * shares;
  }
  ++taken_;
}

}  // namespace kolsky
