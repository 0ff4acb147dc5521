#include "processing/criticism/search/common_amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
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

  [[nodiscard]] double most() const { return most_; }
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

namespace {

/// Where the likelihood is not negligible, looked at closely; nothing where nothing pulls.
std::optional<Likelihoods> likelihoods_of(const std::vector<QuadratureParts>& shots) {
  double largest = 0.0;
  for (const QuadratureParts& shot : shots) {
    const double information = shot.information.trace();
    largest = std::max(largest, information > 0.0 ? shot.pull.norm() / information : 0.0);
  }
  if (!(largest > 0.0)) {
    return std::nullopt;
  }
  constexpr double kReach = 20.0;
  std::pair<double, double> reach{0.0, kReach * largest};
  // Closer and closer: a bell a hundredth as wide as its place is far shows after two.
  constexpr int kTimes = 3;
  for (int n = 0; n < kTimes; ++n) {
    reach = Likelihoods(shots, reach.first, reach.second).reach();
  }
  return Likelihoods(shots, reach.first, reach.second);
}

}  // namespace

Amplitude common_amplitude(const std::vector<QuadratureParts>& shots) {
  const std::optional<Likelihoods> likelihoods = likelihoods_of(shots);
  return likelihoods ? likelihoods->moments() : Amplitude{};
}

double log_likelihood_of_common_amplitude(const std::vector<QuadratureParts>& shots) {
  const std::optional<Likelihoods> likelihoods = likelihoods_of(shots);
  return likelihoods ? likelihoods->most() : 0.0;
}

double log_likelihood_of_drawn_strengths(const Eigen::VectorXd& pull,
                                         const Eigen::VectorXd& information) {
  // From a tenth of the least deviation of one to ten times the largest strength.
  const Eigen::ArrayXd known = information.array().max(1e-300);
  const double least = 0.1 / std::sqrt(known.maxCoeff());
  const double largest = std::max(10.0 * (pull.array() / known).abs().maxCoeff(), 2.0 * least);
  constexpr int kPlaces = 200;
  double best = 0.0;
  for (int n = 0; n <= kPlaces; ++n) {
    const double sd = least * std::pow(largest / least, static_cast<double>(n) / kPlaces);
    const Eigen::ArrayXd with = known + 1.0 / (sd * sd);
    best = std::max(best, 0.5 * (pull.array().square() / with - (sd * sd * with).log()).sum());
  }
  return best;
}

}  // namespace kolsky
