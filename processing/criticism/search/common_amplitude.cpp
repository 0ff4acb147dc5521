#include "processing/criticism/search/common_amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace kolsky {

namespace {

double log_likelihood(const QuadratureParts& shot, double amplitude) {
  // Bells that are no narrower than the spacing are summed without an error to speak of.
  const double narrowest = amplitude * std::sqrt(shot.information.trace());
  const int phases = static_cast<int>(std::clamp(2.0 * std::numbers::pi * narrowest, 64.0, 4096.0));
  std::vector<double> logs;
  for (int n = 0; n < phases; ++n) {
    const double phase = 2.0 * std::numbers::pi * n / phases;
    const Eigen::Vector2d parts = amplitude * Eigen::Vector2d(std::cos(phase), std::sin(phase));
    logs.push_back(shot.pull.dot(parts) - 0.5 * parts.dot(shot.information * parts));
  }
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double value : logs) {
    sum += std::exp(value - most);
  }
  return most + std::log(sum / phases);
}

/// The likelihood at some amplitudes in a row.
class Likelihoods {
 public:
  Likelihoods(const std::vector<QuadratureParts>& shots, double from, double to) {
    constexpr int kPlaces = 80;
    step_ = (to - from) / kPlaces;
    for (int n = 0; n <= kPlaces; ++n) {
      at_.push_back(from + step_ * n);
      double sum = 0.0;
      for (const QuadratureParts& shot : shots) {
        sum += log_likelihood(shot, at_.back());
      }
      logs_.push_back(sum);
    }
    most_ = *std::max_element(logs_.begin(), logs_.end());
  }

  /// Where it is not negligible, with a step to either side.
  [[nodiscard]] std::pair<double, double> reach() const {
    constexpr double kNegligible = -20.0;
    double from = at_.back();
    double to = at_.front();
    for (std::size_t n = 0; n < at_.size(); ++n) {
      if (logs_[n] > most_ + kNegligible) {
        from = std::min(from, at_[n] - step_);
        to = std::max(to, at_[n] + step_);
      }
    }
    return {std::max(0.0, from), to};
  }

  [[nodiscard]] Amplitude moments() const {
    double weight = 0.0;
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t n = 0; n < at_.size(); ++n) {
      const double own = std::exp(logs_[n] - most_);
      weight += own;
      mean += own * at_[n];
      square += own * at_[n] * at_[n];
    }
    mean /= weight;
    return {mean, std::sqrt(std::max(0.0, square / weight - mean * mean))};
  }

 private:
  std::vector<double> at_;
  std::vector<double> logs_;
  double step_ = 0.0;
  double most_ = 0.0;
};

}  // namespace

Amplitude common_amplitude(const std::vector<QuadratureParts>& shots) {
  double largest = 0.0;
  for (const QuadratureParts& shot : shots) {
    const double information = shot.information.trace();
    largest = std::max(largest, information > 0.0 ? shot.pull.norm() / information : 0.0);
  }
  if (!(largest > 0.0)) {
    return {};
  }
  constexpr double kReach = 20.0;
  std::pair<double, double> reach{0.0, kReach * largest};
  // Closer and closer: a bell a hundredth as wide as its place is far shows after two.
  constexpr int kTimes = 3;
  for (int n = 0; n < kTimes; ++n) {
    reach = Likelihoods(shots, reach.first, reach.second).reach();
  }
  return Likelihoods(shots, reach.first, reach.second).moments();
}

}  // namespace kolsky
