#include <algorithm>
#include <cmath>

#include "processing/identification/followed_phase.hpp"
#include "processing/identification/spectrum_gathering.hpp"

namespace kolsky {

namespace {

/// Of each record what lies before the far end's return, all as long as the shortest, each from
/// its own front.
class Windows {
 public:
  explicit Windows(const BarData& data) : data_(data) {
    const BarRecords& first = data.records().front();
    const double speed = (first.position_m.back() - first.position_m.front()) /
                         (first.rise_s.back() - first.rise_s.front());
    double shortest_s = 1e300;
    for (std::size_t j = 0; j < data.gauges(); ++j) {
      constexpr double kBefore = 0.98;
      const double to_return_s = 2.0 * (data.bench().input.length_m - first.position_m[j]) / speed;
      shortest_s = std::min(shortest_s, to_return_s * kBefore);
      for (const BarRecords& records : data.records()) {
        const double left = static_cast<double>(records.strain[j].size()) * records.period_s -
                            records.foot_s - records.rise_behind_first_s(j);
        shortest_s = std::min(shortest_s, left);
      }
    }
    samples_ = static_cast<std::size_t>(std::max(0.0, shortest_s / first.period_s));
  }

  [[nodiscard]] std::size_t end(std::size_t shot, std::size_t gauge) const {
    const BarRecords& records = data_.records()[shot];
    return samples_ +
           static_cast<std::size_t>(records.rise_behind_first_s(gauge) / records.period_s);
  }

  /// Whether every pulse has gone where its window ends.
  [[nodiscard]] bool hold_the_pulses() const {
    constexpr double kGone = 0.05;  // of the peak, on average over the end of what is used
    const std::size_t tail = std::max<std::size_t>(1, samples_ / 10);
    for (std::size_t shot = 0; shot < data_.shots(); ++shot) {
      const BarRecords& records = data_.records()[shot];
      for (std::size_t j = 0; j < data_.gauges(); ++j) {
        const std::size_t last =
            std::min(begin_of(records) + end(shot, j), records.strain[j].size());
        double mean = 0.0;
        for (std::size_t n = last - std::min(last, tail); n < last; ++n) {
          mean += records.strain[j][n] / static_cast<double>(tail);
        }
        if (std::abs(mean) > kGone * records.peak[j]) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  const BarData& data_;
  std::size_t samples_ = 0;
};

/// Straight lines over position through what gauges read of one shot, frequency by frequency.
class StraightLines {
 public:
  StraightLines(const BarData& data, const DampedBand& band, std::size_t shot)
      : data_(data),
        band_(band),
        spectra_(band.spectra[shot]),
        records_(data.records()[shot]),
        phase_(data.gauges()) {
    for (const double x : data.records().front().position_m) {
      sum_x_ += x;
      sum_xx_ += x * x;
    }
  }

  struct Line {
    Complex gamma;
    double variance = 0.0;
  };
  /// In the order of the frequencies: phases are unwrapped from one to the next.
  [[nodiscard]] Line at(std::size_t k) {
    const auto power = powers_at(data_, band_, k);
    const auto gauges = static_cast<double>(data_.gauges());
    const double spread = gauges * sum_xx_ - sum_x_ * sum_x_;
    Line line;
    for (std::size_t j = 0; j < data_.gauges(); ++j) {
      const double share = (sum_x_ - gauges * records_.position_m[j]) / spread;
      line.gamma += share * log_of(j, k, power);
      line.variance += share * share * variance_of(j, k, power);
    }
    return line;
  }

 private:
  /// Of a logarithm's parts.
  [[nodiscard]] double variance_of(std::size_t j, std::size_t k,
                                   const std::vector<double>& power) const {
    return 0.5 * power[j] / std::norm(spectra_[j][k]);
  }

  /// Of what gauge j reads over gauge 0. Less the delay, its phase is small at low frequencies and
  /// moves slowly.
  Complex log_of(std::size_t j, std::size_t k, const std::vector<double>& power) {
    const Complex delay = band_.path[k] * records_.rise_behind_first_s(j);
    const Complex turned = spectra_[j][k] / spectra_[0][k] * std::exp(delay);
    const double variance = variance_of(j, k, power) + variance_of(0, k, power);
    const double phase = phase_[j].at_next(std::arg(turned), variance);
    return Complex(std::log(std::abs(turned)), phase) - delay -
           band_.path[k] * records_.late_of_s(j);
  }

  const BarData& data_;
  const DampedBand& band_;
  const std::vector<std::vector<Complex>>& spectra_;
  const BarRecords& records_;
  std::vector<FollowedPhase> phase_;  ///< by gauge
  double sum_x_ = 0.0;
  double sum_xx_ = 0.0;
};

}  // namespace

BarSpectrum straight_line_spectrum(const BarData& data, const BarFit& fit) {
  constexpr double kLeftAtEnd = 0.1;
  const Windows windows(data);
  if (!windows.hold_the_pulses()) {
    return {};
  }
  const DampedBand band =
      damped_band(data, windows.end(0, data.gauges() - 1), kLeftAtEnd, 2.0,
                  [&](std::size_t shot, std::size_t j) { return windows.end(shot, j); });
  BarFit elementary = fit;
  elementary.theory = WaveTheory::elementary;
  const BarModel model(data.bench(), data.records().front(),
                       {WaveTheory::elementary, fit.solid, fit.far_end});
  SpectrumGathering gathering(data, elementary, model, band);
  for (std::size_t shot = 0; shot < data.shots(); ++shot) {
    StraightLines lines(data, band, shot);
    for (std::size_t k = 0; k < band.path.size(); ++k) {
      const Complex s = band.path[k];
      const auto [gamma, variance] = lines.at(k);
      const Complex J = gamma * gamma / (data.bench().input.density_kg_m3.value * s * s);
      gathering.add(
          shot, {std::log(J / gathering.fitted_off_axis(k)), variance * 4.0 / std::norm(gamma)});
    }
  }
  return gathering.spectrum(1.0);
}

}  // namespace kolsky
