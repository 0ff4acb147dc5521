#include "processing/models/record_map.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

constexpr std::size_t kPlaces = 513;
constexpr double kRange = 2.0;           ///< of the largest reading
constexpr double kFlattest = 1e-3;       ///< slopes below it are taken as this
constexpr double kImaginaryStep = 1e-9;  ///< of the range

struct InverseTable {
  std::vector<double> strain;
  std::vector<double> reading;
  std::vector<double> slope;  ///< d strain / d reading

  InverseTable(const RecordMap& map, double range) {
    std::vector<std::complex<double>> at(kPlaces);
    std::vector<std::complex<double>> value(kPlaces);
    const double h = kImaginaryStep * range;
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const double x = range * (2.0 * static_cast<double>(i) / (kPlaces - 1) - 1.0);
      at[i] = {x, h};
    }
    map(at, value);
    // Records are levelled before the pulse: what the map makes of no strain is gone from them.
    const double none = value[kPlaces / 2].real();
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const double mapped = (value[i] - none).real();
      const double y = std::isfinite(mapped) ? mapped : at[i].real();
      const double rise = value[i].imag() / h;
      strain.push_back(at[i].real());
      // A map that falls somewhere has no inverse there: the table goes on rising.
      reading.push_back(
          i == 0 ? y : std::max(y, reading.back() + kFlattest * (strain[i] - strain[i - 1])));
      slope.push_back(1.0 / (std::isfinite(rise) ? std::max(rise, kFlattest) : 1.0));
    }
  }

  [[nodiscard]] double at(double y) const {
    if (y <= reading.front()) {
      return strain.front() + (y - reading.front()) * slope.front();
    }
    if (y >= reading.back()) {
      return strain.back() + (y - reading.back()) * slope.back();
    }
    const auto above = std::upper_bound(reading.begin(), reading.end(), y);
    const auto i = static_cast<std::size_t>(above - reading.begin()) - 1;
    const double width = reading[i + 1] - reading[i];
    const double t = (y - reading[i]) / width;
    const double rest = 1.0 - t;
    return strain[i] * (1.0 + 2.0 * t) * rest * rest + strain[i + 1] * (1.0 + 2.0 * rest) * t * t +
           width * t * rest * (slope[i] * rest - slope[i + 1] * t);
  }
};

}  // namespace

void undo(const RecordMap& map, std::vector<double>& record) {
  double largest = 0.0;
  for (const double y : record) {
    largest = std::max(largest, std::abs(y));
  }
  if (largest == 0.0 || !std::isfinite(largest)) {
    return;
  }
  const InverseTable table(map, kRange * largest);
  for (double& y : record) {
    y = table.at(y);
  }
}

}  // namespace kolsky
