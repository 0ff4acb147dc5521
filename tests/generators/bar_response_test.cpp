#include "tests/generators/bar_response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "tests/generators/transfer_oracle.hpp"

namespace kolsky::testing {
namespace {

using Complex = std::complex<double>;

constexpr double kDensity = 1180.0;
constexpr double kE1 = 5.66e9;
constexpr double kE2 = 37.0e9;
constexpr double kEta2 = 1.81e6;
// 0.3 sigma of 4 microstrain on a pulse of 3000 microstrain.
constexpr double kAllowed = 0.3 * 4.0 / 3000.0;

Complex three_element_J(Complex s) {
  return 1.0 / kE1 + 1.0 / (kE2 + s * kEta2);
}

// A trapezoid of 120 us with 20 us edges, in bells.
std::vector<double> pulse(double knot_s) {
  std::vector<double> c;
  for (double t = 0.0; t < 120e-6; t += knot_s) {
    const double edge = std::min({t, 120e-6 - t, 20e-6}) / 20e-6;
    c.push_back(0.5 - 0.5 * std::cos(3.14159265358979 * edge));
  }
  return c;
}

struct Compared {
  double largest;  ///< of the truth
  double error;    ///< largest difference over that
};

// The generator against strain = J e^{-gx} (+ R J e^{-g(2L - x)} and all later returns).
template <typename J>
Compared compare(const BarProblem& problem, const J& J_of, const BarNumerics& numerics = {}) {
  const UnitSource source;
  const Responses responses = bar_response(problem, source, numerics);
  const std::vector<double> c = pulse(source.knot_s);
  const std::size_t samples = 1500;
  Compared worst{0.0, 0.0};
  for (std::size_t g = 0; g < problem.stations_m.size(); ++g) {
    const double x = problem.stations_m[g];
    const auto got = superpose(responses.strain[g], responses.step_s, c, 4, 1e-6, 0.0, samples);
    const auto want = from_spectrum(
        [&](Complex s) {
          Complex drive = 0.0;
          for (std::size_t k = c.size(); k-- > 0;) {
            drive = drive * std::exp(-s * source.knot_s) + c[k];
          }
          drive *= unit_source_spectrum(s, source.knot_s);
          const Complex J_s = J_of(s);
          const Complex gamma = s * std::sqrt(kDensity * J_s);
          if (!problem.far_end) {
            return drive * J_s * std::exp(-gamma * x);
          }
          const double L = problem.far_end->bar_length_m;
          const double R = problem.far_end->r - 1.0;
          return drive * J_s * (std::exp(-gamma * x) + R * std::exp(-gamma * (2.0 * L - x))) /
                 (1.0 + R * std::exp(-2.0 * gamma * L));
        },
        8e-3, 400e3, 1e-6, samples);
    for (std::size_t n = 0; n < samples; ++n) {
      worst.largest = std::max(worst.largest, std::abs(want[n]));
      worst.error = std::max(worst.error, std::abs(got[n] - want[n]));
    }
  }
  worst.error /= worst.largest;
  return worst;
}

BarProblem pmma() {
  return {.material = three_element(kE1, kE2, kEta2),
          .density_kg_m3 = kDensity,
          .stations_m = {0.1, 0.3, 0.5, 0.7, 1.3},
          .far_end = {},
          .relative_area = {},
          .window_s = 1.6e-3};
}

TEST(BarResponse, IsTheClosedFormOfTheThreeElementBar) {
  const Compared result = compare(pmma(), three_element_J);
  // Between the glassy and the relaxed compliance.
  EXPECT_GT(result.largest * kE1, 1.0);
  EXPECT_LT(result.largest * kE1, 1.0 + kE1 / kE2);
  EXPECT_LT(result.error, 0.01 * kAllowed);
}

TEST(BarResponse, ErrorFallsWithTheStep) {
  const double coarse = compare(pmma(), three_element_J, {1e-6, 0.5e-6, false}).error;
  const double fine = compare(pmma(), three_element_J, {0.5e-6, 0.5e-6, false}).error;
  EXPECT_GT(coarse / fine, 3.5);
}

TEST(BarResponse, EndReturnsTheSameShareAtEveryFrequency) {
  for (const double r : {0.0, 0.3, 1.0, 1.6, 2.0}) {
    BarProblem problem = pmma();
    problem.stations_m = {0.1, 0.45};
    problem.far_end = FarEndReturn{0.8, r};
    const Compared result = compare(problem, three_element_J);
    EXPECT_LT(result.error, 0.02 * kAllowed) << "r = " << r;
  }
}

TEST(BarResponse, HoldsSecondRelaxationAndFlow) {
  BarProblem problem = pmma();
  problem.material.add_relaxation(4e-12, 250e-6);
  problem.material.add_flow(2e-9);
  const auto J = [](Complex s) {
    return three_element_J(s) + 4e-12 / (1.0 + s * 250e-6) + 2e-9 / s;
  };
  const Compared result = compare(problem, J);
  EXPECT_LT(result.error, 0.01 * kAllowed);
  EXPECT_GT(compare(problem, three_element_J).error, kAllowed);
}

TEST(BarResponse, FractionalBranchIsASumOfKelvinElements) {
  for (const double beta : {0.8, 0.9, 0.99}) {
    BarProblem problem = pmma();
    problem.material = fractional_three_element(kE1, kE2, kEta2, beta);
    const auto J = [beta](Complex s) {
      return 1.0 / kE1 + 1.0 / (kE2 * (1.0 + std::pow(s * kEta2 / kE2, beta)));
    };
    const Compared result = compare(problem, J);
    EXPECT_LT(result.error, 0.05 * kAllowed) << "beta = " << beta;
  }
}

}  // namespace
}  // namespace kolsky::testing
