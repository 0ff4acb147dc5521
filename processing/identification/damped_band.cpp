#include "processing/identification/damped_band.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

std::size_t begin_of(const BarRecords& records) {
  return records.quiet_samples;
}

DampedBand damped_band(const BarData& data, std::size_t samples, double left_at_end,
                       double bin_width_over,
                       const std::function<std::size_t(std::size_t, std::size_t)>& end) {
  const double period_s = data.records().front().period_s;
  DampedBand band;
  band.period_s = period_s;
  const auto length = static_cast<std::size_t>(static_cast<double>(samples) * bin_width_over);
  DampedTransform transform(length, period_s, std::pow(left_at_end, bin_width_over));
  band.eta_per_s = transform.s(0).real();
  band.seconds = static_cast<double>(samples) * period_s;
  const auto bins = static_cast<std::size_t>(data.band_limit_Hz() / transform.bin_width_Hz());
  for (std::size_t k = 1; k <= bins && k < transform.bins(); ++k) {
    band.path.push_back(transform.s(k));
    band.frequency_Hz.push_back(static_cast<double>(k) * transform.bin_width_Hz());
  }
  std::vector<Complex> whole(transform.bins());
  for (std::size_t shot = 0; shot < data.shots(); ++shot) {
    const BarRecords& records = data.records()[shot];
    auto& of_shot = band.spectra.emplace_back();
    for (std::size_t j = 0; j < data.gauges(); ++j) {
      const std::size_t begin = begin_of(records);
      const std::size_t count =
          std::min({end(shot, j), records.strain[j].size() - begin, transform.length()});
      transform.forward(std::span<const double>(records.strain[j]).subspan(begin, count), whole);
      of_shot.emplace_back(whole.begin() + 1,
                           whole.begin() + 1 + static_cast<std::ptrdiff_t>(band.path.size()));
    }
  }
  return band;
}

std::vector<Complex> on_axis(const std::vector<Complex>& path) {
  std::vector<Complex> axis;
  for (const Complex s : path) {
    axis.emplace_back(0.0, s.imag());
  }
  return axis;
}

std::vector<double> powers_at(const BarData& data, const DampedBand& band, std::size_t k) {
  const auto& path = data.judged_path();
  const double width = path.front().imag() / (2.0 * std::numbers::pi);
  const auto bin = std::min(
      static_cast<std::size_t>(std::max(0.0, band.frequency_Hz[k] / width - 0.5)), path.size() - 1);
  const auto& places = data.places();
  const double judged_samples =
      static_cast<double>(places.judged_end - places.judged_begin) / places.samples_per_place;
  const double of_constant = 1.0 / std::norm(band.path[k] * band.period_s);
  std::vector<double> powers;
  for (std::size_t j = 0; j < data.gauges(); ++j) {
    const double baseline = data.noise().baseline_sd(0, j);
    powers.push_back(data.noise().power[j][bin] / judged_samples * band.samples_seen() +
                     baseline * baseline * of_constant);
  }
  return powers;
}

}  // namespace kolsky
