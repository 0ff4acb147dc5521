#include "processing/criticism/noise/window_jumps.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/noise/small_factor.hpp"

namespace kolsky {

namespace {

/// Of a bin's power, at most: the rest of it is noise by itself.
constexpr double kMostShare = 0.9;

/// How much of the reference's jump each other residual has: as of its noise, where most of the
/// jump is.
Eigen::VectorXd gains_of(const GaugeNoise& noise, std::span<const CarriedBin> carried,
                         std::size_t reference, Eigen::Index others) {
  Eigen::VectorXd kept = Eigen::VectorXd::Zero(others);
  double all = 0.0;
  for (std::size_t k = 0; k < carried.size(); ++k) {
    const double leaked = noise.leaked(reference, k);
    kept += leaked * carried[k].ratio.head(others).cwiseAbs2();
    all += leaked;
  }
  return all > 0.0 ? (kept / all).cwiseSqrt() : kept;
}

/// What each gauge's jump of unit deviation is in the residuals at a bin, but for its quarter turn:
/// others x gauges.
Eigen::MatrixXd jumps_at(const GaugeNoise& noise, std::size_t bin, std::size_t reference,
                         const Eigen::VectorXd& gains) {
  Eigen::MatrixXd jumps = Eigen::MatrixXd::Zero(gains.size(), gains.size() + 1);
  Eigen::Index other = 0;
  for (std::size_t gauge = 0; gauge < noise.gauges(); ++gauge) {
    const auto column = static_cast<Eigen::Index>(gauge);
    const double amplitude = std::sqrt(noise.leaked(gauge, bin));
    if (gauge == reference) {
      jumps.col(column) = -amplitude * gains;
    } else {
      jumps(other++, column) = amplitude;
    }
  }
  return jumps;
}

using Residuals = Eigen::Map<Eigen::VectorXcd>;

/// Real and imaginary parts in turn.
Residuals complex(std::span<double> white) {
  return {reinterpret_cast<Complex*>(white.data()), static_cast<Eigen::Index>(white.size() / 2)};
}

}  // namespace

void WindowJumps::know(const GaugeNoise& noise, const Whitener& whitener,
                       std::span<const CarriedBin> carried) {
  directions_.resize(0, 0);
  if (noise.jumps()) {
    put_directions(noise, whitener, carried);
    part_bins();
    put_roots();
  }
}

void WindowJumps::put_directions(const GaugeNoise& noise, const Whitener& whitener,
                                 std::span<const CarriedBin> carried) {
  const auto gauges = static_cast<Eigen::Index>(noise.gauges());
  const Eigen::Index others = gauges - 1;
  const Eigen::VectorXd gains = gains_of(noise, carried, reference_, others);
  const Eigen::MatrixXd shared = noise.correlation().llt().matrixL();
  // The transform of a ramp from end to end is imaginary.
  const Complex quarter_turn(0.0, 1.0);
  directions_.resize(static_cast<Eigen::Index>(carried.size()) * others, gauges);
  for (std::size_t k = 0; k < carried.size(); ++k) {
    auto own = directions_.middleRows(static_cast<Eigen::Index>(k) * others, others);
    const Eigen::MatrixXd jumps = jumps_at(noise, k, reference_, gains) * shared;
    own.noalias() = quarter_turn * (whitener.factor(k) * jumps);
    const double share = 0.5 * own.squaredNorm();
    own *= std::sqrt(std::min(1.0, kMostShare / std::max(share, kMostShare)));
  }
  roots_.resize(carried.size());
}

void WindowJumps::part_bins() {
  const Eigen::Index others = directions_.cols() - 1;
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    auto own = directions_.middleRows(static_cast<Eigen::Index>(k) * others, others);
    Eigen::MatrixXcd& root = roots_[k];
    root = Eigen::MatrixXcd::Identity(others, others);
    root.noalias() -= 0.5 * own * own.adjoint();
    if (invert_factor(root)) {
      own = (root.triangularView<Eigen::Lower>() * own).eval();
    } else {
      root.setIdentity();
      own.setZero();
    }
  }
}

void WindowJumps::put_roots() {
  const SymmetricEigen squares((directions_.adjoint() * directions_).real());
  squares_ = squares.eigenvalues().cwiseMax(0.0);
  constexpr double kNone = 1e-12;
  const Eigen::VectorXd lengths = squares_.cwiseSqrt();
  turn_ = squares.eigenvectors() *
          lengths.unaryExpr([](double length) { return length > kNone ? 1.0 / length : 0.0; })
              .asDiagonal();
}

/// Along each direction, by a factor that goes with its square.
void WindowJumps::change(std::span<double> white, double (*by)(double square)) const {
  Residuals all = complex(white);
  const Eigen::VectorXd along = turn_.transpose() * (directions_.adjoint() * all).real();
  const Eigen::VectorXd factors = squares_.unaryExpr([&](double square) { return by(square); });
  all.noalias() += directions_ * (turn_ * (factors.array() - 1.0).matrix().cwiseProduct(along));
}

void WindowJumps::take_out(std::span<double> white) const {
  if (directions_.size() == 0) {
    return;
  }
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    auto own = complex(white).segment(static_cast<Eigen::Index>(k) * others(), others());
    own = (roots_[k].triangularView<Eigen::Lower>() * own).eval();
  }
  change(white, [](double square) { return 1.0 / std::sqrt(1.0 + square); });
}

void WindowJumps::put_in(std::span<double> white) const {
  if (directions_.size() == 0) {
    return;
  }
  change(white, [](double square) { return std::sqrt(1.0 + square); });
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    auto own = complex(white).segment(static_cast<Eigen::Index>(k) * others(), others());
    roots_[k].triangularView<Eigen::Lower>().solveInPlace(own);
  }
}

double WindowJumps::times_seen(std::span<const double> white, const Eigen::VectorXd& sizes,
                               double most) const {
  const Eigen::Index shots = sizes.size();
  if (directions_.size() == 0 || shots < 2) {
    return 1.0;
  }
  const Eigen::Map<const Eigen::MatrixXcd> by_shot(reinterpret_cast<const Complex*>(white.data()),
                                                   directions_.rows(), shots);
  const Eigen::MatrixXd jumps = turn_.transpose() * (directions_.adjoint() * by_shot).real();
  const Eigen::VectorXd follow = jumps * sizes.normalized();
  // As they were before they were made independent.
  const Eigen::ArrayXd power =
      (jumps.rowwise().squaredNorm() - follow.cwiseAbs2()).array() * (1.0 + squares_.array());
  const auto log_likelihood = [&](double times) {
    const Eigen::ArrayXd variance = 1.0 + times * squares_.array();
    return -0.5 * (static_cast<double>(shots - 1) * variance.log() + power / variance).sum();
  };
  constexpr int kPlaces = 60;
  constexpr double kLeast = 0.01;
  double best = most;
  for (int place = 1; place <= kPlaces; ++place) {
    const double times = most * std::pow(kLeast, static_cast<double>(place) / kPlaces);
    best = log_likelihood(times) > log_likelihood(best) ? times : best;
  }
  return best;
}

}  // namespace kolsky
