#include "processing/criticism/fitting/band_transforms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "processing/criticism/noise/response_end.hpp"

namespace kolsky {

BandTransforms::BandTransforms(const JudgedBand& band, double period_s)
    : band_(band),
      judged_period_s_(period_s * static_cast<double>(band.decimation)),
      whole_(band.transformed, period_s, kWrapDamping),
      decimated_(band.transformed / band.decimation, judged_period_s_, kWrapDamping),
      window_(DampedTransform::of_window(band.judged, judged_period_s_)),
      fine_(DampedTransform::of_window(band.judged * band.decimation, period_s)),
      record_(whole_.length()),
      residual_(decimated_.length()),
      fine_record_(fine_.length()),
      full_(whole_.bins()),
      carried_(decimated_.bins()),
      judged_(window_.bins()) {
  const double wc = 2.0 * std::numbers::pi * band.filter_Hz / std::pow(std::log(2.0), 0.25);
  const auto pass = [&](Complex s) {
    const Complex square = (s / wc) * (s / wc);
    return std::exp(-square * square);
  };
  const std::size_t first = band.lead / band.decimation + band.begin / band.decimation;
  const double start_s = static_cast<double>(first) * judged_period_s_;
  for (std::size_t k = 0; k < band.bins_carried; ++k) {
    const Complex s = path_.emplace_back(whole_.s(k));
    filter_.push_back(pass(s));
    filter_of_response_.push_back(filter_.back() * std::exp(-s * start_s));
  }
  for (std::size_t k = 1; k <= band.bins_judged; ++k) {
    judged_filter_.push_back(pass(window_.s(k)).real());
  }
}

void BandTransforms::transform(std::span<const double> record) {
  std::fill(record_.begin(), record_.end(), 0.0);
  std::copy(record.begin(), record.end(),
            record_.begin() + static_cast<std::ptrdiff_t>(band_.lead));
  whole_.forward(record_, full_);
}

void BandTransforms::carry(std::span<const double> record, Spectrum& out) {
  transform(record);
  out.resize(band_.bins_carried);
  // The inverse at the decimated rate divides by its own, smaller length.
  const double scale = 1.0 / static_cast<double>(band_.decimation);
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    out[k] = full_[k] * filter_[k] * scale;
  }
}

void BandTransforms::smooth(std::vector<double>& record) {
  transform(record);
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    full_[k] *= filter_[k];
  }
  whole_.inverse({full_.data(), band_.bins_carried}, record, band_.lead);
}

std::span<const double> BandTransforms::window_of(const Spectrum& carried) {
  std::copy(carried.begin(), carried.end(), carried_.begin());
  std::fill(carried_.begin() + static_cast<std::ptrdiff_t>(carried.size()), carried_.end(), 0.0);
  decimated_.inverse(carried_, residual_);
  const std::size_t first = (band_.lead + band_.begin) / band_.decimation;
  return std::span<const double>(residual_).subspan(first, band_.judged);
}

void BandTransforms::judge(const Spectrum& carried, Spectrum& out) {
  judge(window_of(carried), out);
}

void BandTransforms::judge(std::span<const double> window, Spectrum& out) {
  window_.forward(window, judged_);
  out.resize(band_.bins_judged);
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    out[k] = judged_[k + 1] / judged_filter_[k];
  }
}

std::vector<double> BandTransforms::judged_record(const Spectrum& carried) {
  const std::span<const double> window = window_of(carried);
  Spectrum bins;
  judge(window, bins);
  bins.insert(bins.begin(), std::accumulate(window.begin(), window.end(), 0.0));
  return window_with(bins);
}

std::vector<double> BandTransforms::window_with(const Spectrum& spectrum) {
  std::vector<double> record(band_.judged);
  window_.inverse(spectrum, record);
  return record;
}

std::span<const double> BandTransforms::fine_window_with(const Spectrum& spectrum) {
  fine_.inverse(spectrum, fine_record_);
  return fine_record_;
}

void BandTransforms::respond(const Spectrum& transfer, std::vector<double>& response) {
  const std::size_t before = band_.begin / band_.decimation;
  const std::size_t first = band_.lead / band_.decimation;
  std::fill(carried_.begin(), carried_.end(), 0.0);
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    carried_[k] = transfer[k] * filter_of_response_[k];
  }
  decimated_.inverse(carried_, residual_);
  const auto begin = residual_.begin() + static_cast<std::ptrdiff_t>(first);
  response.assign(begin, begin + static_cast<std::ptrdiff_t>(band_.judged + 2 * before));
  end_where_unresolved(response, path_.front().real() * judged_period_s_, first);
}

}  // namespace kolsky
