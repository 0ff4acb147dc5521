#include "processing/identification/solids.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

class FourElementFluid final : public Compliance {
 public:
  explicit FourElementFluid(std::span<const double> p)
      : E1_(p[0]), eta2_(p[1]), E3_(p[2]), eta3_(p[3]) {}
  [[nodiscard]] Complex at(Complex s) const override {
    return 1.0 / E1_ + 1.0 / (s * eta2_) + 1.0 / (E3_ + s * eta3_);
  }
  [[nodiscard]] double instantaneous() const override { return 1.0 / E1_; }

 private:
  double E1_, eta2_, E3_, eta3_;
};

class TwoKelvin final : public Compliance {
 public:
  explicit TwoKelvin(std::span<const double> p)
      : E1_(p[0]), E2_(p[1]), eta2_(p[2]), E3_(p[3]), eta3_(p[4]) {}
  [[nodiscard]] Complex at(Complex s) const override {
    return 1.0 / E1_ + 1.0 / (E2_ + s * eta2_) + 1.0 / (E3_ + s * eta3_);
  }
  [[nodiscard]] double instantaneous() const override { return 1.0 / E1_; }

 private:
  double E1_, E2_, eta2_, E3_, eta3_;
};

class FractionalSolid final : public Compliance {
 public:
  explicit FractionalSolid(std::span<const double> p)
      : E1_(p[0]), E2_(p[1]), eta2_(p[2]), beta_(p[3]) {}
  [[nodiscard]] Complex at(Complex s) const override {
    return 1.0 / E1_ + 1.0 / (E2_ * (1.0 + std::pow(s * eta2_ / E2_, beta_)));
  }
  [[nodiscard]] double instantaneous() const override { return 1.0 / E1_; }

 private:
  double E1_, E2_, eta2_, beta_;
};

constexpr std::array kNames{std::pair{SolidKind::three_element, "three-element"},
                            std::pair{SolidKind::four_element_fluid, "four-element-fluid"},
                            std::pair{SolidKind::two_kelvin, "two-kelvin"},
                            std::pair{SolidKind::fractional, "fractional"}};

}  // namespace

const std::vector<SolidParameter>& parameters_of(SolidKind kind) {
  static const std::vector<SolidParameter> three = {{"E1_Pa"}, {"E2_Pa"}, {"eta2_Pa_s"}};
  static const std::vector<SolidParameter> four = {
      {"E1_Pa"}, {"eta2_Pa_s"}, {"E3_Pa"}, {"eta3_Pa_s"}};
  static const std::vector<SolidParameter> kelvin = {
      {"E1_Pa"}, {"E2_Pa"}, {"eta2_Pa_s"}, {"E3_Pa"}, {"eta3_Pa_s"}};
  static const std::vector<SolidParameter> fractional = {
      {"E1_Pa"}, {"E2_Pa"}, {"eta2_Pa_s"}, {"beta"}};
  switch (kind) {
    case SolidKind::three_element:
      return three;
    case SolidKind::four_element_fluid:
      return four;
    case SolidKind::two_kelvin:
      return kelvin;
    case SolidKind::fractional:
      break;
  }
  return fractional;
}

std::unique_ptr<const Compliance> make_solid(SolidKind kind, std::span<const double> parameters) {
  switch (kind) {
    case SolidKind::three_element:
      return std::make_unique<ThreeElementSolid>(parameters[0], parameters[1], parameters[2]);
    case SolidKind::four_element_fluid:
      return std::make_unique<FourElementFluid>(parameters);
    case SolidKind::two_kelvin:
      return std::make_unique<TwoKelvin>(parameters);
    case SolidKind::fractional:
      break;
  }
  return std::make_unique<FractionalSolid>(parameters);
}

SolidKind solid_kind(const std::string& name) {
  for (const auto& [kind, text] : kNames) {
    if (name == text) {
      return kind;
    }
  }
  throw InputError("solid", "\"" + name + "\" is not a family of solids",
                   "give three-element, four-element-fluid, two-kelvin or fractional");
}

std::string name_of(SolidKind kind) {
  for (const auto& [known, text] : kNames) {
    if (kind == known) {
      return text;
    }
  }
  return {};
}

}  // namespace kolsky
