#include "processing/criticism/verdict/single_shots.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

constexpr double kResolved = 1e-6;

/// What a shot's residuals hold in some directions.
struct InDirections {
  double square = 0.0;
  double count = 0.0;
};

InDirections in_directions(Eigen::MatrixXd columns, const Eigen::VectorXd& residual) {
  columns.colwise().normalize();
  const SymmetricEigen solver(columns.transpose() * columns);
  const Eigen::VectorXd pull = solver.eigenvectors().transpose() * (columns.transpose() * residual);
  InDirections own;
  for (Eigen::Index i = 0; i < pull.size(); ++i) {
    if (solver.eigenvalues()[i] > kResolved) {
      own.square += pull[i] * pull[i] / solver.eigenvalues()[i];
      own.count += 1.0;
    }
  }
  return own;
}

/// A gauge's gain and delay shot by shot, as far as they differ.
class OwnReadings {
 public:
  OwnReadings(const SensorColumns& sensor, const Eigen::VectorXd& residual, std::size_t shots,
              std::size_t per_shot) {
    const auto size = static_cast<Eigen::Index>(per_shot);
    const Eigen::Index numbers = sensor.columns.cols();
    whole_ = Eigen::MatrixXd::Zero(numbers, numbers);
    all_ = Eigen::VectorXd::Zero(numbers);
    for (Eigen::Index n = 0; n < static_cast<Eigen::Index>(shots); ++n) {
      const auto own = sensor.columns.middleRows(n * size, size);
      information_.emplace_back(own.transpose() * own);
      pull_.emplace_back(-own.transpose() * residual.segment(n * size, size));
      whole_ += information_.back();
      all_ += pull_.back();
      square_ += pull_.back().dot(solve_symmetric(information_.back(), pull_.back()));
    }
    square_ = std::max(0.0, square_ - all_.dot(solve_symmetric(whole_, all_)));
    freedom_ = static_cast<double>(numbers) * (static_cast<double>(shots) - 1.0);
  }

  [[nodiscard]] double square() const { return square_; }
  [[nodiscard]] double freedom() const { return freedom_; }

  /// The shot whose gain and delay are furthest from those of the others together.
  [[nodiscard]] ReadingOfShot furthest(std::size_t gauge, double noise) const {
    ReadingOfShot worst{gauge, 0, {}, {}};
    double most = -1.0;
    for (std::size_t n = 0; n < pull_.size(); ++n) {
      const Eigen::MatrixXd others = whole_ - information_[n];
      const Eigen::VectorXd off =
          solve_symmetric(information_[n], pull_[n]) - solve_symmetric(others, all_ - pull_[n]);
      const Eigen::MatrixXd covariance =
          noise * (symmetric_inverse(information_[n]) + symmetric_inverse(others));
      const double square = off.dot(solve_symmetric(covariance, off));
      if (square > most) {
        most = square;
        worst = {
            gauge, n, {off[0], std::sqrt(covariance(0, 0))}, {off[1], std::sqrt(covariance(1, 1))}};
      }
    }
    return worst;
  }

 private:
  Eigen::MatrixXd whole_;
  Eigen::VectorXd all_;
  std::vector<Eigen::MatrixXd> information_;
  std::vector<Eigen::VectorXd> pull_;
  double square_ = 0.0;
  double freedom_ = 0.0;
};

double noise_power(const Studied& studied, std::size_t shots) {
  return std::max(1.0, noise_of(studied.misfit, shots));
}

}  // namespace

double log_p_of_own_numbers(const Studied& studied, std::size_t count, std::size_t per_shot,
                            double known) {
  const auto shots = static_cast<Eigen::Index>(count);
  const auto size = static_cast<Eigen::Index>(per_shot);
  std::vector<Eigen::Index> shared;
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    const EffectUse& use = studied.composition.uses()[number.use];
    // Of one shot what depends on its amplitude or temperature is a change of the moduli, but for
    // the noise in its derivative, which finds itself in the residuals.
    if (number.shot < 0 && !use.effect->about().shot_facts) {
      shared.push_back(static_cast<Eigen::Index>(i));
    }
  }
  if (shared.empty() || shots < 3) {
    return 0.0;
  }
  InDirections all;
  double common = 0.0;
  for (Eigen::Index n = 0; n < shots; ++n) {
    const InDirections own =
        in_directions(studied.fit.jacobian(Eigen::seqN(n * size, size), shared),
                      studied.fit.residual.segment(n * size, size));
    all.square += own.square;
    all.count += own.count;
    common = std::max(common, own.count);
  }
  const double freedom = all.count - common;
  return freedom > 0.0
             ? log_f_tail(all.square / freedom / noise_power(studied, count), freedom, known)
             : 0.0;
}

ShotsApart readings_apart(const Studied& studied, std::span<const SensorColumns> sensors,
                          std::size_t shots, std::size_t per_shot, double known) {
  if (shots < 3 || sensors.empty()) {
    return {};
  }
  const double noise = noise_power(studied, shots);
  std::vector<double> log_ps;
  std::vector<double> weights;
  ShotsApart out;
  double least = 0.0;
  for (const SensorColumns& sensor : sensors) {
    const OwnReadings own(sensor, studied.fit.residual, shots, per_shot);
    log_ps.push_back(log_f_tail(own.square() / own.freedom() / noise, own.freedom(), known));
    weights.push_back(1.0 / static_cast<double>(sensors.size()));
    if (!out.furthest || log_ps.back() < least) {
      least = log_ps.back();
      out.furthest = own.furthest(sensor.gauge, noise);
    }
  }
  out.log_p = combined_log_p(log_ps, weights);
  return out;
}

}  // namespace kolsky
