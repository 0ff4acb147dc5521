#include "processing/criticism/fitting/fit.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/fit_steps.hpp"

namespace kolsky {

namespace {

constexpr int kMostIterations = 25;
/// Steps that gain less than this share of what is promised, and less than this of chi2, lead on
/// along something that no number describes any better; so many of them on end are enough to see
/// that. All such gains are over what is left per residual where that is more than noise, as they
/// are weighed in the end.
constexpr double kIdle = 0.02;
constexpr double kIdleGain = 3.0;
constexpr int kMostIdle = 6;
constexpr double kSettled = 1e-3;  ///< change of chi2 that no claim depends on
/// The same where residuals are calculated and rough by as much (a contact grows by nodes), and a
/// square of a deviate counts over several (kSolverDoubt).
constexpr double kNear = 1.0;

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
  const Eigen::VectorXd here =
      residuals.has_quick_differences()
          ? residuals.evaluate_for_differences(composition, theta, executor.first)
          : at_theta;
  executor.run(numbers.size(), [&](std::size_t i, std::size_t worker) {
    std::vector<double> moved = theta;
    const FreeNumber& number = composition.numbers()[numbers[i]];
    // Of a number many times its scale a step that is a share of this would drown in rounding.
    constexpr double kLeastShare = 1e-5;
    const double length = std::max({number.difference, residuals.least_difference(),
                                    kLeastShare * std::abs(theta[numbers[i]])});
    // Away from the bound that is next to the value.
    const double room = number.theta_of(number.upper) - moved[numbers[i]];
    const double step = room > length ? length : -length;
    moved[numbers[i]] += step;
    const auto column = static_cast<Eigen::Index>(i);
    if (number.shot >= 0 && !residuals.shots_hang_together()) {
      const auto size = static_cast<Eigen::Index>(residuals.per_shot());
      const Eigen::Index first = number.shot * size;
      const auto shot = static_cast<std::size_t>(number.shot);
      columns.col(column).setZero();
      columns.col(column).segment(first, size) =
          (residuals.evaluate_shot(composition, moved, shot, worker) - here.segment(first, size)) /
          step;
    } else {
      columns.col(column) =
          (residuals.evaluate_for_differences(composition, moved, worker) - here) / step;
    }
  });
  return columns;
}

ModelFit fit_model(const Composition& composition, ShotResiduals& residuals,
                   const Workers& executor, std::vector<double> start,
                   const Eigen::MatrixXd* chord) {
  FitSteps steps(composition, residuals, executor, std::move(start));
  if (steps.nothing_free()) {
    return steps.as_it_is();
  }
  double damping = 0.0;
  bool fresh = false;
  bool short_before = false;  ///< the last step gained as little
  int idle = 0;               ///< steps on end that gained next to nothing of what was promised
  bool converged = false;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    if (chord != nullptr && !fresh) {
      steps.borrow(*chord);
    } else {
      steps.derive();
      fresh = true;
    }
    bool better = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      FitSteps::Step step = steps.tried(damping);
      gain = step.gain;
      better = step.better();
      if (better) {
        steps.take(std::move(step));
        damping = damping > 1e-6 ? damping / 10.0 : 0.0;
      } else {
        damping = std::max(1e-4, damping * 10.0);
      }
    }
    const double promised = steps.promised();
    const double misfit = std::max(1.0, steps.chi2_per_residual());
    const double settled = kSettled * misfit;
    if (chord != nullptr && !fresh) {
      // The borrowed derivatives serve as long as what they promise comes true.
      if (better && gain < settled) {
        converged = true;
        break;
      }
      fresh = !better || gain < 0.5 * promised;
      continue;
    }
    // A short step gains little wherever it is, so that where a full one would gain more the next,
    // longer one decides.
    const bool at_rest = gain < settled && (damping == 0.0 || promised < settled || short_before);
    short_before = gain < settled;
    if (!better || at_rest) {
      converged = better || damping > 1e3;
      break;
    }
    idle = gain < std::min(kIdle * promised, kIdleGain * misfit) ? idle + 1 : 0;
    if (idle == kMostIdle) {
      break;
    }
  }
  return steps.done(converged);
}

ModelFit fit_by_secants(const Composition& composition, ShotResiduals& residuals,
                        const Workers& executor, std::vector<double> start,
                        const Eigen::MatrixXd* chord, Settle settle) {
  FitSteps steps(composition, residuals, executor, std::move(start));
  if (steps.nothing_free()) {
    return steps.as_it_is();
  }
  const bool roughly = settle == Settle::roughly;
  bool fresh = chord == nullptr;  // derivatives made, and no step taken since
  if (fresh) {
    steps.derive();
  } else {
    steps.borrow(*chord);
  }
  double damping = 0.0;
  int refused = 0;
  bool converged = false;
  constexpr int kMostSteps = 40;
  constexpr int kMostRefused = 4;
  constexpr double kAsGood = 0.75;  ///< as what was foretold of a step
  constexpr double kCrawl = 0.15;   ///< of what derivatives just made promise
  constexpr int kMostCrawling = 2;
  int crawling = 0;
  for (int n = 0; n < kMostSteps && !converged; ++n) {
    // Of a misfit many times the noise nothing hangs on what noise is.
    const double near = kNear * std::max(1.0, steps.chi2_per_residual());
    const double promised = steps.promised();
    if ((roughly || fresh) && promised < near) {
      converged = true;
      break;
    }
    FitSteps::Step step = steps.tried(damping);
    if (std::isfinite(step.chi2) && step.gain > 0.0) {
      // What is learned serves as long as what it promises comes true.
      const bool serves = step.gain > std::max(near, 0.1 * promised);
      const bool as_foretold = step.gain > kAsGood * step.foretold;
      if (fresh) {
        crawling = step.gain < kCrawl * promised ? crawling + 1 : 0;
      }
      // Derivatives that twice promise what no step keeps are not made again for a rough fit.
      converged = (fresh && step.gain < near) || (roughly && crawling == kMostCrawling);
      if (serves) {
        steps.learn(step);
      }
      steps.take(std::move(step));
      // Where a step gains less than was foretold of it, a longer one is not worth an attempt.
      if (as_foretold) {
        damping = damping > 1e-2 ? damping / 10.0 : 0.0;
      }
      refused = 0;
      if (serves) {
        steps.go_on();
      } else if (!converged) {
        steps.derive();
      }
      fresh = !serves;
    } else if (fresh) {
      // Short steps gain less than the residuals' own roughness.
      damping = std::max(1e-2, damping * 10.0);
      converged = ++refused > kMostRefused;
    } else {
      steps.derive();
      fresh = true;
    }
  }
  return steps.done(converged);
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
          variance += sd * sd + std::pow(number.filed_share * value, 2);
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
