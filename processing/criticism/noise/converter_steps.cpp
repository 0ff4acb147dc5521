#include "processing/criticism/noise/converter_steps.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

namespace kolsky {

namespace {

constexpr int kMostHarmonics = 12;
/// Of the first harmonic's power without noise: what is less does not count.
constexpr double kLeastShare = 1e-3;

/// A record is slow where it crosses two or three steps between the means of two stretches.
constexpr std::size_t kStretch = 20;
constexpr std::size_t kApart = 60;  ///< from the middle of one to the other's
constexpr double kLeastSteps = 1.5;
constexpr double kMostSteps = 3.5;
constexpr std::size_t kFewestSlow = 100;

/// Share of rounding's power in its harmonic h.
double share_of(int h, double step, double noise_sd) {
  const double turns = std::numbers::pi * h * noise_sd / step;
  return std::exp(-4.0 * turns * turns) / (h * h);
}

/// Variance, in steps squared, of what changes from sample to sample: of noise and rounding all but
/// the mean that rounding leaves.
double quick_variance(double noise_in_steps) {
  double mean_square = 0.0;
  for (int h = 1; h <= kMostHarmonics; ++h) {
    mean_square += 0.5 * share_of(h, 1.0, noise_in_steps) / (std::numbers::pi * std::numbers::pi);
  }
  return noise_in_steps * noise_in_steps + 1.0 / 12.0 - mean_square;
}

}  // namespace

double unrounded_sd(std::span<const std::span<const double>> records, double step) {
  double sum = 0.0;
  std::size_t samples = 0;
  for (const std::span<const double> record : records) {
    std::vector<double> before(record.size() + 1, 0.0);
    std::partial_sum(record.begin(), record.end(), before.begin() + 1);
    const auto mean = [&](std::size_t first) {
      return (before[first + kStretch] - before[first]) / static_cast<double>(kStretch);
    };
    for (std::size_t n = 0; n + kApart + kStretch < record.size(); ++n) {
      const double moved = std::abs(mean(n + kApart) - mean(n)) / step;
      if (moved > kLeastSteps && moved < kMostSteps) {
        const std::size_t middle = n + (kApart + kStretch) / 2;
        const double change = (record[middle + 1] - record[middle]) / step;
        sum += 0.5 * change * change;
        ++samples;
      }
    }
  }
  if (samples < kFewestSlow) {
    return 0.0;
  }
  const double variance = sum / static_cast<double>(samples);
  double least = 0.0;
  double most = 1.0;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (least + most);
    (quick_variance(middle) < variance ? least : most) = middle;
  }
  return least * step;
}

std::vector<double> rounding_power(DampedTransform& transform, std::span<const double> clean,
                                   double step, double noise_sd, std::size_t bins) {
  std::vector<double> power(bins, 0.0);
  std::vector<double> sine(clean.size());
  std::vector<double> cosine(clean.size());
  std::vector<Complex> of_sine(transform.bins());
  std::vector<Complex> of_cosine(transform.bins());
  for (int h = 1; h <= kMostHarmonics && share_of(h, step, noise_sd) > kLeastShare; ++h) {
    for (std::size_t n = 0; n < clean.size(); ++n) {
      const double angle = 2.0 * std::numbers::pi * h * clean[n] / step;
      sine[n] = std::sin(angle);
      cosine[n] = std::cos(angle);
    }
    transform.forward(sine, of_sine);
    transform.forward(cosine, of_cosine);
    const double amplitude_square =
        step * step / (std::numbers::pi * std::numbers::pi) * share_of(h, step, noise_sd);
    for (std::size_t k = 0; k < bins; ++k) {
      power[k] +=
          0.5 * amplitude_square * (std::norm(of_sine[k + 1]) + std::norm(of_cosine[k + 1]));
    }
  }
  return power;
}

}  // namespace kolsky
