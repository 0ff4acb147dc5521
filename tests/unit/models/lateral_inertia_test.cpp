#include "processing/models/lateral_inertia.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace kolsky {
namespace {

constexpr double kRadius_m = 5.5e-3;
constexpr double kDensity_kg_m3 = 1150.0;

SpecimenScene crossed(double nu) {
  SpecimenScene specimen;
  specimen.diameter_m = 2.0 * kRadius_m;
  specimen.density_kg_m3 = kDensity_kg_m3;
  specimen.poisson_ratio = nu;
  specimen.lateral_inertia_kg_per_m = 4.0 * nu * nu * kDensity_kg_m3 * kRadius_m * kRadius_m;
  specimen.crossed_sideways = true;
  return specimen;
}

/// Mean axial stress of a cylinder that is strained by 1 along its axis, from linear elements of
/// its radius which know of no Bessel function.
Complex stress_of_elements(double nu, Complex J_per_Pa, Complex s, Eigen::Index elements) {
  const Complex mu = 0.5 / (J_per_Pa * (1.0 + nu));
  const Complex lambda = 2.0 * nu / (1.0 - 2.0 * nu) * mu;
  const Complex P = lambda + 2.0 * mu;
  const double h = kRadius_m / static_cast<double>(elements);
  Eigen::MatrixXcd K = Eigen::MatrixXcd::Zero(elements + 1, elements + 1);
  Eigen::VectorXcd load = Eigen::VectorXcd::Zero(elements + 1);  // by the strain along the axis
  for (Eigen::Index e = 0; e < elements; ++e) {
    for (const double gauss : {-1.0, 1.0}) {
      const double at = 0.5 + 0.5 * gauss / std::numbers::sqrt3;
      const double r = (static_cast<double>(e) + at) * h;
      const double weight = std::numbers::pi * r * h;
      const Eigen::Vector2d N(1.0 - at, at);
      const Eigen::Vector2d out(-1.0 / h, 1.0 / h);
      const Eigen::Vector2d around = N / r;
      K.block<2, 2>(e, e) +=
          weight * (P * (out * out.transpose() + around * around.transpose()) +
                    lambda * (out * around.transpose() + around * out.transpose()) +
                    kDensity_kg_m3 * s * s * (N * N.transpose()));
      load.segment<2>(e) += weight * lambda * (out + around);
    }
  }
  K.row(0).setZero();  // the axis stays where it is
  K.col(0).setZero();
  K(0, 0) = 1.0;
  const Eigen::VectorXcd axis_fixed =
      (Eigen::VectorXcd(load) << 0.0, load.tail(elements)).finished();
  const Eigen::VectorXcd u = K.partialPivLu().solve(-axis_fixed);
  return P + load.cwiseProduct(u).sum() / (std::numbers::pi * kRadius_m * kRadius_m);
}

/// A soft core's, of the paper's Table 4.
Complex J_of_core(Complex s) {
  return 1.0 / 121e6 + 1.0 / (143e6 + 2860.0 * s);
}

Complex lateral_of_elements(double nu, Complex J_per_Pa, Complex s, Eigen::Index elements) {
  return stress_of_elements(nu, J_per_Pa, s, elements) - 1.0 / J_per_Pa;
}

TEST(LateralInertia, OfWavesAcrossTheSectionIsThatOfElements) {
  for (const double nu : {0.3, 0.45, 0.49}) {
    for (const double frequency_Hz : {2e3, 10e3, 25e3, 60e3}) {
      const Complex s(2000.0, 2.0 * std::numbers::pi * frequency_Hz);
      const Complex elements = lateral_of_elements(nu, J_of_core(s), s, 300);
      EXPECT_LT(std::abs(lateral_stress_Pa(crossed(nu), J_of_core(s), s) - elements),
                1e-3 * std::abs(elements))
          << nu << ", " << frequency_Hz << " Hz";
    }
  }
}

// Many wavelengths, where its series would lose all digits.
TEST(LateralInertia, OfShortWavesIsThatOfElements) {
  const double nu = 0.3;
  for (const double frequency_Hz : {2.4e5, 3e5}) {
    const Complex s(2000.0, 2.0 * std::numbers::pi * frequency_Hz);
    const Complex J = J_of_core(s);
    const double of_longitudinal = (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu);
    ASSERT_GT(std::abs(kDensity_kg_m3 * kRadius_m * kRadius_m * s * s * J) * of_longitudinal,
              400.0);
    const Complex elements = lateral_of_elements(nu, J, s, 600);
    EXPECT_LT(std::abs(lateral_stress_Pa(crossed(nu), J, s) - elements), 1e-3 * std::abs(elements))
        << frequency_Hz << " Hz";
  }
}

TEST(LateralInertia, OfLongWavesIsItsFirstTerm) {
  SpecimenScene first = crossed(0.45);
  first.crossed_sideways = false;
  for (const double frequency_Hz : {100.0, 1000.0}) {
    const Complex s(100.0, 2.0 * std::numbers::pi * frequency_Hz);
    const Complex J = J_of_core(s);
    const double in_wavelengths = std::abs(kDensity_kg_m3 * kRadius_m * kRadius_m * s * s * J);
    const Complex term = lateral_stress_Pa(first, J, s);
    EXPECT_LT(std::abs(lateral_stress_Pa(crossed(0.45), J, s) - term),
              in_wavelengths * std::abs(term));
    EXPECT_NE(lateral_stress_Pa(crossed(0.45), J, s), term);
  }
}

TEST(LateralInertia, OfWhatDoesNotWidenIsNone) {
  const Complex s(100.0, 1e5);
  EXPECT_EQ(lateral_stress_Pa(crossed(0.0), J_of_core(s), s), 0.0);
}

}  // namespace
}  // namespace kolsky
