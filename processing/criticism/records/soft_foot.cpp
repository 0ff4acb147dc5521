#include "processing/criticism/records/soft_foot.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/first_pulse.hpp"

namespace kolsky {

namespace {

/// Mean over shots, each by its first pulse's height, of the samples before the quiet's end, the
/// last first: in shares of the height.
std::vector<double> backwards(const std::vector<CampaignShot>& shots, std::size_t gauge,
                              std::size_t count, double rate_Hz) {
  std::vector<double> mean(count, 0.0);
  double squares = 1e-30;
  for (const CampaignShot& shot : shots) {
    const std::vector<double>& strain = shot.strain[gauge];
    // What comes back may be larger, and of the other sign.
    const auto pulse = first_pulse(strain, rate_Hz);
    const double height = pulse ? pulse->sense * pulse->height : 0.0;
    squares += height * height;
    for (std::size_t k = 0; k < count; ++k) {
      mean[k] += height * strain[shot.quiet_samples - 1 - k];
    }
  }
  for (double& value : mean) {
    value /= squares;
  }
  return mean;
}

/// Means of blocks, and the line through those from `first` on.
class Blocks {
 public:
  Blocks(const std::vector<double>& samples, std::size_t length, std::size_t first)
      : first_(first) {
    for (std::size_t begin = 0; begin + length <= samples.size(); begin += length) {
      double sum = 0.0;
      for (std::size_t k = begin; k < begin + length; ++k) {
        sum += samples[k];
      }
      means_.push_back(sum / static_cast<double>(length));
    }
    fit_line();
  }

  /// How far a block lies above the line, in deviations of its own and the line's together; 0 where
  /// a converter's steps hide all that differs.
  [[nodiscard]] double above(std::size_t block) const {
    if (!(sd_ > 0.0)) {
      return 0.0;
    }
    const double x = static_cast<double>(block) - centre_;
    return (means_[block] - level_ - slope_ * x) /
           (sd_ * std::sqrt(1.0 + 1.0 / count() + x * x / spread_));
  }

 private:
  [[nodiscard]] double count() const { return static_cast<double>(means_.size() - first_); }

  void fit_line() {
    centre_ = 0.5 * static_cast<double>(first_ + means_.size() - 1);
    double along = 0.0;
    for (std::size_t b = first_; b < means_.size(); ++b) {
      const double x = static_cast<double>(b) - centre_;
      level_ += means_[b] / count();
      along += x * means_[b];
      spread_ += x * x;
    }
    slope_ = along / spread_;
    double squares = 0.0;
    for (std::size_t b = first_; b < means_.size(); ++b) {
      squares += std::pow(means_[b] - level_ - slope_ * (static_cast<double>(b) - centre_), 2);
    }
    sd_ = std::sqrt(squares / (count() - 2.0));
  }

  std::size_t first_;
  std::vector<double> means_;
  double centre_ = 0.0;
  double level_ = 0.0;
  double slope_ = 0.0;
  double spread_ = 0.0;
  double sd_ = 0.0;
};

}  // namespace

std::size_t soft_foot_samples(const std::vector<CampaignShot>& shots, std::size_t gauge,
                              double period_s) {
  constexpr double kLongestBlock_s = 10e-6;
  constexpr std::size_t kBlocks = 30;
  constexpr std::size_t kOfAFoot = kBlocks / 3;
  constexpr double kSeen = 3.0;
  constexpr double kStill = 1.5;
  std::size_t shortest = shots.front().quiet_samples;
  for (const CampaignShot& shot : shots) {
    shortest = std::min(shortest, shot.quiet_samples);
  }
  const auto longest =
      std::max<std::size_t>(1, static_cast<std::size_t>(kLongestBlock_s / period_s));
  const std::size_t length = std::min(longest, shortest / kBlocks);
  if (length == 0) {
    return 0;
  }
  const Blocks blocks(backwards(shots, gauge, kBlocks * length, 1.0 / period_s), length, kOfAFoot);
  if (blocks.above(0) < kSeen) {
    return 0;
  }
  std::size_t rising = 1;
  while (rising < kOfAFoot && blocks.above(rising) > kStill) {
    ++rising;
  }
  // What is left of it below what a block shows lies in the next.
  return std::min(std::min(rising + 1, kOfAFoot) * length,
                  shortest - std::min(shortest, kFewestQuiet));
}

}  // namespace kolsky
