#include "processing/criticism/records/faint_pulse.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/pulse.hpp"

namespace kolsky {

bool stands_out_on_average(std::span<const double> record, std::size_t quiet) {
  constexpr std::size_t kQuietMeans = 8;
  // Of a deviation that is known by eight means: of fifty means of noise one is that far off once
  // in a thousand records.
  constexpr double kFarOut = 10.0;
  const std::size_t length = quiet / kQuietMeans;
  if (length == 0 || record.size() < quiet) {
    return false;
  }
  const Quiet before = quiet_before(record, quiet);
  double squares = 0.0;
  double farthest = 0.0;
  for (std::size_t n = 0; n + length <= record.size(); n += length) {
    double mean = 0.0;
    for (const double value : record.subspan(n, length)) {
      mean += (value - before.baseline) / static_cast<double>(length);
    }
    if (n + length <= quiet) {
      squares += mean * mean;
    } else {
      farthest = std::max(farthest, std::abs(mean));
    }
  }
  const double as_white = before.noise_rms / std::sqrt(static_cast<double>(length));
  const double sd = std::max(as_white, std::sqrt(squares / static_cast<double>(kQuietMeans - 1)));
  return sd > 0.0 && farthest > kFarOut * sd;
}

}  // namespace kolsky
