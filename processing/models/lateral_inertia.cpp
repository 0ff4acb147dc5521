#include "processing/models/lateral_inertia.hpp"

#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

/// Beyond this the section holds several wavelengths, and series lose what is left of them.
constexpr double kMostOfSeries = 400.0;

/// J0, K and j - kappa (see `lateral_stress_Pa`) by their series in X.
struct SectionSeries {
  Complex J0 = 1.0;
  Complex K = 1.0;
  Complex apart = 0.0;

  explicit SectionSeries(Complex X) {
    constexpr double kLast = 1e-17;
    Complex over_X = -0.25;  // a term of J0, over X
    for (double n = 1.0; std::abs(over_X) * std::max(1.0, std::abs(X)) > kLast; n += 1.0) {
      J0 += over_X * X;
      K += over_X * X / (n + 1.0);
      apart -= over_X * n / (n + 1.0);
      over_X *= -0.25 * X / ((n + 1.0) * (n + 1.0));
    }
  }
};

/// Of many wavelengths, by Hankel's expansions of J1 and J0.
Complex of_short_waves(Complex X, double nu, double m) {
  const Complex z = std::sqrt(X);
  const Complex t = std::tan(z - std::numbers::pi / 4.0);
  const Complex J1_over_J0 = ((1.0 + 15.0 / (128.0 * X)) * t + 3.0 / (8.0 * z)) /
                             (1.0 - 9.0 / (128.0 * X) + t / (8.0 * z));
  const Complex K = 2.0 * J1_over_J0 / z;  // over J0
  return 4.0 * (K - 1.0) / (X * (1.0 - nu) * (1.0 - m * K));
}

}  // namespace

Complex lateral_stress_Pa(const SpecimenScene& specimen, Complex J_per_Pa, Complex s) {
  const Complex first = specimen.lateral_inertia_kg_per_m * s * s / 8.0;
  const double nu = specimen.poisson_ratio;
  if (!specimen.crossed_sideways || nu == 0.0) {
    return first;
  }
  const double m = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
  const double rho_aa = specimen.lateral_inertia_kg_per_m / (4.0 * nu * nu);
  const Complex X = -rho_aa * s * s * J_per_Pa * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu);
  if (std::abs(X) > kMostOfSeries) {
    return first * of_short_waves(X, nu, m);
  }
  const SectionSeries section(X);
  return first * 4.0 * section.apart / ((1.0 - nu) * (section.J0 - m * section.K));
}

}  // namespace kolsky
