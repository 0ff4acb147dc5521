#include "tests/generators/bar2d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <sstream>

namespace kolsky::testing {
namespace {

using Complex = std::complex<double>;

// Long enough to leave the second mode alone, whose slow waves would be cut by the window.
constexpr double kKnot_s = 10e-6;

// Line of a history's spectrum.
Complex line(const std::vector<double>& history, double step_s, double frequency_Hz) {
  Complex sum = 0.0;
  for (std::size_t n = 0; n < history.size(); ++n) {
    sum += history[n] *
           std::exp(Complex(0.0, -2.0 * std::numbers::pi * frequency_Hz * step_s * double(n)));
  }
  return sum;
}

// alpha + ik between two stations, the phase taken from the branch nearest to that of speed c.
Complex propagation(const Responses& responses, double frequency_Hz, double distance_m, double c) {
  const Complex ratio = line(responses.strain[1], responses.step_s, frequency_Hz) /
                        line(responses.strain[0], responses.step_s, frequency_Hz);
  const double expected = 2.0 * std::numbers::pi * frequency_Hz * distance_m / c;
  const double turns = std::round((expected + std::arg(ratio)) / (2.0 * std::numbers::pi));
  const double phase = turns * 2.0 * std::numbers::pi - std::arg(ratio);
  return {-std::log(std::abs(ratio)) / distance_m, phase / distance_m};
}

struct Row {
  double nu, fa_over_c0, cp_over_c0;
};

std::vector<Row> published() {
  std::ifstream file(KOLSKY_SHARED_DATA "/../reference/pochhammer_chree.csv");
  std::vector<Row> rows;
  std::string text;
  std::getline(file, text);
  while (std::getline(file, text)) {
    std::ranges::replace(text, ',', ' ');
    std::istringstream cells(text);
    double ignored = 0.0;
    Row row{};
    cells >> row.nu >> ignored >> row.fa_over_c0 >> row.cp_over_c0;
    rows.push_back(row);
  }
  return rows;
}

TEST(SolidBar, TravelsAsPochhammerAndChreeSay) {
  const std::vector<Row> rows = published();
  if (rows.empty()) {
    GTEST_SKIP() << "no table of Pochhammer and Chree beside the project";
  }
  SolidBarProblem problem;
  problem.material = elastic(5e9);
  problem.poisson_ratio = 0.35;
  problem.stations_m = {0.3, 0.7};
  problem.window_s = 1.4e-3;
  const double c0 = std::sqrt(5e9 / problem.density_kg_m3);
  const Responses responses = solid_bar_response(problem, {kKnot_s});
  int compared = 0;
  for (const Row& row : rows) {
    const double f = row.fa_over_c0 * c0 / problem.radius_m;
    if (std::abs(row.nu - 0.35) > 1e-9 || f < 4e3 || f > 42e3) {
      continue;
    }
    const double k = propagation(responses, f, 0.4, c0 * row.cp_over_c0).imag();
    const double cp = 2.0 * std::numbers::pi * f / k;
    EXPECT_NEAR(cp / c0, row.cp_over_c0, 1e-4) << f << " Hz";
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

// PMMA, a = 10 mm: attenuation and speed of the exact first mode, from the project's reference.
TEST(SolidBar, AttenuatesAsTheExactViscoelasticMode) {
  SolidBarProblem problem;
  problem.material = three_element(5.66e9, 37.0e9, 1.81e6);
  problem.stations_m = {0.3, 0.7};
  problem.window_s = 2e-3;
  const Responses responses = solid_bar_response(problem, {kKnot_s});
  struct Exact {
    double f, alpha, c;
  };
  for (const Exact exact : {Exact{10e3, 0.64610, 2167.76}, Exact{20e3, 0.71924, 2160.79},
                            Exact{40e3, 0.86723, 2066.61}}) {
    const Complex gamma = propagation(responses, exact.f, 0.4, exact.c);
    EXPECT_NEAR(gamma.real(), exact.alpha, 1e-4 * exact.alpha + 1e-5);
    EXPECT_NEAR(2.0 * std::numbers::pi * exact.f / gamma.imag(), exact.c, 1e-5 * exact.c);
  }
}

}  // namespace
}  // namespace kolsky::testing
