#include "tests/generators/spectral.hpp"

#include <cmath>
#include <functional>

namespace kolsky::testing {

namespace {

double legendre(int n, double x) {
  return std::legendre(static_cast<unsigned>(n), x);
}

double legendre_slope(int n, double x) {
  return n * (x * legendre(n, x) - legendre(n - 1, x)) / (x * x - 1.0);
}

// All sign changes inside (-1, 1).
std::vector<double> roots(const std::function<double(double)>& f) {
  constexpr int kScan = 4000;
  std::vector<double> found;
  for (int i = 0; i < kScan; ++i) {
    // Odd offsets keep the scan off the middle, where odd functions vanish exactly.
    double low = -1.0 + 2.0 * (i + 0.137) / (kScan + 0.5);
    double high = -1.0 + 2.0 * (i + 1.137) / (kScan + 0.5);
    if (high >= 1.0 || (f(low) > 0.0) == (f(high) > 0.0)) {
      continue;
    }
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (low + high);
      ((f(low) > 0.0) == (f(middle) > 0.0) ? low : high) = middle;
    }
    found.push_back(0.5 * (low + high));
  }
  return found;
}

void differentiate(SpectralRule& rule) {
  rule.derivative.clear();
  for (const double x : rule.node) {
    rule.derivative.push_back(lagrange_slopes(rule, x));
  }
}

}  // namespace

std::vector<double> lagrange_slopes(const SpectralRule& rule, double x) {
  const std::size_t n = rule.node.size();
  std::vector<double> slopes(n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t m = 0; m < n; ++m) {
      if (m == j) {
        continue;
      }
      double term = 1.0 / (rule.node[j] - rule.node[m]);
      for (std::size_t k = 0; k < n; ++k) {
        if (k != j && k != m) {
          term *= (x - rule.node[k]) / (rule.node[j] - rule.node[k]);
        }
      }
      slopes[j] += term;
    }
  }
  return slopes;
}

SpectralRule lobatto(int points) {
  const int n = points - 1;
  SpectralRule rule;
  rule.node = {-1.0};
  for (const double x : roots([n](double at) { return legendre_slope(n, at); })) {
    rule.node.push_back(x);
  }
  rule.node.push_back(1.0);
  for (const double x : rule.node) {
    rule.weight.push_back(2.0 / (n * (n + 1) * std::pow(legendre(n, x), 2)));
  }
  differentiate(rule);
  return rule;
}

SpectralRule radau(int points) {
  const int n = points;
  SpectralRule rule;
  rule.node = roots([n](double at) { return legendre(n - 1, at) - legendre(n, at); });
  rule.node.push_back(1.0);
  for (const double x : rule.node) {
    rule.weight.push_back((1.0 + x) / (n * n * std::pow(legendre(n - 1, x), 2)));
  }
  differentiate(rule);
  return rule;
}

}  // namespace kolsky::testing
