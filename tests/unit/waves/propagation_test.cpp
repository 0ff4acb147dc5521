#include "processing/waves/propagation.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace kolsky {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Published {
  double frequency_Hz;
  double alpha_per_m;
  double speed_m_per_s;
};

// Elementary waves in the paper's PMMA: values checked in high precision outside this project.
TEST(ElementaryPropagation, AgreesWithTheCheckedValuesToTheDigitsGiven) {
  const ThreeElementSolid pmma(paper_pmma());
  const ElementaryPropagation waves(1180.0, pmma);
  for (const Published& row : {Published{10e3, 0.64074, 2173.72}, Published{20e3, 0.69408, 2185.65},
                               Published{40e3, 0.70884, 2188.97}}) {
    const double omega = kTwoPi * row.frequency_Hz;
    const Complex gamma = waves.gamma({0.0, omega});
    EXPECT_NEAR(gamma.real(), row.alpha_per_m, 5e-6) << row.frequency_Hz;
    EXPECT_NEAR(omega / gamma.imag(), row.speed_m_per_s, 5e-3) << row.frequency_Hz;
  }
}

TEST(ElementaryPropagation, ObeysEquationNine) {
  const ThreeElementSolid pmma(paper_pmma());
  const ElementaryPropagation waves(1180.0, pmma);
  for (const double frequency_Hz : {10.0, 1e3, 4e3, 50e3}) {
    const double omega = kTwoPi * frequency_Hz;
    const Complex gamma = waves.gamma({0.0, omega});
    // J1 and J2 of eq. (A3), written out.
    const double d = 37.0e9 * 37.0e9 + omega * 1.81e6 * omega * 1.81e6;
    const double J1 = 1.0 / 5.66e9 + 37.0e9 / d;
    const double J2 = omega * 1.81e6 / d;
    const double alpha = gamma.real();
    const double k = gamma.imag();
    EXPECT_NEAR(k * k - alpha * alpha, 1180.0 * omega * omega * J1, 1e-9 * k * k);
    EXPECT_NEAR(2.0 * alpha * k, 1180.0 * omega * omega * J2, 1e-9 * k * k);
  }
}

TEST(ElementaryPropagation, DecaysEverywhereInTheRightHalfPlane) {
  const ThreeElementSolid pmma(paper_pmma());
  const ElementaryPropagation waves(1180.0, pmma);
  for (const double eta : {1.0, 1e3, 1e5}) {
    for (const double omega : {0.0, 1e2, 1e4, 1e7}) {
      EXPECT_GT(waves.gamma({eta, omega}).real(), 0.0);
    }
  }
}

TEST(ElementaryPropagation, AnElasticBarOnlyDelays) {
  const ElasticSolid steel(206e9);
  const ElementaryPropagation waves(7850.0, steel);
  const Complex gamma = waves.gamma({0.0, 1e5});
  EXPECT_EQ(gamma.real(), 0.0);
  EXPECT_NEAR(gamma.imag(), 1e5 / std::sqrt(206e9 / 7850.0), 1e-9);
  EXPECT_NEAR(waves.front_speed_m_per_s(), std::sqrt(206e9 / 7850.0), 1e-9);
}

TEST(ComplianceOf, TheBenchDecidesWhetherABarIsElastic) {
  Bar bar;
  EXPECT_NEAR(compliance_of(bar, paper_pmma())->instantaneous(), 1.0 / 5.66e9, 1e-20);
  bar.youngs_modulus_Pa = Measured{113e9};
  EXPECT_NEAR(compliance_of(bar, paper_pmma())->instantaneous(), 1.0 / 113e9, 1e-20);
}

}  // namespace
}  // namespace kolsky
