#include "processing/criticism/noise/converter_steps.hpp"

#include <algorithm>
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
/// A stretch that a pulse's top is in ends as few steps from where it began: from one quarter of
/// it to the next a slow record moves by this at most.
constexpr double kMostAtOnce = 1.75;

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

RoundingAt::RoundingAt(double step, double noise_sd) : step_(step) {
  constexpr int kPlaces = 2048;
  constexpr double kNoNoise = 1e-6;  // of a step
  constexpr int kReach = 3;          // steps: noise that wears teeth down to nothing goes less far
  const double spread = std::numbers::sqrt2 * std::max(noise_sd / step, kNoNoise);
  double whole = 0.0;
  for (int i = 0; i <= kPlaces; ++i) {
    const double at = static_cast<double>(i) / kPlaces - 0.5;
    double mean = 0.0;
    double square = 0.0;
    for (int m = 0; m < kReach; ++m) {
      const double above = 0.5 * std::erfc((m + 0.5 - at) / spread);
      const double below = 0.5 * std::erfc((m + 0.5 + at) / spread);
      mean += above - below;
      square += (2 * m + 1) * (above + below);
    }
    mean_.push_back(step * (mean - at));
    beyond_.push_back(step * step * (square - mean * mean));
    whole += beyond_.back() / (kPlaces + 1);
  }
  const double counted = std::max(whole, step * step / 12.0);
  for (double& variance : beyond_) {
    variance = std::max(0.0, variance - counted);
  }
}

double RoundingAt::in(const std::vector<double>& table, double strain) const {
  const double steps = strain / step_ + 0.5;
  const double place = (steps - std::floor(steps)) * static_cast<double>(table.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), table.size() - 2);
  const double share = place - static_cast<double>(below);
  return (1.0 - share) * table[below] + share * table[below + 1];
}

double unrounded_sd(std::span<const std::span<const double>> records, double step) {
  double sum = 0.0;
  std::size_t samples = 0;
  for (const std::span<const double> record : records) {
    std::vector<double> before(record.size() + 1, 0.0);
    std::partial_sum(record.begin(), record.end(), before.begin() + 1);
    std::vector<double> changes{0.0};  // squares of them, summed up to each sample
    for (std::size_t n = 0; n + 1 < record.size(); ++n) {
      changes.push_back(changes.back() + std::pow(record[n + 1] - record[n], 2));
    }
    const auto mean = [&](std::size_t first) {
      return (before[first + kStretch] - before[first]) / static_cast<double>(kStretch);
    };
    const auto moves_evenly = [&](std::size_t first) {
      for (std::size_t at = first; at < first + kApart; at += kStretch) {
        if (std::abs(mean(at + kStretch) - mean(at)) > kMostAtOnce * step) {
          return false;
        }
      }
      return true;
    };
    for (std::size_t n = 0; n + kApart + kStretch < record.size(); ++n) {
      const double moved = std::abs(mean(n + kApart) - mean(n)) / step;
      if (moved > kLeastSteps && moved < kMostSteps && moves_evenly(n)) {
        // In its middle alone it would be where between two codes its ends are.
        constexpr std::size_t kFirst = (kApart + kStretch) / 4;
        constexpr std::size_t kSize = (kApart + kStretch) / 2;
        sum += 0.5 * (changes[n + kFirst + kSize] - changes[n + kFirst]) / (kSize * step * step);
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
