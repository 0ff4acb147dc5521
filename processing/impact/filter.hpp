#pragma once

#include <span>
#include <vector>

namespace kolsky::impact {

/// Deviation in time of the Gaussian weights that have -3 dB at `cutoff_Hz`.
[[nodiscard]] double low_pass_sigma_s(double cutoff_Hz);
/// Low-pass without delay: Gaussian weights, -3 dB at `cutoff_Hz`, renormalised at the ends.
[[nodiscard]] std::vector<double> low_passed(std::span<const double> values, double interval_s,
                                             double cutoff_Hz);

/// Time derivative of the mean over a sliding window: [f(t + w/2) - f(t - w/2)]/w, that is the rate
/// averaged over `window_s`. Shorter windows at the ends.
[[nodiscard]] std::vector<double> mean_rate(std::span<const double> values, double interval_s,
                                            double window_s);

/// Histories of an impact at another interval, all as long as these two make them.
/// Means over the intervals round their times, of such means (the first interval begins half way
/// through it): their sum times the interval stays.
[[nodiscard]] std::vector<double> means_at(std::span<const double> means, double interval_s,
                                           double wanted_s);
/// Values between those known; the last one holds.
[[nodiscard]] std::vector<double> values_at(std::span<const double> values, double interval_s,
                                            double wanted_s);

}  // namespace kolsky::impact
