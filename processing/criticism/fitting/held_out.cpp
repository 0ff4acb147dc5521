#include "processing/criticism/fitting/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/record_parts.hpp"

namespace kolsky {

namespace {

using Places = std::vector<Eigen::Index>;  ///< of free numbers
using Fold = std::vector<std::size_t>;     ///< shots that are left out together

/// What first order says of shots that are left out.
struct Foretold {
  std::vector<double> theta;  ///< all as the other shots have them, but what is a shot's alone
  double square = 0.0;
};

Places numbers_of(const Composition& composition, const Fold& fold) {
  Places own;
  for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
    const std::ptrdiff_t shot = composition.numbers()[i].shot;
    if (shot >= 0 && std::ranges::find(fold, static_cast<std::size_t>(shot)) != fold.end()) {
      own.push_back(static_cast<Eigen::Index>(i));
    }
  }
  return own;
}

Places all_but(const Places& own, std::size_t numbers) {
  Places others;
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(numbers); ++i) {
    if (!std::ranges::binary_search(own, i)) {
      others.push_back(i);
    }
  }
  return others;
}

/// What strengths found in the shot itself took of its noise, which is put back.
double noise_taken_by(const Places& own) {
  return 2.0 * static_cast<double>(own.size());
}

std::vector<double> moved_inside(const Composition& composition, std::vector<double> theta,
                                 const Places& places, const Eigen::VectorXd& move) {
  for (std::size_t a = 0; a < places.size(); ++a) {
    const auto at = static_cast<std::size_t>(places[a]);
    theta[at] = composition.numbers()[at].inside(theta[at] + move[static_cast<Eigen::Index>(a)]);
  }
  return theta;
}

/// Where a fold's residuals stand among those of all shots, each of which has `size`.
Places rows_of(const Fold& fold, Eigen::Index size) {
  Places rows;
  for (const std::size_t shot : fold) {
    for (Eigen::Index k = 0; k < size; ++k) {
      rows.push_back(static_cast<Eigen::Index>(shot) * size + k);
    }
  }
  return rows;
}

Foretold foretold(const Studied& studied, const Fold& fold, Eigen::Index size) {
  const ModelFit& fit = studied.fit;
  const Places rows = rows_of(fold, size);
  Eigen::VectorXd residual = fit.residual(rows);
  const Places own = numbers_of(studied.composition, fold);
  const Places others = all_but(own, fit.theta.size());
  Foretold out{fit.theta, 0.0};
  if (!others.empty()) {
    const Eigen::MatrixXd columns = fit.jacobian(rows, others);
    const Eigen::MatrixXd left = fit.information(others, others) - columns.transpose() * columns;
    const Eigen::VectorXd move = least_norm_solution(left, columns.transpose() * residual);
    out.theta = moved_inside(studied.composition, std::move(out.theta), others, move);
    const Eigen::VectorXd changed = columns * move;
    residual += changed;
    if (!own.empty()) {
      const Eigen::MatrixXd strengths = fit.jacobian(rows, own);
      const Eigen::MatrixXd told = strengths.transpose() * strengths;
      const Eigen::VectorXd follow = -solve_symmetric(
          told + studied.composition.prior_precision()(own, own), strengths.transpose() * changed);
      out.theta = moved_inside(studied.composition, std::move(out.theta), own, follow);
      residual += strengths * follow;
    }
  }
  out.square = residual.squaredNorm() + noise_taken_by(own);
  return out;
}

/// A campaign's residuals with one shot left out: zeros in its place.
class AllButOne : public ShotResiduals {
 public:
  /// @param shots  of the campaign
  AllButOne(ShotResiduals& all, std::size_t left_out, std::size_t shots)
      : all_(all),
        left_out_(left_out),
        kept_share_(static_cast<double>(shots - 1) / static_cast<double>(shots)) {}

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

  double taken_by_noise(const Composition& composition, const std::vector<double>& theta,
                        std::size_t worker) override {
    return kept_share_ * all_.taken_by_noise(composition, theta, worker);
  }

  [[nodiscard]] std::size_t per_shot() const override { return all_.per_shot(); }

 private:
  ShotResiduals& all_;
  std::size_t left_out_;
  double kept_share_;
};

/// A shot under numbers that other shots have foretold.
class LeftOut {
 public:
  LeftOut(const Studied& studied, ShotResiduals& residuals, std::size_t shot, std::size_t worker)
      : studied_(studied),
        residuals_(residuals),
        shot_(shot),
        worker_(worker),
        own_(numbers_of(studied.composition, {shot})),
        precision_(studied.composition.prior_precision()(own_, own_)) {}

  [[nodiscard]] double square_at(const std::vector<double>& theta) const {
    return residual_at(theta).squaredNorm() + noise_taken_by(own_);
  }

