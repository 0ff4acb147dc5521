#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/criticism/waterfall/waterfall.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

constexpr double kLoading_s = 100e-6;
constexpr std::size_t kLoaded = 1024;  ///< steps of the loading
/// Until then it goes on, and as slowly back, for a strain that ended at once would ring in all of
/// it; then the specimen rests.
constexpr std::size_t kTurns = kLoaded + kLoaded / 4;
constexpr std::size_t kSamples = 8 * kLoaded;
constexpr std::size_t kShownSteps = 64;  ///< of these, equal ones
constexpr std::size_t kShown = kShownSteps + 1;
static_assert(kLoaded % kShownSteps == 0);
constexpr int kRounds = 30;
constexpr double kSettled = 1e-9;

/// The strain that a stiffening spring falls short of a linear one, by sample.
std::vector<double> shortfall(const SpecimenScene& specimen, const std::vector<double>& stress,
                              const std::vector<double>& strain) {
  std::vector<double> q(stress.size());
  for (std::size_t n = 0; n < q.size(); ++n) {
    q[n] = stress[n] / specimen.solid.E1_Pa * (1.0 / (1.0 + specimen.stiffening * strain[n]) - 1.0);
  }
  return q;
}

class RampTest {
 public:
  explicit RampTest(double strain_rate_per_s)
      : transform_(kSamples, kLoading_s / static_cast<double>(kLoaded)),
        path_(transform_.bins()),
        ratio_(transform_.bins()),
        strain_(kSamples) {
    for (std::size_t k = 0; k < path_.size(); ++k) {
      path_[k] = transform_.s(k);
    }
    for (std::size_t n = 0; n < 2 * kTurns; ++n) {
      strain_[n] = strain_rate_per_s * kLoading_s *
                   static_cast<double>(std::min(n, 2 * kTurns - n)) / static_cast<double>(kLoaded);
    }
  }

  [[nodiscard]] const std::vector<double>& strain() const { return strain_; }

  std::vector<double> stress(const Studied& studied, const Campaign& campaign,
                             const std::vector<double>& theta) {
    Scene scene(campaign.bench, campaign.shots.front().facts, path_);
    shape(studied.composition.applied(theta, 0), scene);
    const SpecimenScene& specimen = *scene.specimen;
    for (std::size_t k = 0; k < path_.size(); ++k) {
      ratio_[k] = soften(k) / specimen.solid.compliance(path_[k], k);
    }
    std::vector<double> stress = answer(strain_);
    for (int round = 0; specimen.stiffening != 0.0 && round < kRounds; ++round) {
      std::vector<double> linear = strain_;
      const std::vector<double> q = shortfall(specimen, stress, strain_);
      for (std::size_t n = 0; n < linear.size(); ++n) {
        linear[n] -= q[n];
      }
      std::vector<double> next = answer(linear);
      double moved = 0.0;
      for (std::size_t n = 0; n <= kLoaded; ++n) {
        moved = std::max(moved, std::abs(next[n] - stress[n]));
      }
      stress = std::move(next);
      if (moved < kSettled * std::abs(stress[kLoaded])) {
        break;
      }
    }
    return stress;
  }

 private:
  /// Lanczos' factor: a dashpot's stress steps where the loading begins, and would ring there.
  [[nodiscard]] double soften(std::size_t k) const {
    const double x =
        std::numbers::pi * static_cast<double>(k) / static_cast<double>(transform_.bins());
    return k == 0 ? 1.0 : std::sin(x) / x;
  }

  std::vector<double> answer(const std::vector<double>& strain) {
    std::vector<Complex> spectrum(transform_.bins());
    transform_.forward(strain, spectrum);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      spectrum[k] *= ratio_[k];
    }
    std::vector<double> stress(strain.size());
    transform_.inverse(spectrum, stress);
    return stress;
  }

  DampedTransform transform_;
  std::vector<Complex> path_;
  std::vector<Complex> ratio_;
  std::vector<double> strain_;
};

}  // namespace

SpecimenCurve specimen_curve(const Studied& studied, const Campaign& campaign,
                             double strain_rate_per_s) {
  SpecimenCurve curve;
  if (!campaign.bench.specimen) {
    return curve;
  }
  RampTest test(strain_rate_per_s);
  const std::vector<double>& theta = studied.fit.theta;
  const std::vector<double> best = test.stress(studied, campaign, theta);
  const bool known = studied.fit.covariance.size() > 0;
  // How the curve answers to each fitted number, a tenth of its deviation to either side.
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(kShown),
                         static_cast<Eigen::Index>(theta.size()));
  const auto shown = [](std::size_t i) { return i * (kLoaded / kShownSteps); };
  for (std::size_t p = 0; known && p < theta.size(); ++p) {
    const auto at = static_cast<Eigen::Index>(p);
    const double step = 0.1 * std::sqrt(std::max(0.0, studied.fit.covariance(at, at)));
    slopes.col(at).setZero();
    if (step == 0.0) {
      continue;
    }
    std::vector<double> moved = theta;
    moved[p] = theta[p] + step;
    const std::vector<double> up = test.stress(studied, campaign, moved);
    moved[p] = theta[p] - step;
    const std::vector<double> down = test.stress(studied, campaign, moved);
    for (std::size_t i = 0; i < kShown; ++i) {
      slopes(static_cast<Eigen::Index>(i), at) = (up[shown(i)] - down[shown(i)]) / (2.0 * step);
    }
  }
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kShown));
  if (known) {
    variance = (slopes * studied.fit.covariance).cwiseProduct(slopes).rowwise().sum();
  }
  for (std::size_t i = 0; i < kShown; ++i) {
    curve.strain.push_back(test.strain()[shown(i)]);
    curve.stress_Pa.push_back(best[shown(i)]);
    curve.sd_Pa.push_back(widening(studied.misfit) *
                          std::sqrt(std::max(0.0, variance[static_cast<Eigen::Index>(i)])));
  }
  return curve;
}

}  // namespace kolsky
