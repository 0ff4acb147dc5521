#include "processing/identification/bar_likelihood.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/identification/noise_spectrum.hpp"
#include "processing/reduction/band_limit.hpp"

namespace kolsky {

namespace {

/// Beyond this multiple of the band limit exp(-(w/wc)^4) is below 1e-12.
constexpr double kFilteredFrom = 2.5;
/// Zeros before and after each record, in time: the filter reaches to both sides, and what it
/// smears before the first sample would come round to the end of the transform, where undamping
/// raises it.
constexpr double kLead_s = 100e-6;
/// The filter passes half at this multiple of the highest frequency that is judged, and nearly all
/// below it.
constexpr double kFilterOverBand = 1.6;
/// What the filter smears over the cut ends of a record reaches this many of its 1/wc into it.
constexpr double kEdge = 16.0;

std::size_t longest(const std::vector<Shot>& shots) {
  std::size_t samples = 0;
  for (const Shot& shot : shots) {
    samples = std::max(samples, shot.samples());
  }
  return samples;
}

std::vector<BarRecords> read_all(const std::vector<Shot>& shots) {
  std::vector<BarRecords> records;
  for (const Shot& shot : shots) {
    if (shot.rate != shots.front().rate || shot.bench_toml != shots.front().bench_toml) {
      throw InputError("capture " + shot.id, "is of another bench or rate than " + shots.front().id,
                       "identify a bar from shots on one bench");
    }
    records.push_back(read_bar_records(shot));
  }
  return records;
}

}  // namespace

BarLikelihood::BarLikelihood(const std::vector<Shot>& shots, WaveTheory theory,
                             double band_limit_Hz)
    : theory_(theory),
      bench_(shots.front().bench),
      records_(read_all(shots)),
      unknowns_(known_unknowns(bench_, records_.front())),
      lead_(static_cast<std::size_t>(std::ceil(kLead_s * shots.front().rate.Hz()))),
      transform_(longest(shots) + 2 * lead_, shots.front().rate.period_s()),
      work_(transform_.length()) {
  for (std::size_t k = 0; k < transform_.bins(); ++k) {
    damped_path_.push_back(transform_.s(k));
  }
  choose_band(band_limit_Hz);
  prepare_noise();
  prepare_spectra();
}

std::size_t BarLikelihood::residuals() const {
  return 2 * bins_judged_ * (gauges() - 1) * records_.size();
}

/// The widest band in which some shot's pulse stands above the noise at its first gauge; the part
/// of the record that is judged, away from its cut ends.
void BarLikelihood::choose_band(double asked_Hz) {
  BandLimit band(transform_, transform_.length());
  band_limit_Hz_ = asked_Hz;
  if (asked_Hz <= 0.0) {
    for (const BarRecords& records : records_) {
      band_limit_Hz_ = std::max(band_limit_Hz_,
                                band.from_noise(records.strain.front(), records.noise_rms.front()));
    }
  }
  filter_limit_Hz_ = kFilterOverBand * band_limit_Hz_;
  const double rate_Hz = 1.0 / records_.front().period_s;
  edge_ =
      static_cast<std::size_t>(kEdge / 2.0 * BandLimit::smear_s(filter_limit_Hz_) * rate_Hz) + 1;
  std::size_t shortest = transform_.length();
  for (const BarRecords& records : records_) {
    shortest = std::min(shortest, records.strain.front().size());
  }
  constexpr std::size_t kFewestJudged = 64;
  if (shortest < 2 * edge_ + kFewestJudged) {
    throw InputError("samples", "are too few for the band", "give longer records");
  }
  judged_ = shortest - 2 * edge_;
  plain_.emplace(judged_, records_.front().period_s, 1.0);
  plain_spectrum_.resize(plain_->bins());
  for (std::size_t k = 1; k < plain_->bins(); ++k) {
    plain_path_.push_back(plain_->s(k));
  }
  bins_judged_ = std::min(plain_path_.size(),
                          static_cast<std::size_t>(band_limit_Hz_ / plain_->bin_width_Hz()));
  bins_carried_ = std::min(
      damped_path_.size(),
      static_cast<std::size_t>(kFilteredFrom * filter_limit_Hz_ / transform_.bin_width_Hz()));
  if (bins_judged_ == 0) {
    throw InputError("band limit", "leaves no frequency to judge",
                     "give a wider band or a longer record");
  }
}

/// Each gauge's noise from the quiet part of all shots together.
void BarLikelihood::prepare_noise() {
  for (std::size_t j = 0; j < gauges(); ++j) {
    std::vector<std::span<const double>> quiet;
    for (const BarRecords& records : records_) {
      quiet.emplace_back(records.strain[j].data(), records.quiet_samples);
    }
    const NoiseSpectrum noise(quiet);
    const auto samples = static_cast<double>(judged_);
    std::vector<double> power(bins_judged_);
    for (std::size_t k = 0; k < bins_judged_; ++k) {
      const double cycles = static_cast<double>(k + 1) / static_cast<double>(plain_->length());
      power[k] = noise.power(cycles) * samples;
    }
    noise_.push_back(std::move(power));
  }
}

void BarLikelihood::prepare_spectra() {
  BandLimit band(transform_, 16);
  for (const BarRecords& records : records_) {
    std::vector<Spectrum> of_shot;
    for (const auto& strain : records.strain) {
      Spectrum spectrum(transform_.bins());
      std::fill(work_.begin(), work_.end(), 0.0);
      std::copy(strain.begin(), strain.end(), work_.begin() + static_cast<std::ptrdiff_t>(lead_));
      transform_.forward(work_, spectrum);
      band.apply_half(filter_limit_Hz_, spectrum);
      band.apply_half(filter_limit_Hz_, spectrum);
      of_shot.push_back(std::move(spectrum));
    }
    spectra_.push_back(std::move(of_shot));
  }
  Spectrum ones(plain_->bins(), 1.0);
  BandLimit plain_band(*plain_, 16);
  plain_band.apply_half(filter_limit_Hz_, ones);
  plain_band.apply_half(filter_limit_Hz_, ones);
  for (std::size_t k = 0; k < bins_judged_; ++k) {
    filter_.push_back(ones[k + 1].real());
  }
}

std::vector<BarLikelihood::Spectrum> BarLikelihood::transfers(const MovedBench& moved,
                                                              const Compliance& compliance,
                                                              const std::vector<Complex>& path,
                                                              std::size_t count) const {
  const std::vector<Complex> needed(path.begin(),
                                    path.begin() + static_cast<std::ptrdiff_t>(count));
  const std::vector<BarMode> modes = bar_modes(theory_, moved.bar, compliance, needed);
  const double length_m = moved.bar.length_m;
  std::vector<Spectrum> list(gauges() - 1, Spectrum(count));
  const double x0 = moved.position_m[0];
  for (std::size_t k = 0; k < count; ++k) {
    const Complex gamma = modes[k].gamma;
    const Complex first = moved.gain[0] * (1.0 - std::exp(-2.0 * gamma * (length_m - x0)));
    for (std::size_t j = 1; j < gauges(); ++j) {
      const double x = moved.position_m[j];
      const Complex other = moved.gain[j] * (1.0 - std::exp(-2.0 * gamma * (length_m - x)));
      list[j - 1][k] = std::exp(-gamma * (x - x0)) * other / first;
    }
  }
  return list;
}

/// Spectrum of r_j on the imaginary axis, over the samples of the record.
void BarLikelihood::residual_spectrum(std::size_t shot, std::size_t gauge, const Spectrum& transfer,
                                      Spectrum& out) {
  const Spectrum& own = spectra_[shot][gauge];
  const Spectrum& first = spectra_[shot][0];
  for (std::size_t k = 0; k < bins_carried_; ++k) {
    out[k] = own[k] - transfer[k] * first[k];
  }
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(bins_carried_), out.end(), 0.0);
  transform_.inverse(out, work_);
  plain_->forward(std::span<const double>(work_).subspan(lead_ + edge_, judged_), plain_spectrum_);
  std::copy_n(plain_spectrum_.begin(), bins_judged_ + 1, out.begin());
}

