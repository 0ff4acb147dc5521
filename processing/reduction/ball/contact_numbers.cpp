#include "processing/reduction/ball/contact_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/reduction/pulse.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

double mean_of(std::span<const double> values) {
  return values.empty() ? 0.0
                        : std::accumulate(values.begin(), values.end(), 0.0) /
                              static_cast<double>(values.size());
}

std::size_t index_of_largest(std::span<const double> values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

Stay stay_above(std::span<const double> force, std::size_t peak, double level) {
  Stay stay;
  std::size_t n = peak;
  while (n > 0 && force[n - 1] >= level) {
    --n;
  }
  stay.begin = static_cast<double>(n);
  if (n > 0) {
    stay.slopes[0] = force[n] - force[n - 1];
    stay.begin -= (force[n] - level) / stay.slopes[0];
  }
  n = peak;
  while (n + 1 < force.size() && force[n + 1] >= level) {
    ++n;
  }
  stay.end = static_cast<double>(n);
  stay.over = n + 1 < force.size();
  if (stay.over) {
    stay.slopes[1] = force[n] - force[n + 1];
    stay.end += (force[n] - level) / stay.slopes[1];
  }
  return stay;
}

ContactNumbers contact_numbers(std::span<const double> force_N, double interval_s,
                               double low_pass_Hz, double threshold) {
  // Room on either side for what the low-pass smears.
  const auto margin =
      static_cast<std::size_t>(std::ceil(4.0 * BandLimit::smear_s(low_pass_Hz) / interval_s)) + 8;
  std::vector<double> padded(force_N.size() + 2 * margin, 0.0);
  std::copy(force_N.begin(), force_N.end(), padded.begin() + static_cast<std::ptrdiff_t>(margin));
  // Undamped: the low-pass looks ahead, and what wraps round must not grow.
  DampedTransform transform(padded.size(), interval_s, 1.0);
  BandLimit band(transform, padded.size());
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(padded, spectrum);
  band.apply(low_pass_Hz, spectrum);
  transform.inverse(spectrum, padded);

  ContactNumbers numbers;
  const auto peak =
      static_cast<std::size_t>(std::max_element(padded.begin(), padded.end()) - padded.begin());
  std::size_t half = peak;
  while (half > 0 && padded[half] > padded[peak] / 2.0) {
    --half;
  }
  const Stay stay = stay_above(padded, peak, threshold * padded[peak]);
  const double foot = foot_of(padded, half, padded[peak], 0.0).index;
  numbers.foot_s = (foot - static_cast<double>(margin)) * interval_s;
  numbers.peak_force_N = padded[peak];
  numbers.contact_time_s = (stay.end - stay.begin) * interval_s;
  numbers.impulse_N_s = std::accumulate(padded.begin(), padded.end(), 0.0) * interval_s;
  numbers.force_N.assign(padded.begin() + static_cast<std::ptrdiff_t>(margin),
                         padded.end() - static_cast<std::ptrdiff_t>(margin));
  return numbers;
}

}  // namespace kolsky
