#include "processing/identification/noise_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace kolsky {

namespace {

constexpr std::size_t kHighestOrder = 12;

/// Autocovariances at lags 0 .. kHighestOrder, pooled over the stretches.
std::vector<double> autocovariances(const std::vector<std::span<const double>>& quiet,
                                    std::size_t& samples) {
  std::vector<double> covariance(kHighestOrder + 1, 0.0);
  samples = 0;
  for (const auto& stretch : quiet) {
    if (stretch.empty()) {
      continue;
    }
    const double mean =
        std::accumulate(stretch.begin(), stretch.end(), 0.0) / static_cast<double>(stretch.size());
    for (std::size_t lag = 0; lag <= kHighestOrder && lag < stretch.size(); ++lag) {
      for (std::size_t n = lag; n < stretch.size(); ++n) {
        covariance[lag] += (stretch[n] - mean) * (stretch[n - lag] - mean);
      }
    }
    samples += stretch.size();
  }
  for (double& value : covariance) {
    value /= static_cast<double>(std::max<std::size_t>(samples, 1));
  }
  return covariance;
}

}  // namespace

NoiseSpectrum::NoiseSpectrum(const std::vector<std::span<const double>>& quiet) {
  std::size_t samples = 0;
  const std::vector<double> r = autocovariances(quiet, samples);
  innovation_ = r[0];
  if (r[0] <= 0.0) {
    return;
  }
  // Levinson's recursion; of its orders the one with the smallest criterion is kept.
  std::vector<double> a;
  double error = r[0];
  double best = static_cast<double>(samples) * std::log(error);
  for (std::size_t order = 1; order <= kHighestOrder; ++order) {
    double reflection = r[order];
    for (std::size_t i = 0; i < a.size(); ++i) {
      reflection += a[i] * r[order - 1 - i];
    }
    reflection /= -error;
    std::vector<double> next(order);
    for (std::size_t i = 0; i < a.size(); ++i) {
      next[i] = a[i] + reflection * a[a.size() - 1 - i];
    }
    next[order - 1] = reflection;
    a = std::move(next);
    error *= 1.0 - reflection * reflection;
    const double criterion = static_cast<double>(samples) * std::log(std::max(error, 1e-300)) +
                             std::log(static_cast<double>(std::max<std::size_t>(samples, 3))) *
                                 static_cast<double>(order);
    if (criterion < best) {
      best = criterion;
      innovation_ = error;
      coefficients_ = a;
    }
  }
}

double NoiseSpectrum::power(double cycles_per_sample) const {
  std::complex<double> denominator = 1.0;
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    const double phase = -2.0 * std::numbers::pi * cycles_per_sample * static_cast<double>(i + 1);
    denominator += coefficients_[i] * std::polar(1.0, phase);
  }
  return innovation_ / std::norm(denominator);
}

}  // namespace kolsky
