#include "processing/criticism/fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/reduction/first_pulse.hpp"

namespace kolsky {

namespace {

constexpr int kMostIterations = 25;
constexpr double kSettled = 1e-3;  ///< change of chi2 that no claim depends on

/// How far theta is from the middle of the priors, in scales.
Eigen::VectorXd from_priors(const Composition& composition, const std::vector<double>& theta) {
  Eigen::VectorXd off(static_cast<Eigen::Index>(theta.size()));
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    off[static_cast<Eigen::Index>(i)] = theta[i] - number.theta_of(number.prior_mean);
  }
  return off;
}

double penalty_of(const Composition& composition, const Eigen::MatrixXd& precision,
                  const std::vector<double>& theta) {
  const Eigen::VectorXd off = from_priors(composition, theta);
  return off.dot(precision * off);
}

void keep_inside(const Composition& composition, std::vector<double>& theta) {
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    theta[i] = number.inside(theta[i]);
  }
}

bool at_bound(const FreeNumber& number, double theta, double downhill) {
  const double value = number.value_at(theta);
  const double reach = 1e-9 * (number.upper - number.lower);
  return (value <= number.lower + reach && downhill < 0.0) ||
         (value >= number.upper - reach && downhill > 0.0);
}

}  // namespace

double ModelFit::degrees_of_freedom(const Composition& composition) const {
  double used = 0.0;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    // A prior that decides by itself costs the data nothing.
    const double from_prior =
        number.prior_sd > 0.0
            ? covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) *
                  number.scale * number.scale / (number.prior_sd * number.prior_sd)
            : 0.0;
    used += 1.0 - std::min(1.0, from_prior);
  }
  return static_cast<double>(residual.size()) - used;
}

Eigen::MatrixXd derivatives(const Composition& composition, ShotResiduals& residuals,
                            const std::vector<double>& theta, const Eigen::VectorXd& at_theta,
                            const std::vector<std::size_t>& numbers, const Workers& executor) {
  Eigen::MatrixXd columns(at_theta.size(), static_cast<Eigen::Index>(numbers.size()));
  executor.run(numbers.size(), [&](std::size_t i, std::size_t worker) {
    std::vector<double> moved = theta;
    const FreeNumber& number = composition.numbers()[numbers[i]];
    // Away from the bound that is next to the value.
    const double room = number.theta_of(number.upper) - moved[numbers[i]];
    const double step = room > number.difference ? number.difference : -number.difference;
    moved[numbers[i]] += step;
    const auto column = static_cast<Eigen::Index>(i);
    if (number.shot >= 0 && !residuals.shots_hang_together()) {
      const auto size = static_cast<Eigen::Index>(residuals.per_shot());
      const Eigen::Index first = number.shot * size;
      const auto shot = static_cast<std::size_t>(number.shot);
      columns.col(column).setZero();
      columns.col(column).segment(first, size) =
          (residuals.evaluate_shot(composition, moved, shot, worker) -
           at_theta.segment(first, size)) /
          step;
    } else {
      columns.col(column) = (residuals.evaluate(composition, moved, worker) - at_theta) / step;
    }
  });
  return columns;
}

