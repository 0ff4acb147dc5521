#include "processing/identification/noise_in_sums.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

NoiseInSums::NoiseInSums(const BarData& data, const BarNoise& noise,
                         const std::vector<std::vector<double>>& responses,
                         std::span<const double> own)
    : data_(data),
      noise_(noise),
      judged_(data.places().judged(), data.places().period_s, 1.0),
      whole_(quick_transform_length(2 * data.places().judged_end), data.places().period_s, 1.0),
      own_(spectrum_of(own)) {
  for (const auto& response : responses) {
    responses_.push_back(spectrum_of(response));
  }
}

BarData::Spectrum NoiseInSums::spectrum_of(std::span<const double> in_time) {
  BarData::Spectrum spectrum(whole_.bins());
  whole_.forward(in_time, spectrum);
  return spectrum;
}

/// What a sum multiplies each place of the residuals by.
BarData::Spectrum NoiseInSums::in_judged_part(const Eigen::VectorXcd& weights) {
  const BarData::Places& places = data_.places();
  BarData::Spectrum bins(judged_.bins());
  for (Eigen::Index k = 0; k < weights.size(); ++k) {
    const auto bin = static_cast<std::size_t>(k);
    bins[bin + 1] =
        weights[k] * (0.5 * static_cast<double>(judged_.length()) * data_.undo_filter(bin));
  }
  std::vector<double> in_time(places.judged_end);
  judged_.inverse(bins, std::span<double>(in_time).subspan(places.judged_begin));
  return spectrum_of(in_time);
}

/// Gauge 0 has no noise before its record, and what it has is less the mean of its quiet part.
BarData::Spectrum NoiseInSums::within_record(const BarData::Spectrum& spectrum) {
  const BarData::Places& places = data_.places();
  const auto begin = static_cast<std::size_t>(places.records_begin);
  std::vector<double> in_time(places.judged_end - begin);
  whole_.inverse(spectrum, in_time);
  double sum = 0.0;
  for (const double value : in_time) {
    sum += value;
  }
  const auto quiet = static_cast<std::size_t>(places.quiet_end - places.records_begin);
  for (std::size_t n = 0; n < std::min(quiet, in_time.size()); ++n) {
    in_time[n] -= sum / static_cast<double>(quiet);
  }
  return spectrum_of(in_time);
}

double NoiseInSums::power(std::size_t gauge, std::size_t bin) const {
  const double cycles = static_cast<double>(bin) /
                        (static_cast<double>(whole_.length()) * data_.places().samples_per_place);
  return std::max(noise_.spectra[gauge].power(cycles), data_.least_noise(gauge));
}

Eigen::MatrixXd NoiseInSums::covariance(const std::vector<Eigen::MatrixXcd>& weights) {
  const Eigen::Index sums = weights.front().cols();
  const std::size_t others = weights.size();
  // What each gauge's noise is multiplied by at each frequency, gauge 0's first.
  std::vector<std::vector<BarData::Spectrum>> through(others + 1);
  for (Eigen::Index a = 0; a < sums; ++a) {
    BarData::Spectrum by_first(whole_.bins());
    for (std::size_t j = 0; j < others; ++j) {
      BarData::Spectrum by_own = in_judged_part(weights[j].col(a));
      for (std::size_t k = 0; k < by_own.size(); ++k) {
        by_first[k] += std::conj(responses_[j][k]) * by_own[k];
        by_own[k] *= std::conj(own_[k]);
      }
      through[j + 1].push_back(std::move(by_own));
    }
    through[0].push_back(within_record(by_first));
  }
  // From places to the records' samples, and from sums over bins to the mean over frequencies.
  const double scale = data_.places().samples_per_place / static_cast<double>(whole_.length());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(sums, sums);
  Eigen::MatrixXcd at(sums, 1);
  for (std::size_t gauge = 0; gauge <= others; ++gauge) {
    for (std::size_t k = 0; k < whole_.bins(); ++k) {
      for (Eigen::Index a = 0; a < sums; ++a) {
        at(a, 0) = through[gauge][static_cast<std::size_t>(a)][k];
      }
      const bool alone = k == 0 || 2 * k == whole_.length();
      covariance += (alone ? 1.0 : 2.0) * scale * power(gauge, k) * (at * at.adjoint()).real();
    }
  }
  return covariance;
}

}  // namespace kolsky
