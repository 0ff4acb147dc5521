#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "processing/algebra/algebra.hpp"
#include "processing/identification/bar_spectrum.hpp"

namespace kolsky {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr std::size_t kFewest = 4;

/// The part of a spectrum that is fitted, in units of the largest J2.
struct Fitted {
  const BarSpectrum& spectrum;
  std::size_t used = 0;
  std::size_t peak = 0;

  Fitted(const BarSpectrum& of, double up_to_Hz) : spectrum(of) {
    for (std::size_t k = 0; k < spectrum.frequency_Hz.size(); ++k) {
      if (spectrum.frequency_Hz[k] <= up_to_Hz) {
        used = k + 1;
        peak = spectrum.J2_per_Pa.mean[k] > spectrum.J2_per_Pa.mean[peak] ? k : peak;
      }
    }
  }
  [[nodiscard]] double J2_peak() const { return spectrum.J2_per_Pa.mean[peak]; }
  /// J1(0) - J1(infinity) = 1/E2, J2 has its peak where w eta2 = E2. Logarithms.
  [[nodiscard]] Eigen::Vector3d guess() const {
    const double E2 = 0.5 / J2_peak();
    return {std::log(1.0 / spectrum.J1_per_Pa.mean[used - 1]), std::log(E2),
            std::log(E2 / (kTwoPi * spectrum.frequency_Hz[peak]))};
  }
  [[nodiscard]] Eigen::VectorXd residuals(const Eigen::Vector3d& at) const {
    const ThreeElementSolid solid(std::exp(at[0]), std::exp(at[1]), std::exp(at[2]));
    Eigen::VectorXd r(static_cast<Eigen::Index>(2 * used));
    for (std::size_t k = 0; k < used; ++k) {
      const Complex J = solid.at({0.0, kTwoPi * spectrum.frequency_Hz[k]});
      const auto i = static_cast<Eigen::Index>(2 * k);
      r[i] = (J.real() - spectrum.J1_per_Pa.mean[k]) / J2_peak();
      r[i + 1] = (-J.imag() - spectrum.J2_per_Pa.mean[k]) / J2_peak();
    }
    return r;
  }
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::Vector3d& at,
                                       const Eigen::VectorXd& here) const {
    constexpr double kStep = 1e-6;
    Eigen::MatrixXd slope(here.size(), 3);
    for (Eigen::Index m = 0; m < 3; ++m) {
      Eigen::Vector3d beside = at;
      beside[m] += kStep;
      slope.col(m) = (residuals(beside) - here) / kStep;
    }
    return slope;
  }
};

struct Minimum {
  Eigen::Vector3d at;
  Eigen::VectorXd residual;
  Eigen::MatrixXd slope;
};

/// Levenberg's and Marquardt's search.
Minimum least_squares(const Fitted& fitted) {
  constexpr int kSteps = 60;
  constexpr double kDone = 1e-9;
  Minimum best{fitted.guess(), {}, {}};
  best.residual = fitted.residuals(best.at);
  double damping = 1e-3;
  for (int step = 0; step < kSteps; ++step) {
    best.slope = fitted.slopes(best.at, best.residual);
    Eigen::MatrixXd normal = best.slope.transpose() * best.slope;
    normal.diagonal() *= 1.0 + damping;
    const Eigen::Vector3d next =
        best.at - solve_symmetric(normal, best.slope.transpose() * best.residual);
    const Eigen::VectorXd there = fitted.residuals(next);
    if (!there.allFinite() || there.squaredNorm() > best.residual.squaredNorm()) {
      damping *= 10.0;
      continue;
    }
    const bool done = (next - best.at).norm() < kDone;
    best.at = next;
    best.residual = there;
    damping *= 0.1;
    if (done) {
      break;
    }
  }
  return best;
}

}  // namespace

std::vector<FittedNumber> three_elements_through(const BarSpectrum& spectrum, double up_to_Hz) {
  const Fitted fitted(spectrum, up_to_Hz);
  if (fitted.used < kFewest || fitted.J2_peak() <= 0.0) {
    return {};
  }
  const Minimum best = least_squares(fitted);
  const auto freedom = static_cast<double>(2 * fitted.used - 3);
  const Eigen::MatrixXd covariance =
      inverse_of(best.slope.transpose() * best.slope) * best.residual.squaredNorm() / freedom;
  std::vector<FittedNumber> numbers;
  const auto& family = parameters_of(SolidKind::three_element);
  for (Eigen::Index m = 0; m < 3; ++m) {
    const double value = std::exp(best.at[m]);
    numbers.push_back({family[static_cast<std::size_t>(m)].name, value,
                       value * std::sqrt(std::max(0.0, covariance(m, m)))});
  }
  return numbers;
}

}  // namespace kolsky
