#include "drivers/iio/loss_by_clock.hpp"

#include <algorithm>

namespace kolsky {
namespace {

constexpr double kWindow_s = 1.0;
constexpr double kLeastThreshold_s = 5e-3;
constexpr double kBlocksThreshold = 4.0;
constexpr double kDrift = 200e-6;

}  // namespace

LossByClock::LossByClock(double rate_Hz, std::size_t block_samples)
    : rate_Hz_(rate_Hz),
      threshold_s_(std::max(kLeastThreshold_s,
                            kBlocksThreshold * static_cast<double>(block_samples) / rate_Hz)) {}

bool LossByClock::note(std::size_t samples, std::int64_t monotonic_ns) {
  if (!started_) {
    started_ = true;
    origin_ns_ = monotonic_ns;
    open_window(0.0);
    return false;
  }
  samples_ += static_cast<double>(samples);
  const double now_s = static_cast<double>(monotonic_ns - origin_ns_) * 1e-9;
  const double delay_s = now_s - samples_ / rate_Hz_;
  double& least = now_s < window_start_s_ + kWindow_s / 2 ? least_early_s_ : least_late_s_;
  least = std::min(least, delay_s);
  if (now_s < window_start_s_ + kWindow_s) {
    return false;
  }
  const bool lost = judge_window(now_s - window_start_s_);
  open_window(now_s);
  return lost;
}

void LossByClock::open_window(double now_s) {
  window_start_s_ = now_s;
  least_early_s_ = kNever;
  least_late_s_ = kNever;
}

bool LossByClock::judge_window(double length_s) {
  const bool stalled = least_early_s_ == kNever || least_late_s_ == kNever;
  const bool catching_up = least_late_s_ < least_early_s_ - threshold_s_ / 4;
  if (stalled || (catching_up && baseline_s_ != kNever && least_late_s_ > baseline_s_)) {
    return false;
  }
  const double least = std::min(least_early_s_, least_late_s_);
  if (least > baseline_s_ + threshold_s_) {
    baseline_s_ = least;
    return true;
  }
  baseline_s_ = std::min(least, baseline_s_ + kDrift * length_s);
  return false;
}

}  // namespace kolsky
