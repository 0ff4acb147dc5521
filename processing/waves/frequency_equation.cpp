#include "processing/waves/frequency_equation.hpp"

#include <array>
#include <limits>

namespace kolsky {

namespace {

constexpr std::size_t kMostTerms = 120;

struct Reciprocals {
  std::array<double, kMostTerms + 2> of{};
  constexpr Reciprocals() {
    for (std::size_t k = 1; k < of.size(); ++k) {
      of[k] = 1.0 / static_cast<double>(k);
    }
  }
};
constexpr Reciprocals kOneOver;

/// J0(sqrt X), K = 2 J1(sqrt X) / sqrt X and their derivatives by X, from one series.
struct Bessel {
  Complex J = 1.0;
  Complex K = 0.0;
  Complex dJ;
  Complex dK = 0.0;

  explicit Bessel(Complex X) {
    const Complex x = -0.25 * X;
    Complex term = 1.0;  // x^(k-1) / ((k-1)! k!)
    Complex sum = 0.0;   // of J0, over x
    for (std::size_t k = 1; k < kMostTerms; ++k) {
      K += term;
      sum += term * kOneOver.of[k];
      dK += term * kOneOver.of[k + 1];
      if (std::norm(term) < 1e-35 * (1.0 + std::norm(K))) {
        break;
      }
      term *= x * (kOneOver.of[k] * kOneOver.of[k + 1]);
    }
    J += x * sum;
    dJ = -0.25 * K;
    dK *= -0.25;
  }
};

}  // namespace

FrequencyEquation::FrequencyEquation(double n)
    : cp_((1.0 + n) * (1.0 - 2.0 * n) / (1.0 - n)), cq_(2.0 * (1.0 + n)) {}

FrequencyEquation::Value FrequencyEquation::evaluate(Complex z, Complex r) const {
  const Complex u = r - cp_;
  const Complex v = r - cq_;
  const Complex w = 2.0 * r - cq_;
  const Bessel p(z * u);
  const Bessel q(z * v);
  const Complex pq = p.K * q.K;
  const Complex dpq = u * p.dK * q.K + v * p.K * q.dK;  // by z
  const Complex JK = p.J * q.K;
  const Complex dJK = u * p.dJ * q.K + v * p.J * q.dK;
  const Complex KJ = p.K * q.J;
  const Complex dKJ = u * p.dK * q.J + v * p.K * q.dJ;
  Value value;
  value.F = -cq_ * u * pq - w * w * JK + 4.0 * r * u * KJ;
  value.by_z = -cq_ * u * dpq - w * w * dJK + 4.0 * r * u * dKJ;
  // By r, both arguments move alike: their factors z.
  const Complex epq = p.dK * q.K + p.K * q.dK;
  const Complex eJK = p.dJ * q.K + p.J * q.dK;
  const Complex eKJ = p.dK * q.J + p.K * q.dJ;
  value.by_ratio = -cq_ * pq - 4.0 * w * JK + 4.0 * (u + r) * KJ +
                   z * (-cq_ * u * epq - w * w * eJK + 4.0 * r * u * eKJ);
  return value;
}

FrequencyEquation::Root FrequencyEquation::solve(Complex z, Complex guess) const {
  constexpr int kMostSteps = 20;
  Complex ratio = guess;
  Complex slope = 0.0;
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    const Value value = evaluate(z, ratio);
    const Complex change = value.F / value.by_ratio;
    ratio -= change;
    slope = -value.by_z / value.by_ratio;
    // Convergence is quadratic: after a small step the next one would be its square. It ends in
    // rounding noise, where steps no longer shrink.
    const double size = std::abs(change);
    if (size < 1e-8 || (size < 1e-6 && size >= before)) {
      break;
    }
    before = size;
  }
  return {ratio, slope};
}

Complex FrequencyEquation::mean_over_surface(Complex z, Complex r) const {
  const Bessel p(z * (r - cp_));
  const Bessel q(z * (r - cq_));
  const Complex shear = -2.0 * (r - cp_) * p.K / ((2.0 * r - cq_) * q.K);
  return (p.K + shear * q.K) / (p.J + shear * q.J);
}

}  // namespace kolsky
