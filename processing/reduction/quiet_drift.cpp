#include "processing/reduction/quiet_drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "processing/reduction/formatted.hpp"
#include "processing/reduction/pulse.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kParts = 8;
constexpr std::size_t kFewest = 64;
constexpr double kOfLargest = 0.01;
/// Student's t of a straight line through eight means. White noise does as much once in ten
/// thousand records, noise that follows itself for a tenth of the quiet part once in a hundred.
constexpr double kBeyondDoubt = 8.0;

using Codes = std::span<const std::int32_t>;

/// Codes a sample, 0 where noise does as much. Slow noise shows in how far the parts' means lie
/// from the line, white noise within the parts.
double slope_of(std::span<const double> quiet) {
  const std::size_t count = quiet.size() / kParts;
  constexpr double kMiddle = (kParts - 1) / 2.0;
  std::array<double, kParts> means{};
  double within = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const Quiet own = quiet_before(quiet.subspan(part * count, count), count);
    means[part] = own.baseline;
    within += own.noise_rms * own.noise_rms / static_cast<double>(kParts * count);
  }
  const double level = std::accumulate(means.begin(), means.end(), 0.0) / kParts;
  double product = 0.0;
  double squares = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const double away = static_cast<double>(part) - kMiddle;
    product += away * means[part];
    squares += away * away;
  }
  const double slope = product / squares;  // a part
  double left = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const double line = level + slope * (static_cast<double>(part) - kMiddle);
    left += std::pow(means[part] - line, 2) / (kParts - 2);
  }
  const double sd = std::sqrt(std::max(left, within) / squares);
  return std::abs(slope) > kBeyondDoubt * sd ? slope / static_cast<double>(count) : 0.0;
}

/// Largest reading of the histories' time, from the level before the pulse.
double largest(Codes codes, double level) {
  double most = 0.0;
  for (const std::int32_t code : codes) {
    most = std::max(most, std::abs(static_cast<double>(code) - level));
  }
  return most;
}

}  // namespace

std::optional<Check> quiet_drift(const Shot& shot, std::size_t quiet, std::size_t end) {
  end = std::min(end, shot.samples());
  if (quiet < kFewest || end <= quiet) {
    return std::nullopt;
  }
  const double way = static_cast<double>(end) - static_cast<double>(quiet) / 2.0;
  const std::size_t gauges = std::min(shot.channels.size(), shot.bench.gauges.size());
  double worst = kOfLargest;
  const ChannelRecord* moves = nullptr;
  for (std::size_t i = 0; i < gauges; ++i) {
    const Codes codes = shot.channels[i].codes;
    const std::vector<double> before(codes.begin(),
                                     codes.begin() + static_cast<std::ptrdiff_t>(quiet));
    const double slope = slope_of(before);
    if (slope == 0.0) {
      continue;
    }
    const double most =
        largest(codes.subspan(quiet, end - quiet), quiet_before(before, quiet).baseline);
    const double share = std::abs(slope) * way / most;
    if (share > worst) {
      worst = share;
      moves = &shot.channels[i];
    }
  }
  if (moves == nullptr) {
    return std::nullopt;
  }
  Check check{.name = "drift",
              .value = worst,
              .limit = kOfLargest,
              .unit = "1",
              .verdict = Verdict::warn,
              .text = {}};
  check.text = moves->gauge +
               formatted(
                   " moves before the pulse already; if it goes on so it is off by %.2g %% of its "
                   "largest reading at the end: hum, an amplifier that has not settled or a gauge "
                   "that warms up, which no interval here has in it",
                   100.0 * worst);
  return check;
}

}  // namespace kolsky
