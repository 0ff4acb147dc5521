#include "processing/waves/pochhammer_chree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "processing/base/error.hpp"
#include "tests/unit/waves/pochhammer_table.hpp"

namespace kolsky {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

TEST(PochhammerChree, PhaseVelocityToOneInAMillionOfTheTable) {
  const auto table = testing::pochhammer_table();
  if (table.empty()) {
    GTEST_SKIP() << "no reference table beside the project";
  }
  for (const auto& [nu, rows] : table) {
    const auto modes = testing::modes_at(nu, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double omega = kTwoPi * rows[i].speed * rows[i].a_over_wavelength;
      EXPECT_NEAR(omega / modes[i].gamma.imag(), rows[i].speed, 1e-6)
          << "nu " << nu << " a/Lambda " << rows[i].a_over_wavelength;
      EXPECT_NEAR(modes[i].gamma.real(), 0.0, 1e-9);
    }
  }
}

TEST(PochhammerChree, MeanOverSurfaceStrainOfTheTable) {
  const auto table = testing::pochhammer_table();
  if (table.empty()) {
    GTEST_SKIP() << "no reference table beside the project";
  }
  for (const auto& [nu, rows] : table) {
    const auto modes = testing::modes_at(nu, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // The ratio has a pole where the surface goes blind: compare its inverse, which has none.
      EXPECT_NEAR(1.0 / modes[i].mean_over_surface.real(), 1.0 / rows[i].mean_over_surface, 3e-5)
          << "nu " << nu << " a/Lambda " << rows[i].a_over_wavelength;
    }
  }
}

TEST(PochhammerChree, MeanStressOverMeanStrainOfTheTable) {
  const auto table = testing::pochhammer_table();
  if (table.empty()) {
    GTEST_SKIP() << "no reference table beside the project";
  }
  for (const auto& [nu, rows] : table) {
    const auto modes = testing::modes_at(nu, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Complex s(0.0, kTwoPi * rows[i].speed * rows[i].a_over_wavelength);
      const Complex ratio = s * s / (modes[i].gamma * modes[i].gamma);  // density and E are 1
      // Six decimals, of the square of a speed that has seven.
      EXPECT_NEAR(ratio.real(), rows[i].stress_over_strain, 1.5e-6)
          << "nu " << nu << " a/Lambda " << rows[i].a_over_wavelength;
      EXPECT_NEAR(ratio.imag(), 0.0, 1e-9);
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

// To the right of Poisson's ratio the first mode has met another: what is followed there is not it.
TEST(PochhammerChree, APathThatIsDampedWithinARadiusIsRefused) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, 0.3, 1.0, unit);
  EXPECT_NO_THROW((void)bar.along({{0.26, 0.0}}));
  try {
    (void)bar.along({{0.54, 0.0}});
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("record 2 times as long"), std::string::npos)
        << error.what();
  }
}

// Sections stay plane where nothing goes sideways: the elementary wave is exact, whatever its
// damping and frequency.
TEST(PochhammerChree, OfNoPoissonsRatioIsTheElementaryWave) {
  const ElasticSolid unit(1.0);
  std::vector<Complex> path;
  for (double up = 0.0; up < 14.0; up += 0.01) {
    path.emplace_back(0.14, up);
  }
  const auto modes_of = [&](double poisson_ratio) {
    return PochhammerChree(1.0, poisson_ratio, 1.0, unit).along(path);
  };
  for (const double none : {0.0, 1e-17, 1e-13}) {
    const auto modes = modes_of(none);
    for (std::size_t k = 0; k < path.size(); ++k) {
      ASSERT_NEAR(std::abs(modes[k].gamma - path[k]), 0.0, 1e-12);
      ASSERT_NEAR(std::abs(modes[k].mean_over_surface - 1.0), 0.0, 1e-12);
      ASSERT_NEAR(std::abs(modes[k].slope - 0.5), 0.0, 1e-12);
    }
  }
  // What little goes sideways moves the mean's share by as little, and the speed by its square.
  const auto off = [&](double poisson_ratio) {
    const auto modes = modes_of(poisson_ratio);
    std::pair<double, double> most{0.0, 0.0};
    for (std::size_t k = 0; path[k].imag() < 1.0; ++k) {
      most.first = std::max(most.first, std::abs(modes[k].gamma - path[k]));
      most.second = std::max(most.second, std::abs(modes[k].mean_over_surface - 1.0));
    }
    return most;
  };
  const auto thousandth = off(1e-3);
  const auto tenth_of_it = off(1e-4);
  EXPECT_LT(thousandth.second, 1e-3);
  EXPECT_NEAR(tenth_of_it.first / thousandth.first, 0.01, 1e-4);
  EXPECT_NEAR(tenth_of_it.second / thousandth.second, 0.1, 1e-3);
}

TEST(PochhammerChree, UpToThereDampingDoesNotMatter) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, 0.3, 1.0, unit);
  const auto ratio_at_six = [&](double damping) {
    std::vector<Complex> path;
    for (double up = 0.0; up < 6.0; up += 0.01) {
      path.emplace_back(damping, up);
    }
    return bar.along(path).back().gamma / path.back();
  };
  // 0.36 from the other mode's.
  EXPECT_NEAR(std::abs(ratio_at_six(0.26) - ratio_at_six(0.01)), 0.0, 2e-3);
}

}  // namespace
}  // namespace kolsky
