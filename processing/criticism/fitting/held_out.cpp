#include "processing/criticism/fitting/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/record_parts.hpp"

namespace kolsky {

namespace {

/// What first order says of one shot that is left out.
struct Foretold {
  std::vector<double> theta;  ///< with the shared numbers where the other shots have them
  double square = 0.0;
  double own = 0.0;  ///< twice the strengths that are this shot's alone
};

Foretold foretold(const Studied& studied, Eigen::Index shot, Eigen::Index size) {
  const ModelFit& fit = studied.fit;
  const auto rows = fit.jacobian.middleRows(shot * size, size);
  const auto residual = fit.residual.segment(shot * size, size);
  Foretold out{fit.theta, 0.0, 0.0};
  // Shared numbers move to where the other shots alone would have them; those of this shot stay.
  std::vector<Eigen::Index> shared;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const std::ptrdiff_t of = studied.composition.numbers()[i].shot;
    if (of < 0) {
      shared.push_back(static_cast<Eigen::Index>(i));
    } else if (of == shot) {
      out.own += 2.0;
    }
  }
  if (shared.empty()) {
    out.square = residual.squaredNorm() + out.own;
    return out;
  }
  const Eigen::MatrixXd columns = rows(Eigen::all, shared);
  const Eigen::MatrixXd others = fit.information(shared, shared) - columns.transpose() * columns;
  const Eigen::VectorXd move = least_norm_solution(others, columns.transpose() * residual);
  for (std::size_t a = 0; a < shared.size(); ++a) {
    const auto at = static_cast<std::size_t>(shared[a]);
    const FreeNumber& number = studied.composition.numbers()[at];
    out.theta[at] = number.inside(fit.theta[at] + move[static_cast<Eigen::Index>(a)]);
  }
  out.square = (residual + columns * move).squaredNorm() + out.own;
  return out;
}

/// A campaign's residuals with one shot left out: zeros in its place.
class AllButOne : public ShotResiduals {
 public:
  AllButOne(ShotResiduals& all, std::size_t left_out) : all_(all), left_out_(left_out) {}

  Eigen::VectorXd evaluate(const Composition& composition, const std::vector<double>& theta,
                           std::size_t worker) override {
    Eigen::VectorXd residual = all_.evaluate(composition, theta, worker);
    const auto size = static_cast<Eigen::Index>(all_.per_shot());
    residual.segment(static_cast<Eigen::Index>(left_out_) * size, size).setZero();
    return residual;
  }

  Eigen::VectorXd evaluate_shot(const Composition& composition, const std::vector<double>& theta,
                                std::size_t shot, std::size_t worker) override {
    if (shot == left_out_) {
      return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all_.per_shot()));
    }
    return all_.evaluate_shot(composition, theta, shot, worker);
  }

  [[nodiscard]] std::size_t per_shot() const override { return all_.per_shot(); }

 private:
  ShotResiduals& all_;
  std::size_t left_out_;
};

double held_out_square(const Studied& studied, ShotResiduals& residuals, std::size_t shot,
                       std::size_t worker) {
  const auto size = static_cast<Eigen::Index>(residuals.per_shot());
  const auto at = static_cast<Eigen::Index>(shot);
  const Foretold first_order = foretold(studied, at, size);
  const auto square_at = [&](const std::vector<double>& theta) {
    return residuals.evaluate_shot(studied.composition, theta, shot, worker).squaredNorm() +
           first_order.own;
  };
  const double square = square_at(first_order.theta);
  const double seen = studied.fit.residual.segment(at * size, size).squaredNorm();
  // Less than this share of what leaving out costs decides nothing.
  constexpr double kShare = 0.2;
  constexpr double kNothing = 1.0;
  const double doubt = std::abs(square - first_order.square);
  if (doubt <= kNothing + kShare * (first_order.square - seen)) {
    return square;
  }
  AllButOne others(residuals, shot);
  Eigen::MatrixXd chord = studied.fit.jacobian;
  chord.middleRows(at * size, size).setZero();
  const ModelFit fit =
      fit_model(studied.composition, others, serial_on(worker), studied.fit.theta, &chord);
  return square_at(fit.theta);
}

}  // namespace

std::vector<double> held_out_squares(const Studied& studied, std::size_t residuals_per_shot) {
  const ModelFit& fit = studied.fit;
  const auto size = static_cast<Eigen::Index>(residuals_per_shot);
  const Eigen::Index shots = fit.residual.size() / size;
  std::vector<double> squares;
  for (Eigen::Index n = 0; n < shots; ++n) {
    squares.push_back(shots < 2 || fit.theta.empty()
                          ? fit.residual.segment(n * size, size).squaredNorm()
                          : foretold(studied, n, size).square);
  }
  return squares;
}

std::vector<double> held_out_squares(const Studied& studied, ShotResiduals& residuals,
                                     const Workers& executor) {
  std::vector<double> squares = held_out_squares(studied, residuals.per_shot());
  if (squares.size() < 2 || studied.fit.theta.empty()) {
    return squares;
  }
  executor.run(squares.size(), [&](std::size_t shot, std::size_t worker) {
    squares[shot] = held_out_square(studied, residuals, shot, worker);
  });
  return squares;
}

std::vector<double> held_out_squares(const Studied& studied, Study& study) {
  return study.campaign().shots.size() > 1
             ? held_out_squares(studied, study.residuals(), study.executor())
             : foretold_squares(studied, study);
}

std::vector<double> foretold_squares(const Studied& studied, Study& study) {
  return study.campaign().shots.size() > 1
             ? held_out_squares(studied, study.residuals().per_shot())
             : held_out_parts(studied.fit, study.residuals().others().size());
}

double held_out_misfit(const std::vector<double>& squares, double penalty, double residuals) {
  return (std::accumulate(squares.begin(), squares.end(), 0.0) + penalty) / residuals;
}

double floor_of(const Studied& after, Left left, std::size_t shots) {
  if (shots < 2) {
    return 1.0;
  }
  return left == Left::more
             ? after.misfit.noise_scale
             : (after.fit.chi2 + after.fit.penalty + static_cast<double>(after.fit.theta.size())) /
                   static_cast<double>(after.fit.residual.size());
}

Certification certification(const std::vector<double>& before, const std::vector<double>& after,
                            double relief, std::vector<double> weight) {
  double all = std::accumulate(weight.begin(), weight.end(), 0.0);
  if (!(all > 0.0)) {
    weight.assign(before.size(), 1.0);
    all = static_cast<double>(before.size());
  }
  Certification certified{relief, 0, 0.0};
  const double part = relief / static_cast<double>(before.size());
  for (std::size_t n = 0; n < before.size(); ++n) {
    const double gain = before[n] - after[n];
    certified.gain += gain;
    if (gain + part > 0.0) {
      ++certified.better;
      certified.share += weight[n] / all;
    }
  }
  return certified;
}

}  // namespace kolsky
