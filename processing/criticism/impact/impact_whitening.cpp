#include "processing/criticism/impact/impact_whitening.hpp"

#include <cmath>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

constexpr double kRippleMemory_s = 12e-6;  ///< of a contact that grows node by node
constexpr double kSolverMemory_s = 60e-6;  ///< over which a solver's error keeps its sign
constexpr double kSolverMemory = 0.5;      ///< the same in the logarithm of the speed
constexpr double kArrivalFree_s = 5e-6;
/// Of the restitution, from speed to speed, besides what is alike.
constexpr double kRestitutionScatter = 0.0007;

/// What residuals do where all speeds, the rebounds' too, are filed too high by their own size.
Eigen::VectorXd mistimed(const ImpactShape& shape) {
  Eigen::VectorXd off = -shape.by_speed;
  off[off.size() - 1] += shape.reading[off.size() - 1];
  return off;
}

}  // namespace

Eigen::MatrixXd symmetric_power(const Eigen::MatrixXd& matrix, double power) {
  const SymmetricEigen solver(matrix);
  const double least = 1e-14 * solver.eigenvalues().maxCoeff();
  return solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(least).array().pow(power).matrix().asDiagonal() *
         solver.eigenvectors().transpose();
}

ImpactWhitening::ImpactWhitening(const ImpactRecords& records,
                                 const std::vector<ImpactShape>& shapes, const ImpactDoubts& doubts)
    : records_(records), size_(shapes.front().reading.size()) {
  set_own(shapes, doubts);
  set_shared(shapes, doubts);
  set_trends();
  mean_covariance_ = shared_;
  for (std::size_t g = 0; g < own_.size(); ++g) {
    const auto at = static_cast<Eigen::Index>(g) * size_;
    mean_covariance_.block(at, at, size_, size_) +=
        own_[g] / static_cast<double>(records_.groups[g].shots.size());
  }
  mean_root_ = symmetric_power(mean_covariance_, -0.5);
}

void ImpactWhitening::set_own(const std::vector<ImpactShape>& shapes, const ImpactDoubts& doubts) {
  const auto count = static_cast<Eigen::Index>(records_.window.samples);
  const Eigen::Index rebound = size_ - 1;
  for (std::size_t g = 0; g < shapes.size(); ++g) {
    const ImpactShape& shape = shapes[g];
    Eigen::MatrixXd own =
        std::pow(doubts.speed_sd, 2) * shape.by_speed * shape.by_speed.transpose() +
        std::pow(kArrivalFree_s, 2) * shape.by_time * shape.by_time.transpose();
    own.topLeftCorner(rebound, rebound) += doubts.noise;
    for (Eigen::Index first = 0; first < rebound; first += count) {
      // An offset of its own: what quiet samples before the pulse leave open, and more.
      own.block(first, first, count, count).array() += 100.0 * doubts.noise(first, first);
    }
    // What a group's shots do not say, their fellows' mean stands for.
    const SpeedGroup& group = records_.groups[g];
    const double said = std::max(1.0, static_cast<double>(group.shots.size()) -
                                          static_cast<double>(records_.unsaid_rebounds(g)));
    own(rebound, rebound) += std::pow(doubts.rebound_sd * shape.reading[rebound], 2) *
                             static_cast<double>(group.shots.size()) / said;
    roots_.push_back(symmetric_power(own, -0.5));
    own_.push_back(std::move(own));
  }
}

void ImpactWhitening::set_shared(const std::vector<ImpactShape>& shapes,
                                 const ImpactDoubts& doubts) {
  const std::size_t samples = records_.window.samples;
  const Eigen::Index rebound = size_ - 1;
  const auto groups = static_cast<Eigen::Index>(shapes.size());
  shared_ = Eigen::MatrixXd::Zero(groups * size_, groups * size_);
  // By group: how large an error may be at a sample.
  std::vector<Eigen::VectorXd> large;
  for (const ImpactShape& shape : shapes) {
    const double peak = shape.reading.head(rebound).cwiseAbs().maxCoeff();
    Eigen::VectorXd own(rebound);
    for (Eigen::Index i = 0; i < rebound; ++i) {
      const double e = std::abs(shape.reading[i]);
      // Where the contact is made and broken forces are small and times matter.
      own[i] = doubts.solver_sd * (e > 1e-3 * peak ? e + 0.05 * peak : 0.0);
    }
    large.push_back(std::move(own));
  }
  const auto time_s = [&](Eigen::Index i) {
    const auto place = static_cast<std::size_t>(i);
    return records_.force_s(place / samples, place % samples);
  };
  for (Eigen::Index g = 0; g < groups; ++g) {
    Eigen::MatrixXd& slope = slopes_.emplace_back(Eigen::MatrixXd::Zero(size_, size_));
    for (Eigen::Index h = 0; h < groups; ++h) {
      const auto a = static_cast<std::size_t>(g);
      const auto b = static_cast<std::size_t>(h);
      auto block = shared_.block(g * size_, h * size_, size_, size_);
      const double apart =
          std::log(records_.groups[a].speed_m_per_s / records_.groups[b].speed_m_per_s) /
          kSolverMemory;
      const double alike = std::exp(-0.5 * apart * apart);
      for (Eigen::Index i = 0; i < rebound; ++i) {
        for (Eigen::Index j = 0; j < rebound; ++j) {
          const double slow = (time_s(i) - time_s(j)) / kSolverMemory_s;
          const double quick = (time_s(i) - time_s(j)) / kRippleMemory_s;
          const double both = large[a][i] * large[b][j];
          block(i, j) = both * alike * std::exp(-0.5 * slow * slow);
          if (g == h) {
            slope(i, j) = both * std::exp(-0.5 * quick * quick);
          }
        }
      }
      const double incident = records_.incident(a) * records_.incident(b);
      block(rebound, rebound) += std::pow(kRestitutionDoubt, 2) * incident;
      if (g == h) {
        slope(rebound, rebound) = std::pow(kRestitutionScatter, 2) * incident;
        block += slope;
      }
    }
    slope /= kRippleSpeeds * kRippleSpeeds;
  }
  solver_ = shared_;
  for (std::size_t g = 0; g < shapes.size(); ++g) {
    for (std::size_t h = 0; h < shapes.size(); ++h) {
      shared_.block(static_cast<Eigen::Index>(g) * size_, static_cast<Eigen::Index>(h) * size_,
                    size_, size_) += std::pow(records_.common_speed_sd, 2) * mistimed(shapes[g]) *
                                     mistimed(shapes[h]).transpose();
    }
  }
}