ModelFit fit_model(const Composition& composition, ShotResiduals& residuals,
                   const Workers& executor, std::vector<double> start,
                   const Eigen::MatrixXd* chord) {
  ModelFit fit;
  fit.theta = start.empty() ? composition.start() : std::move(start);
  keep_inside(composition, fit.theta);
  const auto count = static_cast<Eigen::Index>(fit.theta.size());
  const Eigen::MatrixXd precision = composition.prior_precision();
  std::vector<std::size_t> all(fit.theta.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  fit.residual = residuals.evaluate(composition, fit.theta, executor.first);
  fit.chi2 = fit.residual.squaredNorm();
  fit.penalty = penalty_of(composition, precision, fit.theta);
  if (count == 0) {
    // Nothing is free: the model is what it is.
    fit.jacobian.resize(fit.residual.size(), 0);
    fit.converged = true;
    return fit;
  }
  double damping = 0.0;
  bool fresh = false;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    if (chord != nullptr && !fresh) {
      fit.jacobian = *chord;
    } else {
      fit.jacobian = derivatives(composition, residuals, fit.theta, fit.residual, all, executor);
      fresh = true;
    }
    fit.information = fit.jacobian.transpose() * fit.jacobian;
    Eigen::VectorXd downhill = -fit.jacobian.transpose() * fit.residual;
    fit.information += precision;
    downhill -= precision * from_priors(composition, fit.theta);
    // A number that is held by its bound takes no part in this step.
    Eigen::MatrixXd information = fit.information;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (at_bound(composition.numbers()[at], fit.theta[at], downhill[i])) {
        downhill[i] = 0.0;
        information.row(i).setZero();
        information.col(i).setZero();
        information(i, i) = 1.0;
      }
    }
    bool better = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() +=
          damping * information.diagonal() +
          Eigen::VectorXd::Constant(count, 1e-12 * information.diagonal().maxCoeff());
      const Eigen::VectorXd step = damped.ldlt().solve(downhill);
      std::vector<double> moved = fit.theta;
      for (Eigen::Index i = 0; i < count; ++i) {
        moved[static_cast<std::size_t>(i)] += step[i];
      }
      keep_inside(composition, moved);
      const Eigen::VectorXd residual = residuals.evaluate(composition, moved, executor.first);
      const double chi2 = residual.squaredNorm();
      const double penalty = penalty_of(composition, precision, moved);
      gain = fit.objective() - chi2 - penalty;
      if (std::isfinite(chi2) && gain > -1e-6) {
        better = true;
        fit.theta = std::move(moved);
        fit.residual = residual;
        fit.chi2 = chi2;
        fit.penalty = penalty;
        damping = damping > 1e-6 ? damping / 10.0 : 0.0;
      } else {
        damping = std::max(1e-4, damping * 10.0);
      }
    }
    // What a full step would gain if the residuals were straight.
    const double promised = downhill.dot(information.ldlt().solve(downhill));
    if (chord != nullptr && !fresh) {
      // The borrowed derivatives serve as long as what they promise comes true.
      if (better && gain < kSettled) {
        fit.converged = true;
        break;
      }
      fresh = !better || gain < 0.5 * promised;
      continue;
    }
    // A short step gains little wherever it is: only where a full one would too has the fit come to
    // rest.
    if (!better || (gain < kSettled && (damping == 0.0 || promised < kSettled))) {
      fit.converged = better || damping > 1e3;
      break;
    }
  }
  // Numbers that neither data nor prior hold are left out of the inverse.
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(fit.information);
  if (count > 0) {
    Eigen::VectorXd inverse = solver.eigenvalues();
    const double least = 1e-13 * inverse.maxCoeff();
    for (Eigen::Index i = 0; i < count; ++i) {
      inverse[i] = 1.0 / std::max(inverse[i], least);
    }
    fit.covariance =
        solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  } else {
    fit.covariance.resize(0, 0);
  }
  return fit;
}

namespace {

/// Half-height crossing of a gauge's first pulse [s from the first sample]; negative for none.
double arrival_s(const CampaignShot& shot, std::size_t gauge, double period_s) {
  const auto pulse = first_pulse(shot.strain[gauge], 1.0 / period_s);
  return pulse ? static_cast<double>(pulse->rise) * period_s : -1.0;
}

/// Wave speed on the input bar from the first gauge to the last, 0 where it cannot be told.
double measured_speed(const Campaign& campaign) {
  const std::size_t first = campaign.reference;
  std::size_t last = first;
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    const Gauge& gauge = campaign.bench.gauges[j];
    if (gauge.bar != "output" && gauge.position_m > campaign.bench.gauges[last].position_m) {
      last = j;
    }
  }
  if (last == first) {
    return 0.0;
  }
  const double distance_m =
      campaign.bench.gauges[last].position_m - campaign.bench.gauges[first].position_m;
  std::vector<double> speeds;
  for (const CampaignShot& shot : campaign.shots) {
    const double a = arrival_s(shot, first, campaign.period_s);
    const double b = arrival_s(shot, last, campaign.period_s);
    if (a >= 0.0 && b > a) {
      speeds.push_back(distance_m / (b - a));
    }
  }
  if (speeds.empty()) {
    return 0.0;
  }
  std::nth_element(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2),
                   speeds.end());
  return speeds[speeds.size() / 2];
}

