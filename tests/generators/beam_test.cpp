#include "tests/generators/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/generators/transfer_oracle.hpp"

namespace kolsky::testing {
namespace {

using Complex = std::complex<double>;

// Timoshenko's beam at s = iw + damping: two decaying waves that carry the moment and no shear
// force. phi = P e^{-k x}, w = W e^{-k x}: rho s^2 W = kG (k^2 W + k P), rho I s^2 P = E I k^2 P +
// kGA(-k W - P).
Complex bending_strain(Complex s, double x) {
  const double nu = 0.36;
  const double rho = 1180.0;
  const double a = 0.01;
  const Complex E = 1.0 / (1.0 / 5.66e9 + 1.0 / (37.0e9 + s * 1.81e6));
  const Complex G = E / (2.0 * (1.0 + nu)) * 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu);
  const double A = std::numbers::pi * a * a;
  const double I = 0.25 * A * a * a;
  // G E k^4 - rho s^2 (E + G) k^2 + rho^2 s^4 + rho s^2 G A/I = 0.
  const Complex b = rho * s * s * (E + G);
  const Complex c = rho * rho * s * s * s * s + rho * s * s * G * A / I;
  const Complex root = std::sqrt(b * b - 4.0 * G * E * c);
  Complex k[2];
  Complex W[2];
  for (int i = 0; i < 2; ++i) {
    k[i] = std::sqrt((b + (i == 0 ? root : -root)) / (2.0 * G * E));
    if (k[i].real() < 0.0) {
      k[i] = -k[i];
    }
    W[i] = G * k[i] / (rho * s * s - G * k[i] * k[i]);  // per P
  }
  // No shear at x = 0: sum P (-k W - 1) = 0; E I phi' = A (1 Pa, 1 m): sum -k P = A/(E I).
  const Complex q0 = -k[0] * W[0] - 1.0;
  const Complex q1 = -k[1] * W[1] - 1.0;
  const Complex P0 = A / (E * I) / (-k[0] + k[1] * q0 / q1);
  const Complex P1 = -P0 * q0 / q1;
  return a * (-k[0] * P0 * std::exp(-k[0] * x) - k[1] * P1 * std::exp(-k[1] * x));
}

TEST(Beam, BendsAsTimoshenkosClosedForm) {
  BeamProblem problem;
  problem.material = three_element(5.66e9, 37.0e9, 1.81e6);
  problem.stations_m = {0.1, 0.35};
  problem.window_s = 0.8e-3;
  const double knot_s = 8e-6;
  const Responses got = beam_response(problem, {knot_s});
  for (std::size_t g = 0; g < problem.stations_m.size(); ++g) {
    const double x = problem.stations_m[g];
    const auto want = from_spectrum(
        [&](Complex s) { return bending_strain(s, x) * unit_source_spectrum(s, knot_s); }, 6e-3,
        400e3, got.step_s, 1500);
    double largest = 0.0;
    double error = 0.0;
    for (std::size_t n = 0; n < want.size(); ++n) {
      largest = std::max(largest, std::abs(want[n]));
      error = std::max(error, std::abs(got.strain[g][n] - want[n]));
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_LT(error, 1e-4 * largest) << "x = " << x;
  }
}

}  // namespace
}  // namespace kolsky::testing
