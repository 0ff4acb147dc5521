#include "processing/waves/solids.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace kolsky {

namespace {

constexpr std::size_t kMostSolidParameters = 9;

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

/// A spring, and springs with dashpots beside them, all in line.
class KelvinChain final : public Compliance {
 public:
  explicit KelvinChain(std::span<const double> p) : p_(p.begin(), p.end()) {}
  [[nodiscard]] Complex at(Complex s) const override {
    Complex J = 1.0 / p_[0];
    for (std::size_t i = 1; i < p_.size(); i += 2) {
      J += 1.0 / (p_[i] + s * p_[i + 1]);
    }
    return J;
  }
  [[nodiscard]] double instantaneous() const override { return 1.0 / p_[0]; }

 private:
  std::vector<double> p_;
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

/// J at one s, and how it moves with the logarithm of each parameter.
struct Moved {
  Complex J;
  std::array<Complex, kMostSolidParameters> by_log;
};

/// Adds a spring and a dashpot side by side.
void add_kelvin(Complex s, double E, double eta, std::size_t at_E, std::size_t at_eta, Moved& m) {
  const Complex k = 1.0 / (E + s * eta);
  m.J += k;
  m.by_log[at_E] = -E * k * k;
  m.by_log[at_eta] = -s * eta * k * k;
}

void add_dashpot(Complex s, double eta, std::size_t at, Moved& m) {
  const Complex k = 1.0 / (s * eta);
  m.J += k;
  m.by_log[at] = -k;
}

/// E2 and eta2 at places 1 and 2, the power at 3.
void add_fractional(Complex s, std::span<const double> p, Moved& m) {
  const Complex log_z = p[3] * std::log(s * p[2] / p[1]);
  const Complex z = std::exp(log_z);
  const Complex k = 1.0 / (p[1] * (1.0 + z));
  const Complex by_z = -k * k * p[1];
  m.J += k;
  m.by_log[1] = by_z * (1.0 + z - p[3] * z);
  m.by_log[2] = by_z * p[3] * z;
  m.by_log[3] = by_z * log_z * z;
}

Moved moved(SolidKind kind, std::span<const double> p, Complex s) {
  Moved m;
  m.J = 1.0 / p[0];
  m.by_log[0] = -m.J;
  switch (kind) {
    case SolidKind::three_element:
      add_kelvin(s, p[1], p[2], 1, 2, m);
      break;
    case SolidKind::four_element_fluid:
      add_dashpot(s, p[1], 1, m);
      add_kelvin(s, p[2], p[3], 2, 3, m);
      break;
    case SolidKind::two_kelvin:
    case SolidKind::three_kelvin:
    case SolidKind::four_kelvin:
      for (std::size_t i = 1; i < p.size(); i += 2) {
        add_kelvin(s, p[i], p[i + 1], i, i + 1, m);
      }
      break;
    case SolidKind::fractional:
      add_fractional(s, p, m);
      break;
  }
  return m;
}

}  // namespace

std::unique_ptr<const Compliance> make_solid(SolidKind kind, std::span<const double> parameters) {
  switch (kind) {
    case SolidKind::three_element:
      return std::make_unique<ThreeElementSolid>(parameters[0], parameters[1], parameters[2]);
    case SolidKind::four_element_fluid:
      return std::make_unique<FourElementFluid>(parameters);
    case SolidKind::two_kelvin:
    case SolidKind::three_kelvin:
    case SolidKind::four_kelvin:
      return std::make_unique<KelvinChain>(parameters);
    case SolidKind::fractional:
      break;
  }
  return std::make_unique<FractionalSolid>(parameters);
}

std::vector<std::vector<Complex>> log_slopes(SolidKind kind, std::span<const double> parameters,
                                             std::span<const Complex> path) {
  std::vector<std::vector<Complex>> slopes(parameters.size(), std::vector<Complex>(path.size()));
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Moved m = moved(kind, parameters, path[k]);
    const Complex per_J = 1.0 / m.J;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      slopes[i][k] = m.by_log[i] * per_J;
    }
  }
  return slopes;
}

}  // namespace kolsky
