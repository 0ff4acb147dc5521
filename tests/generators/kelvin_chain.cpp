#include "tests/generators/kelvin_chain.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky::testing {

namespace {

// Retardation spectrum of the Cole-Cole branch, in time over (0, 1): z = t/(t + tau).
struct Spectrum {
  Eigen::ArrayXd z, weight;
};

Spectrum cole_cole_spectrum(double beta) {
  // The trapezoid rule converges exponentially here; poles lie pi (1 - beta)/beta off the axis.
  const double spacing = std::min(0.01, 0.1 * std::numbers::pi * (1.0 - beta) / beta);
  const double reach = 45.0 / beta;
  const auto half = static_cast<Eigen::Index>(reach / spacing);
  Spectrum spectrum{Eigen::ArrayXd(2 * half + 1), Eigen::ArrayXd(2 * half + 1)};
  for (Eigen::Index i = -half; i <= half; ++i) {
    const double u = static_cast<double>(i) * spacing;
    spectrum.z[i + half] = 1.0 / (1.0 + std::exp(-u));
    spectrum.weight[i + half] = 1.0 / (std::cosh(beta * u) + std::cos(beta * std::numbers::pi));
  }
  spectrum.weight /= spectrum.weight.sum();
  return spectrum;
}

// Gauss rule of a discrete measure: Stieltjes' recurrence, then Golub and Welsch.
Spectrum gauss(const Spectrum& fine, int points) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(points, points);
  Eigen::ArrayXd before = Eigen::ArrayXd::Zero(fine.z.size());
  Eigen::ArrayXd now = Eigen::ArrayXd::Ones(fine.z.size());
  double off = 0.0;
  for (int n = 0; n < points; ++n) {
    jacobi(n, n) = (fine.weight * fine.z * now * now).sum();
    Eigen::ArrayXd next = (fine.z - jacobi(n, n)) * now - off * before;
    off = std::sqrt((fine.weight * next * next).sum());
    if (n + 1 < points) {
      jacobi(n, n + 1) = jacobi(n + 1, n) = off;
    }
    before = now;
    now = next / off;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  return {solver.eigenvalues().array(), solver.eigenvectors().row(0).array().square().transpose()};
}

}  // namespace

void KelvinChain::add_relaxation(double compliance_per_Pa, double time_s) {
  if (compliance_per_Pa > 0.0) {
    elements.push_back({1.0 / compliance_per_Pa, time_s / compliance_per_Pa});
  }
}

void KelvinChain::add_flow(double fluidity_per_Pa_s) {
  if (fluidity_per_Pa_s > 0.0) {
    elements.push_back({0.0, 1.0 / fluidity_per_Pa_s});
  }
}

KelvinChain KelvinChain::scaled(double factor) const {
  KelvinChain chain{glassy_Pa * factor, elements};
  for (KelvinElement& element : chain.elements) {
    element.stiffness_Pa *= factor;
    element.viscosity_Pa_s *= factor;
  }
  return chain;
}

KelvinChain elastic(double E_Pa) {
  return {E_Pa, {}};
}

KelvinChain three_element(double E1_Pa, double E2_Pa, double eta2_Pa_s) {
  return {E1_Pa, {{E2_Pa, eta2_Pa_s}}};
}

KelvinChain fractional_three_element(double E1_Pa, double E2_Pa, double eta2_Pa_s, double beta,
                                     int points) {
  if (beta > 1.0 - 1e-9) {
    return three_element(E1_Pa, E2_Pa, eta2_Pa_s);
  }
  const double tau_s = eta2_Pa_s / E2_Pa;
  const Spectrum rule = gauss(cole_cole_spectrum(beta), points);
  KelvinChain chain{E1_Pa, {}};
  double fast_per_Pa = 0.0;
  for (Eigen::Index i = 0; i < rule.z.size(); ++i) {
    const double time_s = tau_s * rule.z[i] / (1.0 - rule.z[i]);
    const double compliance_per_Pa = rule.weight[i] / E2_Pa;
    // Times far below any sample have no dynamics left: they belong to the glassy spring.
    if (time_s < 1e-8) {
      fast_per_Pa += compliance_per_Pa;
    } else {
      chain.add_relaxation(compliance_per_Pa, time_s);
    }
  }
  chain.glassy_Pa = 1.0 / (1.0 / E1_Pa + fast_per_Pa);
  return chain;
}

KelvinStep::KelvinStep(const KelvinChain& chain, double step_s)
    : glassy_Pa_(chain.glassy_Pa), step_s_(step_s) {
  for (const KelvinElement& element : chain.elements) {
    const double eta = element.viscosity_Pa_s;
    const double E = element.stiffness_Pa;
    if (E == 0.0) {
      elements_.push_back({1.0, 0.5 * step_s / eta, 0.5 * step_s / eta, 0.0});
      rate_per_stress_ += 1.0 / eta;
      continue;
    }
    const double x = step_s * E / eta;
    const double keep = std::exp(-x);
    const double mean = -std::expm1(-x) / x;
    elements_.push_back({keep, (mean - keep) / E, (1.0 - mean) / E, E / eta});
    rate_per_stress_ += mean / eta;
  }
}

}  // namespace kolsky::testing
