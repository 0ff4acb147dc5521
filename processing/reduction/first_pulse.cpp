#include "processing/reduction/first_pulse.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/reduction/pulse.hpp"

namespace kolsky {

namespace {

constexpr double kShortestPulse_s = 5e-6;
constexpr double kReach_s = 500e-6;
constexpr std::size_t kShortestPulse_samples = 3;

/// Where the record passes `level` between the sample below it and the next.
double passage(std::span<const double> record, std::size_t below, double level) {
  const double low = record[below];
  const double high = record[std::min(below + 1, record.size() - 1)];
  const double share = high > low ? (level - low) / (high - low) : 0.0;
  return static_cast<double>(below) + std::clamp(share, 0.0, 1.0);
}

}  // namespace

bool stands_far_out(std::span<const double> record, const FirstPulse& pulse) {
  return pulse.height > kFarOut * quiet_before(record, pulse.quiet).noise_rms;
}

std::size_t pulse_reach(double rate_Hz) {
  return static_cast<std::size_t>(kReach_s * rate_Hz);
}

std::optional<FirstPulse> first_pulse(std::span<const double> record, double rate_Hz) {
  const auto width = std::max(kShortestPulse_samples,
                              static_cast<std::size_t>(std::ceil(kShortestPulse_s * rate_Hz)));
  const std::size_t reach = pulse_reach(rate_Hz);
  const auto rise = find_first_pulse(record, width, reach);
  if (!rise) {
    return std::nullopt;
  }
  const double baseline = quiet_before(record, std::min(rise->index, kFewestQuiet)).baseline;
  std::vector<double> shifted(std::min(record.size(), rise->index + reach));
  for (std::size_t n = 0; n < shifted.size(); ++n) {
    shifted[n] = rise->sense * (record[n] - baseline);
  }
  FirstPulse pulse;
  pulse.rise = rise->index;
  pulse.sense = rise->sense;
  pulse.height =
      *std::max_element(shifted.begin() + static_cast<std::ptrdiff_t>(pulse.rise), shifted.end());
  pulse.half = passage(shifted, pulse.rise, 0.5 * pulse.height);
  pulse.foot = foot_of(shifted, pulse.rise, pulse.height, 0.0).index;
  pulse.quiet = static_cast<std::size_t>(std::max(0.0, pulse.foot - kFootClearance_s * rate_Hz));
  return pulse;
}

}  // namespace kolsky
