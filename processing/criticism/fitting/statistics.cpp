#include "processing/criticism/fitting/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace kolsky {

namespace {

/// The last digits of a chance are worth no longer numbers.
const boost::math::policies::policy<boost::math::policies::promote_double<false>> kAsDouble;

}  // namespace

double log_chi2_tail(double x, double k) {
  if (x <= 0.0) {
    return 0.0;
  }
  const double a = k / 2.0;
  const double z = x / 2.0;
  if (z < a + 30.0) {
    return std::log(std::max(boost::math::gamma_q(a, z, kAsDouble), 1e-300));
  }
  // Lentz's evaluation of the continued fraction of Gamma(a, z) e^z z^-a.
  double b = z + 1.0 - a;
  double c = 1e300;
  double d = 1.0 / b;
  double h = d;
  for (int i = 1; i < 500; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    const double factor = c * d;
    h *= factor;
    if (std::abs(factor - 1.0) < 1e-14) {
      break;
    }
  }
  return -z + a * std::log(z) - boost::math::lgamma(a, kAsDouble) + std::log(h);
}

double log_f_tail(double f, double m, double n) {
  if (f <= 0.0) {
    return 0.0;
  }
  if (!std::isfinite(f)) {
    return -std::numeric_limits<double>::max();
  }
  // Of very many degrees of freedom in the denominator, or far out: chi-square.
  const boost::math::fisher_f distribution(m, n);
  const double tail = boost::math::cdf(boost::math::complement(distribution, f));
  return tail > 1e-280 ? std::log(tail) : log_chi2_tail(f * m / (1.0 + f * m / n), m);
}

double log_gain_tail(double gain, double freedom, Signs signs) {
  const double log_p = log_chi2_tail(std::max(gain, 0.0), std::max(freedom, 1.0));
  return signs == Signs::one ? log_p - std::log(2.0) : log_p;
}

double equivalent_square(double log_tail) {
  // chi-square of one degree of freedom with the same tail, by bisection on its logarithm.
  double low = 0.0;
  double high = std::max(4.0, -2.5 * log_tail + 10.0);
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (log_chi2_tail(middle, 1.0) > log_tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double square_on_noise(double square, double known) {
  return square > 0.0 ? equivalent_square(log_f_tail(square, 1.0, known)) : square;
}

double combined_log_p(std::span<const double> log_ps, std::span<const double> weights) {
  constexpr double kFarOut = -30.0;  // the tangent is the reciprocal there
  constexpr double kMost = 0.99;     // a chance of nearly 1 would cancel any other
  const double least = *std::ranges::min_element(log_ps);
  double sum = 0.0;
  for (std::size_t i = 0; i < log_ps.size(); ++i) {
    if (least < kFarOut) {
      sum += weights[i] * std::exp(least - log_ps[i]);
    } else {
      const double p = std::min(kMost, std::exp(log_ps[i]));
      sum += weights[i] / std::tan(std::numbers::pi * p);
    }
  }
  if (least < kFarOut) {
    return least - std::log(sum);
  }
  return std::log(std::atan2(1.0, sum) / std::numbers::pi);
}

double discovery_limit(std::vector<double> log_ps) {
  std::sort(log_ps.begin(), log_ps.end());
  double limit = -HUGE_VAL;
  for (std::size_t i = 0; i < log_ps.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(log_ps.size());
    if (log_ps[i] <= std::log(kFalseDiscovery * share)) {
      limit = log_ps[i];
    }
  }
  return limit;
}

}  // namespace kolsky
