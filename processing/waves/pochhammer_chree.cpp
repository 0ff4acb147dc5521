#include "processing/waves/pochhammer_chree.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace kolsky {

namespace {

constexpr double kThin = 0.5;
constexpr double kFarthest = 12.0;

/// J0(z) and 2 J1(z) / z as functions of z^2, in which they are entire.
struct Bessel {
  Complex J0 = 1.0;
  Complex J1 = 1.0;  // 2 J1(z) / z

  explicit Bessel(Complex z_squared) {
    const Complex x = -z_squared / 4.0;
    Complex term = 1.0;
    for (int k = 1; k < 200; ++k) {
      term *= x / static_cast<double>(k * k);
      J0 += term;
      J1 += term / static_cast<double>(k + 1);
      if (std::norm(term) < 1e-34 * std::norm(J0) && std::norm(term) < 1e-34 * std::norm(J1)) {
        break;
      }
    }
  }
};

}  // namespace

struct PochhammerChree::Squares {
  Complex P, Q, X;
};

PochhammerChree::PochhammerChree(double density_kg_m3, double poisson_ratio, double radius_m,
                                 const Compliance& compliance)
    : density_kg_m3_(density_kg_m3),
      poisson_ratio_(poisson_ratio),
      radius_m_(radius_m),
      compliance_(&compliance) {}

PochhammerChree::Squares PochhammerChree::squares(Complex s, Complex gamma_squared) const {
  const double n = poisson_ratio_;
  const Complex inertia = -density_kg_m3_ * s * s * compliance_->at(s);  // rho w^2 J
  const double a2 = radius_m_ * radius_m_;
  // mu J = 1 / 2(1+n), (lambda + 2 mu) J = (1-n) / (1+n)(1-2n)
  const Complex along_p = inertia * (1.0 + n) * (1.0 - 2.0 * n) / (1.0 - n);
  const Complex along_q = inertia * 2.0 * (1.0 + n);
  return {a2 * (along_p + gamma_squared), a2 * (along_q + gamma_squared), -a2 * gamma_squared};
}

/// The frequency equation over (gamma0 a)^4, of ratio = (gamma / gamma0)^2.
Complex PochhammerChree::residual(Complex s, Complex elementary_squared, Complex ratio) const {
  const auto [P, Q, X] = squares(s, elementary_squared * ratio);
  const Bessel p(P);
  const Bessel q(Q);
  const Complex scale = elementary_squared * radius_m_ * radius_m_;
  return (P * (Q + X) * p.J1 * q.J1 - (Q - X) * (Q - X) * p.J0 * q.J1 - 4.0 * X * P * p.J1 * q.J0) /
         (scale * scale);
}

/// Newton's method with a central difference: the residual is analytic in the ratio.
Complex PochhammerChree::solve(Complex s, Complex elementary_squared, Complex guess) const {
  constexpr double kStep = 1e-5;
  Complex ratio = guess;
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Complex slope = (residual(s, elementary_squared, ratio + kStep) -
                           residual(s, elementary_squared, ratio - kStep)) /
                          (2.0 * kStep);
    const Complex change = residual(s, elementary_squared, ratio) / slope;
    ratio -= change;
    const double size = std::abs(change);
    // Quadratic convergence ends in rounding noise: stop when a step no longer shrinks.
    if (size < 1e-14 || (size < 1e-9 && size >= before)) {
      break;
    }
    before = size;
  }
  return ratio;
}

std::vector<BarMode> PochhammerChree::along(const std::vector<Complex>& path) const {
  std::vector<BarMode> modes;
  modes.reserve(path.size());
  Complex last = 1.0;
  Complex before_last = 1.0;
  Complex last_mean = 1.0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Complex s = path[k];
    const Complex elementary = s * std::sqrt(density_kg_m3_ * compliance_->at(s));
    const double reach = std::abs(elementary) * radius_m_;
    if (k == 0) {
      if (reach > kThin) {
        throw std::invalid_argument("the path of s must start where the bar is thin");
      }
      // Rayleigh: (gamma / gamma0)^2 = 1 - nu^2 (gamma0 a)^2 / 2 to first order.
      const double n = poisson_ratio_;
      last = 1.0 - n * n * elementary * elementary * radius_m_ * radius_m_ / 2.0;
      before_last = last;
    }
    if (reach <= kFarthest && s != 0.0) {
      const Complex squared = elementary * elementary;
      const Complex ratio = solve(s, squared, 2.0 * last - before_last);
      before_last = k == 0 ? ratio : last;
      last = ratio;
      const auto [P, Q, X] = squares(s, squared * ratio);
      const Bessel p(P);
      const Bessel q(Q);
      const Complex shear = 2.0 * P * p.J1 / ((X - Q) * q.J1);
      last_mean = (p.J1 + shear * q.J1) / (p.J0 + shear * q.J0);
    }
    modes.push_back({elementary * std::sqrt(last), last_mean});
  }
  return modes;
}

}  // namespace kolsky
