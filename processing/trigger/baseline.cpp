#include "processing/trigger/baseline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kolsky {
namespace {

constexpr std::size_t kGroups = 8;
// The median of eight variances with some 30 degrees of freedom scatters like the mean of 0.6 as
// many.
constexpr double kMedianEfficiency = 0.6;
// A newly learned variance up to so many times the known one is the same noise, known less well.
constexpr double kSameNoise = 2.25;

// After so many memories the weights of the noise no longer change.
constexpr double kSettled = 8.0;

struct Group {
  double centre = 0.0;  ///< samples before the end of the stretch, negative
  double mean = 0.0;
  double variance = 0.0;
};

using Groups = std::array<Group, kGroups>;

template <std::size_t Size>
double median(std::array<double, Size> values) {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(Size - 1) / 2] + values[Size / 2]);
}

Groups group(std::span<const double> samples) {
  const std::size_t length = samples.size() / kGroups;
  Groups groups;
  for (std::size_t g = 0; g < kGroups; ++g) {
    const std::size_t end = samples.size() - (kGroups - 1 - g) * length;
    const auto part = samples.subspan(end - length, length);
    double sum = 0.0;
    for (const double sample : part) sum += sample;
    const double mean = sum / static_cast<double>(length);
    double squares = 0.0;
    for (const double sample : part) squares += (sample - mean) * (sample - mean);
    groups[g] = {static_cast<double>(end) - 0.5 * static_cast<double>(length + 1) -
                     static_cast<double>(samples.size()),
                 mean, squares / static_cast<double>(length - 1)};
  }
  return groups;
}

double median_slope(const Groups& groups) {
  std::array<double, kGroups*(kGroups - 1) / 2> slopes{};
  std::size_t next = 0;
  for (std::size_t a = 0; a < kGroups; ++a) {
    for (std::size_t b = a + 1; b < kGroups; ++b) {
      slopes[next++] = (groups[b].mean - groups[a].mean) / (groups[b].centre - groups[a].centre);
    }
  }
  return median(slopes);
}

// Mean square of the residuals without the two largest, raised to what a normal spread and the two
// fitted numbers take away.
double trimmed_square(std::array<double, kGroups> residuals) {
  constexpr double kTrimming = 3.3;
  for (double& residual : residuals) residual *= residual;
  std::sort(residuals.begin(), residuals.end());
  double sum = 0.0;
  for (std::size_t g = 0; g + 2 < kGroups; ++g) sum += residuals[g];
  return kTrimming * sum / static_cast<double>(kGroups - 2);
}

double square(double value) {
  return value * value;
}

double fade(const BaselineMemory& memory) {
  return 1.0 -
         1.0 / std::max(2.0, static_cast<double>(memory.baseline_samples) / BaselineTracker::kCell);
}

}  // namespace

QuietEstimate estimate_quiet(std::span<const double> samples) {
  const Groups groups = group(samples);
  const double slope = median_slope(groups);
  const double group_length = std::floor(static_cast<double>(samples.size()) / kGroups);

  std::array<double, kGroups> offsets{};
  std::array<double, kGroups> variances{};
  for (std::size_t g = 0; g < kGroups; ++g) {
    offsets[g] = groups[g].mean - slope * groups[g].centre;
    variances[g] = groups[g].variance;
  }
  const double offset = median(offsets);
  for (double& value : offsets) value -= offset;

  const double along_line = slope * slope * (group_length * group_length - 1.0) / 12.0;
  const double within = std::max(0.0, median(variances) - along_line);
  const double between = trimmed_square(offsets);
  const double slow = std::max(0.0, between - within / group_length);
  // A line through n points of variance v has, u lengths from its middle, v / n (1 + 12 u²); here u
  // = 1.
  const double extrapolation = 13.0 / kGroups;
  return {{offset, slope}, within + slow, extrapolation * std::max(between, within / group_length)};
}

