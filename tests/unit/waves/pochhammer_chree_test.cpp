#include "processing/waves/pochhammer_chree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

TEST(PochhammerChree, APathMayStartWhereTheBarIsThick) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, 0.3, 1.0, unit);
  for (const Complex start : {Complex(0.0, 2.0), Complex(1.2, 0.0), Complex(1.0, 3.0)}) {
    std::vector<Complex> from_thin;
    for (int step = 1; step <= 100; ++step) {
      from_thin.push_back(start * (0.01 * step));
    }
    const BarMode there = bar.along(from_thin).back();
    const BarMode at_once = bar.along({start}).front();
    EXPECT_NEAR(std::abs(at_once.gamma - there.gamma), 0.0, 1e-9 * std::abs(there.gamma));
    EXPECT_NEAR(std::abs(at_once.mean_over_surface - there.mean_over_surface), 0.0, 1e-9);
    EXPECT_NEAR(std::abs(at_once.slope - there.slope), 0.0, 1e-7);
  }
}

TEST(PochhammerChree, APathThatStartsBeyondWhatIsFollowedHasTheLastRatio) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, 0.3, 1.0, unit);
  const auto ratio_at = [&](double omega) {
    return bar.along({Complex(0.0, omega)}).front().gamma.imag() / omega;
  };
  EXPECT_NEAR(ratio_at(20.0), ratio_at(11.95), 1e-4);
  const double rayleigh = 0.9274 * std::sqrt(0.5 / 1.3);  // of sqrt(E / density), nu 0.3
  EXPECT_NEAR(1.0 / ratio_at(20.0), rayleigh, 0.01 * rayleigh);
}

}  // namespace
}  // namespace kolsky