  /// With the strengths that are its alone as this shot has them: no other tells of them, and a fit
  /// to the others leaves them where they are filed. @param theta  those among the rest
  [[nodiscard]] std::vector<double> own_found(std::vector<double> theta) const {
    if (own_.empty()) {
      return theta;
    }
    constexpr int kMostSteps = 8;
    constexpr double kSettled = 1e-2;  ///< of chi2
    for (const Eigen::Index i : own_) {
      theta[static_cast<std::size_t>(i)] = studied_.fit.theta[static_cast<std::size_t>(i)];
    }
    Place here = at(std::move(theta));
    for (int step = 0; step < kMostSteps; ++step) {
      Place next = at(stepped(here));
      const double gain = here.objective - next.objective;
      if (gain > 0.0) {
        here = std::move(next);
      }
      if (!(gain > kSettled)) {
        break;
      }
    }
    return std::move(here.theta);
  }

 private:
  struct Place {
    std::vector<double> theta;
    Eigen::VectorXd residual;
    Eigen::VectorXd strain;  ///< of what is filed of this shot alone: half the penalty's gradient
    double objective = 0.0;
  };

  [[nodiscard]] Place at(std::vector<double> theta) const {
    Eigen::VectorXd off(static_cast<Eigen::Index>(own_.size()));
    for (std::size_t a = 0; a < own_.size(); ++a) {
      const auto i = static_cast<std::size_t>(own_[a]);
      const FreeNumber& number = studied_.composition.numbers()[i];
      off[static_cast<Eigen::Index>(a)] = theta[i] - number.theta_of(number.prior_mean);
    }
    Place place{std::move(theta), {}, precision_ * off, 0.0};
    place.residual = residual_at(place.theta);
    place.objective = place.residual.squaredNorm() + off.dot(place.strain);
    return place;
  }

  /// By the common fit's derivatives.
  [[nodiscard]] std::vector<double> stepped(const Place& here) const {
    const ModelFit& fit = studied_.fit;
    const auto size = static_cast<Eigen::Index>(residuals_.per_shot());
    const Eigen::MatrixXd columns =
        fit.jacobian.middleRows(static_cast<Eigen::Index>(shot_) * size, size)(Eigen::all, own_);
    const Eigen::VectorXd downhill = -(columns.transpose() * here.residual + here.strain);
    return moved_inside(studied_.composition, here.theta, own_,
                        solve_symmetric(fit.information(own_, own_), downhill));
  }

  [[nodiscard]] Eigen::VectorXd residual_at(const std::vector<double>& theta) const {
    return residuals_.evaluate_shot(studied_.composition, theta, shot_, worker_);
  }

  const Studied& studied_;
  ShotResiduals& residuals_;
  std::size_t shot_;
  std::size_t worker_;
  Places own_;
  Eigen::MatrixXd precision_;  ///< of what is filed of them
};

double held_out_square(const Studied& studied, ShotResiduals& residuals, std::size_t shot,
                       std::size_t worker) {
  const auto size = static_cast<Eigen::Index>(residuals.per_shot());
  const auto at = static_cast<Eigen::Index>(shot);
  const Foretold first_order = foretold(studied, {shot}, size);
  const LeftOut left_out(studied, residuals, shot, worker);
  const double square = left_out.square_at(first_order.theta);
  const double seen = studied.fit.residual.segment(at * size, size).squaredNorm();
  // Less than this share of what leaving out costs decides nothing.
  constexpr double kShare = 0.2;
  constexpr double kNothing = 1.0;
  const double doubt = std::abs(square - first_order.square);
  if (doubt <= kNothing + kShare * (first_order.square - seen)) {
    return square;
  }
  AllButOne others(residuals, shot, static_cast<std::size_t>(studied.fit.residual.size() / size));
  Eigen::MatrixXd chord = studied.fit.jacobian;
  chord.middleRows(at * size, size).setZero();
  const ModelFit fit =
      fit_model(studied.composition, others, serial_on(worker), studied.fit.theta, &chord);
  return left_out.square_at(left_out.own_found(fit.theta));
}

}  // namespace

std::vector<double> held_out_squares(const Studied& studied, std::size_t residuals_per_shot,
                                     const std::vector<std::vector<std::size_t>>& folds) {
  const ModelFit& fit = studied.fit;
  const auto size = static_cast<Eigen::Index>(residuals_per_shot);
  std::vector<double> squares;
  for (const Fold& fold : folds) {
    squares.push_back(folds.size() < 2 || fit.theta.empty()
                          ? fit.residual(rows_of(fold, size)).squaredNorm()
                          : foretold(studied, fold, size).square);
  }
  return squares;
}

std::vector<double> held_out_squares(const Studied& studied, std::size_t residuals_per_shot) {
  const std::size_t shots =
      static_cast<std::size_t>(studied.fit.residual.size()) / residuals_per_shot;
  std::vector<Fold> folds;
  for (std::size_t shot = 0; shot < shots; ++shot) {
    folds.push_back({shot});
  }
  return held_out_squares(studied, residuals_per_shot, folds);
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