void ImpactWhitening::set_trends() {
  for (std::size_t g = 0; g < own_.size(); ++g) {
    const std::vector<double>& faster = records_.groups[g].faster;
    Eigen::VectorXd trend =
        Eigen::Map<const Eigen::VectorXd>(faster.data(), static_cast<Eigen::Index>(faster.size()));
    const double square = trend.squaredNorm();
    if (square > 0.0) {
      trend /= std::sqrt(square);
    }
    trends_.push_back(std::move(trend));
    trend_squares_.push_back(square);
    trend_roots_.push_back(symmetric_power(own_[g] + square * slopes_[g], -0.5));
  }
}

Eigen::MatrixXd ImpactWhitening::shared(std::size_t g, std::size_t h) const {
  return shared_.block(static_cast<Eigen::Index>(g) * size_, static_cast<Eigen::Index>(h) * size_,
                       size_, size_);
}

Eigen::MatrixXd ImpactWhitening::means(const Eigen::MatrixXd& white) const {
  Eigen::MatrixXd groups = Eigen::MatrixXd::Zero(mean_root_.rows(), white.cols());
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const double share = 1.0 / std::sqrt(static_cast<double>(group.shots.size()));
    for (const std::size_t n : group.shots) {
      groups.middleRows(static_cast<Eigen::Index>(g) * size_, size_) +=
          share * white.middleRows(static_cast<Eigen::Index>(n) * size_, size_);
    }
  }
  return groups;
}

Eigen::VectorXd ImpactWhitening::means_behind(const Eigen::VectorXd& white) const {
  return mean_covariance_ * (mean_root_ * means(white));
}

Eigen::MatrixXd ImpactWhitening::pulls(const Eigen::MatrixXd& jacobian) const {
  return means(jacobian).transpose() * mean_root_;
}

Eigen::MatrixXd ImpactWhitening::white_force_doubt() const {
  Eigen::MatrixXd force = solver_;
  for (Eigen::Index rebound = size_ - 1; rebound < force.rows(); rebound += size_) {
    force.row(rebound).setZero();
    force.col(rebound).setZero();
  }
  return mean_root_ * force * mean_root_;
}

Eigen::VectorXd ImpactWhitening::white(const std::vector<Eigen::VectorXd>& residual) const {
  Eigen::VectorXd means = Eigen::VectorXd::Zero(mean_root_.rows());
  const auto mean_of = [&](std::size_t g) {
    return means.segment(static_cast<Eigen::Index>(g) * size_, size_);
  };
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    for (const std::size_t n : group.shots) {
      mean_of(g) += residual[n] / static_cast<double>(group.shots.size());
    }
  }
  const Eigen::VectorXd shared = mean_root_ * means;
  Eigen::VectorXd white(size_ * static_cast<Eigen::Index>(residual.size()));
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const double share = 1.0 / std::sqrt(static_cast<double>(group.shots.size()));
    Eigen::VectorXd trend = Eigen::VectorXd::Zero(size_);
    for (std::size_t i = 0; i < group.shots.size(); ++i) {
      trend += trends_[g][static_cast<Eigen::Index>(i)] * residual[group.shots[i]];
    }
    const Eigen::VectorXd white_trend = trend_roots_[g] * trend;
    for (std::size_t i = 0; i < group.shots.size(); ++i) {
      const double along = trends_[g][static_cast<Eigen::Index>(i)];
      const auto n = static_cast<Eigen::Index>(group.shots[i]);
      white.segment(n * size_, size_) =
          roots_[g] * (residual[group.shots[i]] - mean_of(g) - along * trend) +
          along * white_trend + share * shared.segment(static_cast<Eigen::Index>(g) * size_, size_);
    }
  }
  return white;
}

}  // namespace kolsky