double chi2_of(const Model& model, const Campaign& campaign, WhiteResiduals& residuals,
               std::size_t worker) {
  const Composition composition(model, campaign);
  return residuals.evaluate(composition, composition.start(), worker).squaredNorm();
}

/// Scales three moduli together by powers of `ratio` around where they are; keeps the best.
void search_moduli(Model& model, const std::string& id, double ratio, int reach,
                   const Campaign& campaign, WhiteResiduals& residuals, std::size_t worker) {
  const EffectUse start = *model.find(id);
  double best = std::numeric_limits<double>::infinity();
  EffectUse kept = start;
  for (int i = -reach; i <= reach; ++i) {
    EffectUse* use = model.find(id);
    for (std::size_t p = 0; p < 3; ++p) {
      use->values[p].value = start.values[p].value * std::pow(ratio, i);
    }
    const double chi2 = chi2_of(model, campaign, residuals, worker);
    if (chi2 < best) {
      best = chi2;
      kept = *use;
    }
  }
  *model.find(id) = kept;
}

bool all_free(const EffectUse& use) {
  return std::all_of(use.values.begin(), use.values.end(),
                     [](const ModelValue& value) { return value.free; });
}

}  // namespace

void start_moduli(Model& model, const Campaign& campaign, WhiteResiduals& residuals,
                  std::size_t worker) {
  EffectUse* bar = model.find("three-element-bar");
  if (bar != nullptr && all_free(*bar) && campaign.bench.kind == BenchKind::bar) {
    const double speed = measured_speed(campaign);
    if (speed > 0.0) {
      const double rho = campaign.bench.input.density_kg_m3;
      // A pulse travels between the relaxed and the instantaneous speed.
      constexpr double kAboveMeasured = 1.08;
      const double scale = kAboveMeasured * rho * speed * speed / bar->values[0].value;
      if (std::abs(scale - 1.0) > 0.1) {
        for (ModelValue& value : bar->values) {
          value.value *= scale;
        }
      }
    }
    search_moduli(model, "three-element-bar", 1.03, 5, campaign, residuals, worker);
  }
  EffectUse* specimen = model.find("three-element-specimen");
  if (specimen != nullptr && all_free(*specimen)) {
    search_moduli(model, "three-element-specimen", 2.0, 14, campaign, residuals, worker);
  }
}

Model fitted(const Model& model, const Composition& composition, const ModelFit& fit) {
  Model out = model;
  for (std::size_t u = 0; u < composition.uses().size(); ++u) {
    EffectUse use = composition.uses()[u];
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      double sum = 0.0;
      double square = 0.0;
      double variance = 0.0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < fit.theta.size(); ++i) {
        const FreeNumber& number = composition.numbers()[i];
        if (number.use == u && number.parameter == p) {
          const double value = number.value_at(fit.theta[i]);
          sum += value;
          square += value * value;
          const auto at = static_cast<Eigen::Index>(i);
          const double theta_variance =
              fit.covariance(at, at) + (fit.doubt.size() > 0 ? fit.doubt(at, at) : 0.0);
          const double sd = number.sd_at(fit.theta[i], std::sqrt(theta_variance));
          variance += sd * sd;
          ++count;
        }
      }
      if (count > 0) {
        const auto n = static_cast<double>(count);
        use.values[p].value =
            use.effect->about().each_gauge && count > 1 ? std::sqrt(square / n) : sum / n;
        use.values[p].sd = std::sqrt(variance) / n;
      }
    }
    if (EffectUse* own = out.find(use.id())) {
      *own = use;
    } else {
      out.effects.push_back(use);
    }
  }
  return out;
}

}  // namespace kolsky
