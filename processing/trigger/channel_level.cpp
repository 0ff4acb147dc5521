#include "processing/trigger/channel_level.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

ChannelLevel::ChannelLevel(const TriggerOptions& options)
    : level_sigma_(options.level_sigma),
      memory_samples_(static_cast<double>(options.noise_memory_samples)),
      minimum_noise_codes_(options.minimum_noise_codes),
      learn_samples_(static_cast<double>(options.learn_samples)) {}

void ChannelLevel::forget() noexcept {
  samples_ = 0.0;
  unusual_samples_ = 0.0;
  baseline_codes_ = 0.0;
  variance_codes2_ = 0.0;
}

double ChannelLevel::noise_codes() const noexcept {
  return std::max(minimum_noise_codes_, std::sqrt(variance_codes2_));
}

bool ChannelLevel::usual(const RunStatistics& run) const noexcept {
  const double reach = level_sigma_ * noise_codes();
  return run.minimum >= baseline_codes_ - reach && run.maximum <= baseline_codes_ + reach;
}

void ChannelLevel::take(const RunStatistics& run) noexcept {
  if (run.count < 2) {  // one sample tells nothing of the noise
    return;
  }
  const auto count = static_cast<double>(run.count);
  if (learned() && !usual(run)) {
    unusual_samples_ += count;
    if (unusual_samples_ < memory_samples_) {
      return;
    }
    forget();
  }
  unusual_samples_ = 0.0;
  samples_ = std::min(samples_ + count, std::max(memory_samples_, count));
  const double gain = count / samples_;
  const double mean = run.sum / count;
  const double variance = (run.sum_of_squares - run.sum * mean) / (count - 1.0);
  baseline_codes_ += gain * (mean - baseline_codes_);
  variance_codes2_ += gain * (std::max(0.0, variance) - variance_codes2_);
}

}  // namespace kolsky