BaselineTracker::BaselineTracker(const BaselineMemory& memory)
    : level_gain_(1.0 - square(fade(memory))),
      slope_gain_(square(1.0 - fade(memory))),
      noise_gain_(1.0 / std::max(1.0, static_cast<double>(memory.noise_samples) / kCell)),
      guard_(memory.guard_samples / kCell) {}

void BaselineTracker::start(const QuietEstimate& quiet, std::size_t samples) {
  guard_size_ = 0;
  const double half_cell = 0.5 * static_cast<double>(kCell + 1);
  slope_ = quiet.line.slope_codes * static_cast<double>(kCell);
  level_ = quiet.line.value_codes - quiet.line.slope_codes * half_cell;
  cells_ = static_cast<double>(samples) / static_cast<double>(kCell);
  baseline_variance_ = quiet.baseline_variance;
  // So short a stretch may by chance be calm; a lower noise is left to the memory.
  if (known() && quiet.noise_variance < kSameNoise * noise_variance_) return;
  noise_cells_ = cells_;
  noise_variance_ = quiet.noise_variance;
  noise_spread_ = 1.0 / (kMedianEfficiency * static_cast<double>(samples));
}

void BaselineTracker::forget() {
  guard_size_ = 0;
  noise_spread_ = 0.0;
  noise_variance_ = 0.0;
  baseline_variance_ = 0.0;
}

BaselineLine BaselineTracker::next_cell() const noexcept {
  const double slope = slope_ / static_cast<double>(kCell);
  const double middle = level_ + slope_ * static_cast<double>(guard_size_ + 1);
  return {middle - slope * 0.5 * static_cast<double>(kCell - 1), slope};
}

void BaselineTracker::take(double mean_codes, double variance_codes2) noexcept {
  const double slope = slope_ / static_cast<double>(kCell);
  const double along_line = slope * slope * (static_cast<double>(kCell * kCell) - 1.0) / 12.0;
  const double miss = mean_codes - (level_ + slope_ * static_cast<double>(guard_size_ + 1));
  push({true, mean_codes, std::max(0.0, variance_codes2 - along_line) + miss * miss, miss * miss});
}

void BaselineTracker::skip() noexcept {
  push({});
}

void BaselineTracker::push(const Cell& cell) noexcept {
  if (guard_.empty()) {
    absorb(cell);
    return;
  }
  if (guard_size_ == guard_.size()) {
    absorb(guard_[guard_start_]);
    guard_start_ = (guard_start_ + 1) % guard_.size();
    --guard_size_;
  }
  guard_[(guard_start_ + guard_size_) % guard_.size()] = cell;
  ++guard_size_;
}

void BaselineTracker::absorb(const Cell& cell) noexcept {
  level_ += slope_;
  if (!cell.quiet) return;
  // The gains of a plain fit to all cells so far fall as these grow more.
  const double all = (cells_ + 1.0) * (cells_ + 2.0);
  const double level_share = 2.0 * (2.0 * cells_ + 1.0);
  double level_gain = level_gain_;
  double slope_gain = slope_gain_;
  if (level_gain * all < level_share) level_gain = std::min(1.0, level_share / all);
  if (slope_gain * all < 6.0) slope_gain = std::min(1.0, 6.0 / all);
  const double miss = cell.mean - level_;
  level_ += level_gain * miss;
  slope_ += slope_gain * miss;
  cells_ += 1.0;
  absorb_noise(cell);
}

void BaselineTracker::absorb_noise(const Cell& cell) noexcept {
  noise_cells_ += 1.0;
  const double gain = noise_gain_ * noise_cells_ < 1.0 ? 1.0 / noise_cells_ : noise_gain_;
  noise_variance_ += gain * (cell.mean_square - noise_variance_);
  baseline_variance_ += gain * (cell.miss_square - baseline_variance_);
  if (noise_gain_ * noise_cells_ > kSettled) return;
  noise_spread_ = square(1.0 - gain) * noise_spread_ + square(gain) / static_cast<double>(kCell);
}

}  // namespace kolsky
