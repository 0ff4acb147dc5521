#include "processing/waves/pochhammer_chree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

namespace kolsky {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Row {
  double a_over_wavelength, frequency, speed, mean_over_surface;  // f a / c0, cp / c0
};

/// The table of reference values, by Poisson's ratio.
std::map<double, std::vector<Row>> reference() {
  std::map<double, std::vector<Row>> table;
  std::ifstream file(std::filesystem::path(KOLSKY_SHARED_DATA).parent_path() /
                     "reference/pochhammer_chree.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    double nu = 0.0;
    Row row{};
    double stress = 0.0;
    char comma = 0;
    cells >> nu >> comma >> row.a_over_wavelength >> comma >> row.frequency >> comma >> row.speed >>
        comma >> row.mean_over_surface >> comma >> stress;
    table[nu].push_back(row);
  }
  return table;
}

/// Modes of an elastic bar with c0 = 1 and a = 1 at the frequencies, reached in small steps.
std::vector<BarMode> elastic_modes(double nu, const std::vector<Row>& rows) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, nu, 1.0, unit);
  constexpr int kSteps = 20;
  std::vector<Complex> path;
  double from = 0.0;
  for (const Row& row : rows) {
    // The table's frequency has five or six digits; its wavelength is exact and its speed has
    // seven.
    const double to = row.speed * row.a_over_wavelength;
    for (int step = 1; step <= kSteps; ++step) {
      path.emplace_back(0.0, kTwoPi * (from + (to - from) * step / kSteps));
    }
    from = to;
  }
  const auto all = bar.along(path);
  std::vector<BarMode> modes;
  for (std::size_t i = kSteps - 1; i < all.size(); i += kSteps) {
    modes.push_back(all[i]);
  }
  return modes;
}

TEST(PochhammerChree, PhaseVelocityToOneInAMillionOfTheTable) {
  const auto table = reference();
  if (table.empty()) {
    GTEST_SKIP() << "no reference table beside the project";
  }
  for (const auto& [nu, rows] : table) {
    const auto modes = elastic_modes(nu, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double omega = kTwoPi * rows[i].speed * rows[i].a_over_wavelength;
      EXPECT_NEAR(omega / modes[i].gamma.imag(), rows[i].speed, 1e-6)
          << "nu " << nu << " a/Lambda " << rows[i].a_over_wavelength;
      EXPECT_NEAR(modes[i].gamma.real(), 0.0, 1e-9);
    }
  }
}

TEST(PochhammerChree, MeanOverSurfaceStrainOfTheTable) {
  const auto table = reference();
  if (table.empty()) {
    GTEST_SKIP() << "no reference table beside the project";
  }
  for (const auto& [nu, rows] : table) {
    const auto modes = elastic_modes(nu, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // The ratio has a pole where the surface goes blind: compare its inverse, which has none.
      EXPECT_NEAR(1.0 / modes[i].mean_over_surface.real(), 1.0 / rows[i].mean_over_surface, 3e-5)
          << "nu " << nu << " a/Lambda " << rows[i].a_over_wavelength;
    }
  }
}

TEST(PochhammerChree, ThePathDoesNotMatter) {
  const ThreeElementSolid pmma(paper_pmma());
  const PochhammerChree bar(1180.0, 0.36, 0.010, pmma);
  std::vector<Complex> coarse;
  std::vector<Complex> fine;
  for (int step = 1; step <= 60; ++step) {
    coarse.emplace_back(4500.0, kTwoPi * 1e3 * step);
    for (int part = 9; part >= 0; --part) {
      fine.emplace_back(4500.0, kTwoPi * (1e3 * step - 100.0 * part));
    }
  }
  const auto a = bar.along(coarse);
  const auto b = bar.along(fine);
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    EXPECT_NEAR(std::abs(a[k].gamma - b[10 * k + 9].gamma), 0.0, 1e-9 * std::abs(a[k].gamma));
  }
}

TEST(PochhammerChree, APathThatStartsFarOutIsRefused) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, 0.3, 1.0, unit);
  EXPECT_THROW((void)bar.along({{0.0, 2.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace kolsky
