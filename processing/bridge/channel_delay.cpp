#include "processing/bridge/channel_delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <vector>

namespace kolsky {

namespace {

constexpr std::size_t kReach = 16;  // samples to either side
using Taps = std::array<double, 2 * kReach>;

/// Kaiser's window; its Bessel functions come with the standard library.
double window_at(double place) {
  constexpr double kBeta = 8.0;
  const double inside = 1.0 - place * place;
  return inside > 0.0 ? std::cyl_bessel_i(0.0, kBeta * std::sqrt(inside)) : 0.0;
}

/// What to weigh samples 1 - kReach to kReach with, for the value a fraction behind sample 0.
Taps interpolating(double fraction) {
  Taps taps{};
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const double away = static_cast<double>(i) - static_cast<double>(kReach - 1) - fraction;
    const double turn = std::numbers::pi * away;
    const double sinc = turn == 0.0 ? 1.0 : std::sin(turn) / turn;
    taps[i] = sinc * window_at(away / static_cast<double>(kReach));
  }
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  for (double& tap : taps) {
    tap /= sum;
  }
  return taps;
}

}  // namespace

void take_out_delay(double delay_s, double sample_rate_Hz, std::span<double> record) {
  const double delay = delay_s * sample_rate_Hz;
  if (delay == 0.0 || record.empty()) {
    return;
  }
  const double whole = std::floor(delay);
  const Taps taps = interpolating(delay - whole);
  const auto last = static_cast<std::ptrdiff_t>(record.size()) - 1;
  const auto first = static_cast<std::ptrdiff_t>(whole) + 1 - static_cast<std::ptrdiff_t>(kReach);
  std::vector<double> late(record.size() + taps.size());
  for (std::size_t n = 0; n < late.size(); ++n) {
    const std::ptrdiff_t at = first + static_cast<std::ptrdiff_t>(n);
    late[n] = record[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))];
  }
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] = std::inner_product(taps.begin(), taps.end(),
                                   late.begin() + static_cast<std::ptrdiff_t>(n), 0.0);
  }
}

}  // namespace kolsky
