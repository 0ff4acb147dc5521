#include "processing/criticism/fitting/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "processing/criticism/noise/smooth_power.hpp"

namespace kolsky {
namespace {

// Abramowitz and Stegun, table 26.8, and the closed form exp(-x/2) for two degrees of freedom.
TEST(Chi2Tail, AgreesWithTables) {
  EXPECT_NEAR(std::exp(log_chi2_tail(3.84146, 1.0)), 0.05, 1e-6);
  EXPECT_NEAR(std::exp(log_chi2_tail(18.307, 10.0)), 0.05, 1e-5);
  for (const double x : {0.5, 20.0, 400.0, 9000.0}) {
    EXPECT_NEAR(log_chi2_tail(x, 2.0), -x / 2.0, 1e-9 * x);
  }
}

TEST(FTail, AgreesWithTables) {
  EXPECT_NEAR(std::exp(log_f_tail(2.978, 10.0, 10.0)), 0.05, 1e-4);
}

TEST(EquivalentSquare, UndoesTheTailOfOneDegreeOfFreedom) {
  for (const double x : {0.3, 4.0, 60.0, 3000.0}) {
    EXPECT_NEAR(equivalent_square(log_chi2_tail(x, 1.0)), x, 1e-6 * x + 1e-9);
  }
}

// Student's t of 26 and 3 degrees of freedom at 0.5 %, from tables, against the normal deviate.
TEST(SquareOnNoise, AgreesWithTables) {
  EXPECT_NEAR(square_on_noise(2.7787 * 2.7787, 26.0), 2.5758 * 2.5758, 1e-3);
  EXPECT_NEAR(square_on_noise(5.8409 * 5.8409, 3.0), 2.5758 * 2.5758, 1e-3);
  EXPECT_NEAR(square_on_noise(7.5, 1e4), 7.5, 0.01);
  EXPECT_EQ(square_on_noise(-3.0, 20.0), -3.0);
  EXPECT_EQ(square_on_noise(0.0, 20.0), 0.0);
}

TEST(CombinedChance, OfOneThatStandsOutIsItsOwnOverItsWeight) {
  const std::vector<double> weights{0.5, 0.3, 0.2};
  for (const double log_p : {-12.0, -29.0, -31.0, -400.0}) {
    EXPECT_NEAR(combined_log_p(std::vector<double>{-0.7, log_p, -0.2}, weights),
                log_p - std::log(0.3), 1e-4);
  }
  EXPECT_NEAR(combined_log_p(std::vector<double>{-2.0, -2.0, -2.0}, weights), -2.0, 1e-12);
}

// Independent or all one test, chances of noise stay what they say.
TEST(CombinedChance, IsAsUniformAsTheChancesThatItCombines) {
  constexpr std::size_t kDraws = 20000;
  const std::vector<double> weights{0.5, 0.25, 0.25};
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const double limit : {0.3, 0.01}) {
    std::size_t below = 0;
    for (std::size_t n = 0; n < kDraws; ++n) {
      const double first = std::log(uniform(engine));
      const std::vector<double> log_ps{first, first, std::log(uniform(engine))};
      below += combined_log_p(log_ps, weights) < std::log(limit) ? 1 : 0;
    }
    const double expected = limit * kDraws;
    EXPECT_NEAR(static_cast<double>(below), expected, 4.0 * std::sqrt(expected)) << limit;
  }
}

TEST(DiscoveryLimit, StepsUpToTheLastThatCounts) {
  // Of four, at 0.5 %: limits of 1.25, 2.5, 3.75 and 5 in a thousand by rank.
  const auto limit = [](std::vector<double> ps) {
    for (double& p : ps) {
      p = std::log(p);
    }
    return std::exp(discovery_limit(std::move(ps)));
  };
  EXPECT_NEAR(limit({0.2, 0.0036, 0.0010, 0.0030}), 0.0036, 1e-12) << "0.0030 counts with it";
  EXPECT_NEAR(limit({0.2, 0.0038, 0.0010, 0.0030}), 0.0010, 1e-12);
  EXPECT_EQ(limit({0.2, 0.3, 0.0013, 0.9}), 0.0);
}

TEST(SmoothPower, FindsTheSpectrumThatDrewThePowers) {
  std::mt19937_64 random(7);
  std::gamma_distribution<double> chance(8.0, 1.0 / 8.0);
  std::vector<double> power;
  const auto truth = [](std::size_t k) {
    return 1.0 + 30.0 / static_cast<double>((k + 1) * (k + 1));
  };
  for (std::size_t k = 0; k < 300; ++k) {
    power.push_back(truth(k) * chance(random));
  }
  const auto found = smooth_power(power);
  EXPECT_NEAR(found.at(1.0) / truth(0), 1.0, 0.35);
  EXPECT_NEAR(found.at(5.0) / truth(4), 1.0, 0.25);
  EXPECT_NEAR(found.at(201.0) / truth(200), 1.0, 0.06);
}

}  // namespace
}  // namespace kolsky
