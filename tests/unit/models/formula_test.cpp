#include "processing/models/formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

const Dimension kNone{};

std::vector<FormulaSymbol> symbols() {
  return {{"s", dimension_of("1/s")},
          {"D", dimension_of("1/Pa")},
          {"tau", dimension_of("s")},
          {"x", kNone}};
}

/// A path longer than a block of the program, with a remainder.
std::vector<Complex> path() {
  std::vector<Complex> places;
  for (int k = 0; k < 201; ++k) {
    places.emplace_back(3.0e3, 1.0e3 * k);
  }
  return places;
}

constexpr double kD = 3e-12;
constexpr double kTau = 2e-5;
constexpr double kX = -0.7;

std::vector<Complex> evaluate(const std::string& text) {
  const Formula formula(text, symbols());
  const std::vector<Complex> s = path();
  const Complex D = kD;
  const Complex tau = kTau;
  const Complex x = kX;
  const std::vector<std::span<const Complex>> values{s, {&D, 1}, {&tau, 1}, {&x, 1}};
  std::vector<Complex> out(s.size());
  formula.evaluate(values, out);
  return out;
}

struct Case {
  const char* text;
  std::function<Complex(Complex)> truth;
};

TEST(Formula, GivesWhatTheSameArithmeticInCxxGives) {
  const std::vector<Case> cases{
      {"D/(1 + s*tau)", [](Complex s) { return kD / (1.0 + s * kTau); }},
      {"D*(s*tau)^-0.3", [](Complex s) { return kD * std::pow(s * kTau, -0.3); }},
      {"-x^2", [](Complex) { return Complex(-kX * kX); }},
      {"2^-x^2", [](Complex) { return Complex(std::pow(2.0, -kX * kX)); }},
      {"1 - 2 - 3", [](Complex) { return Complex(-4.0); }},
      {"8/2/2*3", [](Complex) { return Complex(6.0); }},
      {"2^3^2", [](Complex) { return Complex(512.0); }},
      {"exp(-s*tau)", [](Complex s) { return std::exp(-s * kTau); }},
      {"i*omega*tau", [](Complex s) { return s * kTau; }},
      {"sqrt(s*tau) + log(1+s*tau)",
       [](Complex s) { return std::sqrt(s * kTau) + std::log(1.0 + s * kTau); }},
      {"sinh(s*tau/2)/(s*tau/2)",
       [](Complex s) { return std::sinh(s * kTau / 2.0) / (s * kTau / 2.0); }},
      {"cosh(x)*tanh(x) + sin(x)*cos(x) - tan(x)",
       [](Complex) { return Complex(std::sinh(kX) + std::sin(kX) * std::cos(kX) - std::tan(kX)); }},
      {"(1+s*tau)^3 / (s*tau)^2 ",
       [](Complex s) { return std::pow(1.0 + s * kTau, 3) / std::pow(s * kTau, 2); }},
      {"1.5e-1 + .5 * pi", [](Complex) { return Complex(0.15 + 0.5 * 3.14159265358979323846); }},
  };
  const std::vector<Complex> s = path();
  for (const Case& own : cases) {
    const std::vector<Complex> values = evaluate(own.text);
    for (std::size_t k = 0; k < s.size(); ++k) {
      const Complex truth = own.truth(s[k]);
      EXPECT_LT(std::abs(values[k] - truth), 1e-12 * std::abs(truth)) << own.text << " at " << k;
    }
  }
}

TEST(Formula, KnowsItsUnit) {
  EXPECT_TRUE(Formula("D/(1 + s*tau)", symbols()).dimension().same(dimension_of("1/Pa")));
  EXPECT_TRUE(Formula("sqrt(s^2)*tau", symbols()).dimension().none());
  EXPECT_TRUE(Formula("(D^2)^0.5*s^-1", symbols()).dimension().same(dimension_of("s/Pa")));
}

TEST(Formula, RefusesWhatDoesNotParseOrAddUpNamingTheColumn) {
  struct Wrong {
    const char* text;
    const char* place;
  };
  for (const Wrong& wrong : {Wrong{"", "column 1"},
                             {"D/(1 + s*tau", "column 13"},
                             {"D/(1 + s)", "column 9"},
                             {"D + 1", "column 6"},
                             {"exp(s)", "column 6"},
                             {"2 s", "column 3"},
                             {"D*unknown", "column 3"},
                             {"s^x", "column 4"},
                             {"1e", "column 2"},
                             {"1e999", "column 1"},
                             {"D**2", "column 3"},
                             {"abs(s)", "column 1"},
                             {"x^(1/0)", "column 7"},
                             {"sin x", "column 5"},
                             {"s = 3", "column 3"}}) {
    try {
      const Formula formula(wrong.text, symbols());
      ADD_FAILURE() << wrong.text << " was taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), wrong.place) << wrong.text << ": " << error.what();
      EXPECT_FALSE(error.mend().empty());
    }
  }
}

TEST(Formula, RefusesWhatIsTooLongOrTooDeep) {
  EXPECT_THROW(Formula(std::string(5000, '(') + "x", symbols()), InputError);
  EXPECT_THROW(Formula(std::string(1000, '('), symbols()), InputError);
  EXPECT_THROW(Formula(std::string(1000, '-') + "x", symbols()), InputError);
  std::string sum = "x";
  for (int n = 0; n < 400; ++n) {
    sum += "+x";
  }
  EXPECT_THROW(Formula(sum, symbols()), InputError);
}

TEST(Units, AreReadAsProductsOfPowers) {
  // Pa = kg/(m s2), by definition of the SI.
  const Dimension Pa = dimension_of("kg/(m s2)");
  EXPECT_TRUE(Pa.same(dimension_of("Pa")));
  EXPECT_TRUE(dimension_of("1/(Pa s)").same(dimension_of("m s/kg")));
  EXPECT_TRUE(dimension_of("N/m^2").same(Pa));
  EXPECT_TRUE(dimension_of("Hz s").none());
  EXPECT_TRUE(dimension_of("-").none());
  EXPECT_TRUE(dimension_of("m s-1").same(dimension_of("m/s")));
  for (const char* wrong : {"", "MPa", "us", "1/(Pa", "Pa)", "m//s", "furlong", "m^x", "2 m"}) {
    EXPECT_THROW((void)dimension_of(wrong), InputError) << wrong;
  }
}

}  // namespace
}  // namespace kolsky