/// By the Cholesky factor of the residuals' covariance at each frequency.
double* BarLikelihood::whiten(const std::vector<Spectrum>& residual,
                              const std::vector<Spectrum>& transfer, double* out) const {
  const auto others = static_cast<Eigen::Index>(gauges() - 1);
  Eigen::MatrixXcd covariance(others, others);
  Eigen::VectorXcd r(others);
  Eigen::VectorXcd g(others);
  for (std::size_t k = 0; k < bins_judged_; ++k) {
    for (Eigen::Index j = 0; j < others; ++j) {
      r[j] = residual[static_cast<std::size_t>(j)][k + 1] / filter_[k];
      g[j] = transfer[static_cast<std::size_t>(j)][k];
    }
    covariance = noise_[0][k] * g * g.adjoint();
    for (Eigen::Index j = 0; j < others; ++j) {
      covariance(j, j) += noise_[static_cast<std::size_t>(j) + 1][k];
    }
    Eigen::LLT<Eigen::MatrixXcd> factor(covariance);
    factor.matrixL().solveInPlace(r);
    for (Eigen::Index j = 0; j < others; ++j) {
      // Real and imaginary part each carry half of the power.
      *out++ = std::numbers::sqrt2 * r[j].real();
      *out++ = std::numbers::sqrt2 * r[j].imag();
    }
  }
  return out;
}

void BarLikelihood::evaluate(const Compliance& compliance, std::span<const double> moves,
                             std::span<double> out) {
  const MovedBench moved(bench_.input, records_.front(), unknowns_, moves);
  const auto carried = transfers(moved, compliance, damped_path_, bins_carried_);
  const auto judged = transfers(moved, compliance, plain_path_, bins_judged_);
  std::vector<Spectrum> residual(gauges() - 1, Spectrum(transform_.bins()));
  double* next = out.data();
  for (std::size_t shot = 0; shot < records_.size(); ++shot) {
    for (std::size_t j = 1; j < gauges(); ++j) {
      residual_spectrum(shot, j, carried[j - 1], residual[j - 1]);
    }
    next = whiten(residual, judged, next);
  }
}

}  // namespace kolsky
