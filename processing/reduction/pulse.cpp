#include "processing/reduction/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

/// The record's beginning, taken as quiet until the pulse has been found.
constexpr std::size_t kFirstLook = 32;
/// Where that holds no quiet, down to so many.
constexpr std::size_t kShortestLook = 8;

double largest_excursion(std::span<const double> record, double baseline) {
  double largest = 0.0;
  for (const double value : record) {
    largest = std::max(largest, std::abs(value - baseline));
  }
  return largest;
}

/// Time of the upward passage of `level` that is nearest before `from`, and the slope there per
/// sample.
struct Crossing {
  double index;
  double slope;
};

Crossing crossing_before(std::span<const double> record, std::size_t from, double level) {
  std::size_t n = from;
  while (n > 0 && record[n] >= level) {
    --n;
  }
  const double rise = record[n + 1] - record[n];
  const double share = rise > 0.0 ? std::clamp((level - record[n]) / rise, 0.0, 1.0) : 0.5;
  return {static_cast<double>(n) + share, rise};
}

/// The first pulse, with the noise of so many samples at the record's beginning.
std::optional<Rise> pulse_after(std::span<const double> record, std::size_t look, std::size_t width,
                                std::size_t reach, double least_share) {
  const Quiet start = quiet_before(record, look);
  const double level =
      std::max(6.0 * start.noise_rms, least_share * largest_excursion(record, start.baseline));
  if (level <= 0.0) {
    return std::nullopt;
  }
  std::size_t run = 0;
  std::size_t n = 0;
  double sense = 1.0;
  for (; n < record.size() && run < width; ++n) {
    const double deviation = record[n] - start.baseline;
    const bool outside = std::abs(deviation) > level;
    if (outside && run == 0) {
      sense = deviation > 0.0 ? 1.0 : -1.0;
    }
    run = outside && deviation * sense > 0.0 ? run + 1 : 0;
  }
  if (run < width) {
    return std::nullopt;
  }
  const std::size_t first = n - run;
  const std::size_t end = std::min(record.size(), first + reach);
  double peak = 0.0;
  for (std::size_t i = first; i < end; ++i) {
    peak = std::max(peak, (record[i] - start.baseline) * sense);
  }
  std::size_t half = first;
  while (half + 1 < end && (record[half] - start.baseline) * sense < peak / 2.0) {
    ++half;
  }
  return Rise{half == 0 ? 0 : half - 1, sense};
}

}  // namespace

Quiet quiet_before(std::span<const double> record, std::size_t end) {
  Quiet quiet;
  quiet.samples = std::min(end, record.size());
  if (quiet.samples == 0) {
    return quiet;
  }
  // Deviations from the first sample: a large offset must not cost the noise its digits.
  const double reference = record[0];
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t n = 0; n < quiet.samples; ++n) {
    const double deviation = record[n] - reference;
    sum += deviation;
    squares += deviation * deviation;
  }
  const auto count = static_cast<double>(quiet.samples);
  const double mean = sum / count;
  quiet.baseline = reference + mean;
  quiet.noise_rms = std::sqrt(std::max(0.0, squares / count - mean * mean));
  return quiet;
}

std::optional<Rise> find_first_pulse(std::span<const double> record, std::size_t width,
                                     std::size_t reach, double least_share) {
  if (record.size() < kFirstLook + width) {
    return std::nullopt;
  }
  const std::size_t longest = std::max(kFirstLook, record.size() / 100);
  if (auto rise = pulse_after(record, longest, width, reach, least_share)) {
    return rise;
  }
  // The look held the pulse itself where that comes early, as in slowly sampled records.
  for (std::size_t look = kFirstLook / 2; look >= kShortestLook; look /= 2) {
    auto rise = pulse_after(record, look, width, reach, least_share);
    if (rise && rise->index >= look) {
      return rise;
    }
  }
  return std::nullopt;
}

Rise rise_after_foot(std::span<const double> record, double foot, std::size_t reach,
                     double rate_Hz) {
  constexpr double kLeastShare = 0.2;
  const auto size = static_cast<double>(record.size());
  if (!(foot >= 0.0 && foot < size)) {
    throw InputError("arrival_s", in_words(foot / rate_Hz, "s") + " is off the record",
                     "give the foot of the pulse, from 0 to " + in_words(size / rate_Hz, "s"));
  }
  const auto begin = static_cast<std::size_t>(foot);
  const double baseline = begin > 0 ? quiet_before(record, begin).baseline : record.front();
  const auto farther = [&](double a, double b) {
    return std::abs(a - baseline) < std::abs(b - baseline);
  };
  const auto near = record.subspan(begin, std::min(reach, record.size() - begin));
  const double peak = *std::max_element(near.begin(), near.end(), farther) - baseline;
  const double largest = *std::max_element(record.begin(), record.end(), farther) - baseline;
  if (std::abs(peak) < kLeastShare * std::abs(largest) || peak == 0.0) {
    throw InputError("arrival_s",
                     "no pulse rises within " +
                         in_words(static_cast<double>(near.size()) / rate_Hz, "s") + " after " +
                         in_words(foot / rate_Hz, "s"),
                     "give the foot of the pulse at the first gauge");
  }
  const double sense = peak < 0.0 ? -1.0 : 1.0;
  const auto risen = std::find_if(near.begin(), near.end(), [&](double value) {
    return sense * (value - baseline) >= std::abs(peak) / 2.0;
  });
  const auto at = begin + static_cast<std::size_t>(risen - near.begin());
  return {at > 0 ? at - 1 : 0, sense};
}

namespace {

/// As `foot_of`, from the times at which the rise passes this share of the peak, half and a quarter
/// of it. @param sigma  from the noise alone
Foot foot_by_levels(std::span<const double> record, std::size_t half, double highest,
                    double noise_rms) {
  const Crossing high = crossing_before(record, half, highest);
  const Crossing middle =
      crossing_before(record, static_cast<std::size_t>(high.index), 0.5 * highest);
  const Crossing low =
      crossing_before(record, static_cast<std::size_t>(middle.index), 0.25 * highest);
  const double lower = middle.index - low.index;
  const double upper = high.index - middle.index;
  // Distances from the foot grow by q = 2^(1/p) from level to level.
  const double q_of_cube = std::pow(2.0, 1.0 / 3.0);
  const double q = std::clamp(lower > 0.0 ? upper / lower : 2.0, q_of_cube, 2.0);
  const double lever = 1.0 / (q - 1.0);
  const double sigma_of_low = noise_rms / std::max(std::abs(low.slope), 1e-300);
  const double sigma_of_middle = noise_rms / std::max(std::abs(middle.slope), 1e-300);
  return {std::max(0.0, low.index - lower * lever),
          std::hypot((1.0 + lever) * sigma_of_low, lever * sigma_of_middle)};
}

}  // namespace

Foot foot_of(std::span<const double> record, std::size_t half, double peak, double noise_rms) {
  Foot foot = foot_by_levels(record, half, 0.4 * peak, noise_rms);
  const Foot nearer = foot_by_levels(record, half, 0.2 * peak, noise_rms);
  // What is off for the shape halves with the levels: both differ by half of it.
  foot.sigma = std::hypot(foot.sigma, 2.0 * (foot.index - nearer.index));
  return foot;
}

}  // namespace kolsky
