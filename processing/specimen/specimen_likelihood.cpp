#include "processing/specimen/specimen_likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/identification/noise_spectrum.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/specimen/slow_noise_factor.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

namespace {

/// Beyond this multiple of the filter's limit exp(-(w/wc)^4) is below 1e-12.
constexpr double kFilteredFrom = 2.5;
/// The filter passes half at this multiple of the highest frequency that is judged, and nearly all
/// below it.
constexpr double kFilterOverBand = 1.6;
/// What the filter smears over a cut end reaches this many of its 1/wc.
constexpr double kEdge = 16.0;
/// The covariance is dense: more frequencies than this cost more than they tell.
constexpr std::size_t kMostBins = 200;
constexpr std::size_t kFewestBins = 4;

/// The next length down that a transform takes as it is, without zeros after it.
std::size_t fast_length(std::size_t samples) {
  for (std::size_t n = samples - samples % 2; n > 16; n -= 2) {
    std::size_t left = n;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (left % factor == 0) {
        left /= factor;
      }
    }
    if (left == 1) {
      return n;
    }
  }
  return 0;
}

std::size_t shortest(const std::vector<ShpbRecords>& list) {
  std::size_t samples = std::numeric_limits<std::size_t>::max();
  for (const ShpbRecords& records : list) {
    samples = std::min(samples, records.strain.front().size());
  }
  return samples;
}

/// The frequency below which all but a ten-thousandth of a record's energy above its noise lies:
/// what is beyond costs time and tells nothing.
double telling_band_Hz(std::span<const double> record, double noise_rms, double period_s) {
  constexpr double kBeyond = 1e-4;
  DampedTransform transform(record.size(), period_s, 1.0);
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(record, spectrum);
  const double noise = noise_rms * noise_rms * static_cast<double>(record.size());
  double total = 0.0;
  for (Complex& value : spectrum) {
    value = std::max(0.0, std::norm(value) - 2.0 * noise);
    total += value.real();
  }
  double beyond = 0.0;
  std::size_t k = spectrum.size() - 1;
  while (k > 0 && beyond + spectrum[k].real() < kBeyond * total) {
    beyond += spectrum[k--].real();
  }
  return static_cast<double>(k + 1) * transform.bin_width_Hz();
}

/// A compliance times a constant.
class Scaled final : public Compliance {
 public:
  Scaled(const Compliance& of, double factor) : of_(of), factor_(factor) {}
  [[nodiscard]] Complex at(Complex s) const override { return factor_ * of_.at(s); }
  [[nodiscard]] double instantaneous() const override { return factor_ * of_.instantaneous(); }

 private:
  const Compliance& of_;
  double factor_;
};

}  // namespace

SpecimenLikelihood::SpecimenLikelihood(const std::vector<Shot>& shots, const BarPrior& bars,
                                       const SpecimenWindow& window)
    : bench_(shots.front().bench),
      bars_(bars),
      stations_(shpb_stations(bench_)),
      records_(read_shpb_records(shots, stations_)),
      unknowns_(shpb_unknowns(bench_, stations_, bars_)),
      period_s_(shots.front().rate.period_s()),
      after_foot_s_(window.after_foot_s),
      model_(stations_) {
  find_first_return();
  choose_band(window.band_limit_Hz);
  choose_judged();
  prepare_spectra();
  prepare_noise();
}

void SpecimenLikelihood::find_first_return() {
  const double speed_in =
      front_speed_m_per_s(bench_.input, *compliance_of(bench_.input, bars_.material));
  const double speed_out =
      front_speed_m_per_s(*bench_.output, *compliance_of(*bench_.output, bars_.material));
  double back_s = 2.0 * bench_.input.length_m / speed_in;
  if (bench_.output->far_end == FarEnd::free) {
    back_s = std::min(back_s, 2.0 * bench_.output->length_m / speed_out);
  }
  double seen_s = std::numeric_limits<double>::infinity();
  for (const ShpbStation& station : stations_) {
    seen_s = std::min(seen_s, station.to_specimen_m / (station.on_input ? speed_in : speed_out));
  }
  first_return_s_ = stations_.front().to_specimen_m / speed_in + back_s + seen_s;
}

/// The widest band in which some shot stands above the noise at every station.
void SpecimenLikelihood::choose_band(double asked_Hz) {
  const double rate_Hz = 1.0 / period_s_;
  if (asked_Hz > 0.0) {
    require_band_of_record(asked_Hz, rate_Hz);
  }
  band_limit_Hz_ = asked_Hz > 0.0 ? asked_Hz : rate_Hz;
  if (asked_Hz <= 0.0) {
    const std::size_t samples = shortest(records_);
    const DampedTransform whole(samples, period_s_);
    BandLimit band(whole, samples);
    for (std::size_t j = 0; j < stations_.size(); ++j) {
      double of_station_Hz = 0.0;
      for (const ShpbRecords& records : records_) {
        const double noise = quiet_before(records.strain[j], records.quiet_samples).noise_rms;
        const std::span<const double> pulse(records.strain[j].data(), samples);
        const double told_Hz = telling_band_Hz(pulse, noise, period_s_);
        of_station_Hz = std::max(of_station_Hz, std::min(band.from_noise(pulse, noise), told_Hz));
      }
      band_limit_Hz_ = std::min(band_limit_Hz_, of_station_Hz);
    }
  }
  band_limit_Hz_ = std::min(band_limit_Hz_, 0.5 * rate_Hz / kFilterOverBand / kFilteredFrom);
  filter_limit_Hz_ = kFilterOverBand * band_limit_Hz_;
  lead_ = static_cast<std::size_t>(
              std::ceil(kEdge / 2.0 * BandLimit::smear_s(filter_limit_Hz_) * rate_Hz)) +
          1;
}

void SpecimenLikelihood::choose_judged() {
  const std::size_t samples = shortest(records_);
  // Away from the cut ends, where the filter sees samples that are not there.
  const std::size_t last = samples > lead_ ? samples - lead_ : 0;
  std::size_t end = last;
  if (after_foot_s_ > 0.0) {
    double foot_s = std::numeric_limits<double>::infinity();
    for (const ShpbRecords& records : records_) {
      foot_s = std::min(foot_s, records.foot_s);
    }
    // The filter's kernel reaches ahead by a few of its 1/wc.
    const double until_s = foot_s + after_foot_s_ - 2.0 * BandLimit::smear_s(filter_limit_Hz_);
    end = std::min(last, static_cast<std::size_t>(std::max(0.0, until_s / period_s_)));
  }
  begin_ = std::min(lead_, records_.front().quiet_samples / 2);
  const auto most =
      static_cast<std::size_t>(static_cast<double>(kMostBins) / (band_limit_Hz_ * period_s_));
  end = std::min(end, begin_ + most);
  judged_ = fast_length(end > begin_ ? end - begin_ : 0);
  bins_ = static_cast<std::size_t>(band_limit_Hz_ * static_cast<double>(judged_) * period_s_);
  if (end <= records_.front().quiet_samples || bins_ < kFewestBins) {
    throw InputError("samples", "hold too little of the specimen's answer within the band",
                     "give longer records, a longer window or a wider band");
  }
}

void SpecimenLikelihood::prepare_spectra() {
  const std::size_t samples = shortest(records_);
  transform_.emplace(samples + 2 * lead_, period_s_);
  plain_.emplace(judged_, period_s_, 1.0);
  const auto carried = std::min(
      transform_->bins(),
      static_cast<std::size_t>(kFilteredFrom * filter_limit_Hz_ / transform_->bin_width_Hz()));
  for (std::size_t k = 0; k < carried; ++k) {
    path_.push_back(transform_->s(k));
  }
  BandLimit band(*transform_, 16);
  filter_damped_.assign(transform_->bins(), 1.0);
  band.apply(filter_limit_Hz_, filter_damped_);
  work_.resize(transform_->length());
  work_spectrum_.resize(transform_->bins());
  plain_spectrum_.resize(plain_->bins());
  for (const ShpbRecords& records : records_) {
    std::vector<Spectrum> of_shot;
    for (const auto& strain : records.strain) {
      std::fill(work_.begin(), work_.end(), 0.0);
      std::copy_n(strain.begin(), samples, work_.begin() + static_cast<std::ptrdiff_t>(lead_));
      Spectrum spectrum(carried);
      transform_->forward(work_, spectrum);
      for (std::size_t k = 0; k < carried; ++k) {
        spectrum[k] *= filter_damped_[k];
      }
      of_shot.push_back(std::move(spectrum));
    }
    spectra_.push_back(std::move(of_shot));
  }
  Spectrum ones(plain_->bins(), 1.0);
  BandLimit plain_band(*plain_, 16);
  plain_band.apply(filter_limit_Hz_, ones);
  bins_ = std::min(bins_, plain_->bins() - 1);
  for (std::size_t k = 0; k < bins_; ++k) {
    filter_.push_back(ones[k + 1].real());
  }
}

/// Each station's noise from the quiet part of all shots together.
void SpecimenLikelihood::prepare_noise() {
  for (std::size_t j = 0; j < stations_.size(); ++j) {
    std::vector<std::span<const double>> quiet;
    for (const ShpbRecords& records : records_) {
      quiet.emplace_back(records.strain[j].data(), records.quiet_samples);
    }
    const NoiseSpectrum noise(quiet);
    std::vector<double> power(bins_);
    std::vector<double> steady(bins_);
    for (std::size_t k = 0; k < bins_; ++k) {
      const double cycles = static_cast<double>(k + 1) / static_cast<double>(plain_->length());
      power[k] = steady[k] = noise.power(cycles);
      for (const NoiseSpectrum::SlowPart& part : noise.slow_parts()) {
        steady[k] = std::max(0.0, steady[k] - part.power(cycles));
      }
    }
    if (power.front() <= 0.0) {
      throw InputError("gauge " + bench_.gauges[stations_[j].channels.front()].name,
                       "has no noise before the pulse, so nothing says how far to trust it",
                       "give the records as they were digitised");
    }
    noise_.push_back(std::move(power));
    steady_.push_back(std::move(steady));
    slow_.push_back(noise.slow_parts());
  }
  for (std::size_t j = 1; j < stations_.size(); ++j) {
    own_noise_.push_back(of_own_noise(j));
  }
}

/// Samples of noise that are taken together: nothing within the band changes over them.
std::size_t SpecimenLikelihood::noise_group() const {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(0.5 / (kFilteredFrom * filter_limit_Hz_ * period_s_)));
}

/// Of a station's residuals, by its own noise within the judged window.
Eigen::MatrixXd SpecimenLikelihood::of_own_noise(std::size_t station) const {
  const auto size = static_cast<Eigen::Index>(2 * bins_);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  if (!slow_[station].empty()) {
    const std::size_t group = noise_group();
    Eigen::MatrixXd response(size, static_cast<Eigen::Index>(judged_ / group));
    for (Eigen::Index k = 0; k < size / 2; ++k) {
      const double angle = -2.0 * std::numbers::pi * static_cast<double>((k + 1) * group) /
                           static_cast<double>(plain_->length());
      for (Eigen::Index i = 0; i < response.cols(); ++i) {
        const Complex seen = std::polar(static_cast<double>(group), angle * static_cast<double>(i));
        response(2 * k, i) = seen.real();
        response(2 * k + 1, i) = seen.imag();
      }
    }
    for (const NoiseSpectrum::SlowPart& part : slow_[station]) {
      covariance.selfadjointView<Eigen::Lower>().rankUpdate(
          by_slow_noise(response, part, static_cast<double>(group)));
    }
  }
  for (Eigen::Index k = 0; k < size; ++k) {
    covariance(k, k) +=
        steady_[station][static_cast<std::size_t>(k / 2)] * static_cast<double>(judged_) / 2.0;
  }
  return covariance;
}

void SpecimenLikelihood::judged_part(const Spectrum& of_first, const Spectrum* own,
                                     const Spectrum& first) {
  std::fill(work_spectrum_.begin(), work_spectrum_.end(), 0.0);
  for (std::size_t k = 0; k < path_.size(); ++k) {
    work_spectrum_[k] = -of_first[k] * first[k];
    if (own != nullptr) {
      work_spectrum_[k] += (*own)[k];
    }
  }
  transform_->inverse(work_spectrum_, work_);
}

void SpecimenLikelihood::residuals(const ShpbTheory& theory, const Compliance& specimen,
                                   std::span<const double> moves, Eigen::MatrixXd& out) {
  const MovedShpb moved(bench_, stations_, bars_, unknowns_, moves);
  model_.evaluate(theory, moved, specimen, path_, 0, transfers_);
  out.resize(static_cast<Eigen::Index>(residuals_per_shot()),
             static_cast<Eigen::Index>(records_.size()));
  for (std::size_t shot = 0; shot < records_.size(); ++shot) {
    double* next = out.col(static_cast<Eigen::Index>(shot)).data();
    for (std::size_t j = 1; j < stations_.size(); ++j) {
      const Spectrum& own = spectra_[shot][j];
      const Spectrum& first = spectra_[shot][0];
      judged_part(transfers_[j - 1], &own, first);
      plain_->forward(std::span<const double>(work_).subspan(lead_ + begin_, judged_),
                      plain_spectrum_);
      for (std::size_t k = 0; k < bins_; ++k) {
        *next++ = plain_spectrum_[k + 1].real() / filter_[k];
        *next++ = plain_spectrum_[k + 1].imag() / filter_[k];
      }
    }
  }
}

/// What a unit of the first station's noise, baseline taken off, does to the residuals of another:
/// residuals of that station x groups of noise samples, of one sample of a group.
Eigen::MatrixXd SpecimenLikelihood::noise_response(const Spectrum& transfer) {
  std::fill(work_spectrum_.begin(), work_spectrum_.end(), 0.0);
  const double lead_s = static_cast<double>(lead_) * period_s_;
  for (std::size_t k = 0; k < path_.size(); ++k) {
    work_spectrum_[k] = transfer[k] * filter_damped_[k] * std::exp(-path_[k] * lead_s);
  }
  transform_->inverse(work_spectrum_, work_);  // the kernel; time zero at `lead_`
  const std::size_t samples = std::min(shortest(records_), begin_ + judged_ + lead_);
  const std::size_t group = noise_group();
  const std::size_t groups = (samples + group - 1) / group;
  Eigen::MatrixXd response(static_cast<Eigen::Index>(2 * bins_), static_cast<Eigen::Index>(groups));
  // Noise sample n reaches judged samples m in [begin, begin + judged) through kernel[m - n].
  std::vector<Complex> sums(lead_ + samples + judged_ + 1);
  for (std::size_t k = 0; k < bins_; ++k) {
    const double w =
        2.0 * std::numbers::pi * static_cast<double>(k + 1) / static_cast<double>(plain_->length());
    const auto kernel_end = static_cast<std::ptrdiff_t>(lead_ + samples);
    const Complex turn = std::polar(1.0, -w);
    Complex phase = std::polar(1.0, w * static_cast<double>(lead_));
    Complex sum = 0.0;
    for (std::ptrdiff_t u = 0; u < kernel_end; ++u) {
      sums[static_cast<std::size_t>(u)] = sum;
      sum += work_[static_cast<std::size_t>(u)] * phase;
      phase *= turn;
    }
    sums[static_cast<std::size_t>(kernel_end)] = sum;
    const auto sum_before = [&](std::ptrdiff_t u) {
      const std::ptrdiff_t at = u + static_cast<std::ptrdiff_t>(lead_);
      return sums[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, kernel_end))];
    };
    Complex all = 0.0;
    const auto row = static_cast<Eigen::Index>(2 * k);
    for (std::size_t i = 0; i < groups; ++i) {
      const auto n = static_cast<std::ptrdiff_t>(i * group + group / 2);
      const auto from = static_cast<std::ptrdiff_t>(begin_) - n;
      const Complex reached =
          sum_before(from + static_cast<std::ptrdiff_t>(judged_)) - sum_before(from);
      const Complex value = reached * std::polar(1.0, w * static_cast<double>(from)) / filter_[k];
      all += value * static_cast<double>(group);
      response(row, static_cast<Eigen::Index>(i)) = value.real();
      response(row + 1, static_cast<Eigen::Index>(i)) = value.imag();
    }
    const Complex of_quiet_mean = all / static_cast<double>(records_.front().quiet_samples);
    const std::size_t quiet_groups = std::min(groups, records_.front().quiet_samples / group);
    for (std::size_t i = 0; i < quiet_groups; ++i) {
      response(row, static_cast<Eigen::Index>(i)) -= of_quiet_mean.real();
      response(row + 1, static_cast<Eigen::Index>(i)) -= of_quiet_mean.imag();
    }
  }
  return response;
}

void SpecimenLikelihood::add_first_stations_noise(const Eigen::MatrixXd& response,
                                                  Eigen::MatrixXd& covariance) const {
  const auto group = static_cast<double>(noise_group());
  for (const NoiseSpectrum::SlowPart& part : slow_[0]) {
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(
        by_slow_noise(response * group, part, group));
  }
  Eigen::VectorXd scale(response.rows());
  for (Eigen::Index row = 0; row < response.rows(); ++row) {
    const auto bin = static_cast<std::size_t>(row % static_cast<Eigen::Index>(2 * bins_)) / 2;
    scale[row] = std::sqrt(steady_[0][bin] * group);
  }
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(scale.asDiagonal() * response);
}

Eigen::MatrixXd SpecimenLikelihood::covariance_root(const ShpbTheory& theory,
                                                    const Compliance& specimen,
                                                    std::span<const double> moves) {
  const MovedShpb moved(bench_, stations_, bars_, unknowns_, moves);
  model_.evaluate(theory, moved, specimen, path_, 0, transfers_);
  const auto per_station = static_cast<Eigen::Index>(2 * bins_);
  const auto others = static_cast<Eigen::Index>(stations_.size() - 1);
  Eigen::MatrixXd response;
  for (Eigen::Index j = 0; j < others; ++j) {
    const Eigen::MatrixXd of_station = noise_response(transfers_[static_cast<std::size_t>(j)]);
    if (j == 0) {
      response.resize(per_station * others, of_station.cols());
    }
    response.middleRows(j * per_station, per_station) = of_station;
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(response.rows(), response.rows());
  add_first_stations_noise(response, covariance);
  for (Eigen::Index j = 0; j < others; ++j) {
    covariance.block(j * per_station, j * per_station, per_station, per_station) +=
        own_noise_[static_cast<std::size_t>(j)];
  }
  return covariance.selfadjointView<Eigen::Lower>().llt().matrixL();
}

std::vector<std::vector<SpecimenLikelihood::ComplianceStep>> SpecimenLikelihood::compliance_steps(
    const ShpbTheory& theory, const Compliance& specimen, std::span<const double> moves) {
  constexpr double kDamping = 1e-2;  // over the window
  constexpr double kStep = 1e-4;
  const MovedShpb moved(bench_, stations_, bars_, unknowns_, moves);
  std::vector<Spectrum> slope;
  std::vector<Spectrum> below;
  model_.evaluate(theory, moved, Scaled(specimen, 1.0 - kStep), path_, 0, below);
  model_.evaluate(theory, moved, Scaled(specimen, 1.0 + kStep), path_, 0, slope);
  for (std::size_t j = 0; j < slope.size(); ++j) {
    for (std::size_t k = 0; k < path_.size(); ++k) {
      slope[j][k] = -(slope[j][k] - below[j][k]) / (2.0 * kStep);
    }
  }
  model_.evaluate(theory, moved, specimen, path_, 0, transfers_);

  DampedTransform line(judged_, period_s_, kDamping);
  std::vector<Complex> path(bins_);
  double effective = 0.0;  // samples that count, of stationary noise under the damping
  const double eta = line.s(0).real();
  for (std::size_t n = 0; n < judged_; ++n) {
    effective += std::exp(-2.0 * eta * period_s_ * static_cast<double>(n));
  }
  for (std::size_t k = 0; k < bins_; ++k) {
    path[k] = line.s(k + 1);
  }
  std::vector<Spectrum> on_line;
  model_.evaluate(theory, moved, specimen, path, 1, on_line);

  std::vector<std::vector<ComplianceStep>> steps;
  Spectrum left(line.bins());
  Spectrum by_J(line.bins());
  for (std::size_t shot = 0; shot < records_.size(); ++shot) {
    std::vector<Complex> numerator(bins_, 0.0);
    std::vector<double> weight(bins_, 0.0);
    for (std::size_t j = 1; j < stations_.size(); ++j) {
      const auto judged = [&] {
        return std::span<const double>(work_).subspan(lead_ + begin_, judged_);
      };
      judged_part(transfers_[j - 1], &spectra_[shot][j], spectra_[shot][0]);
      line.forward(judged(), left);
      judged_part(slope[j - 1], nullptr, spectra_[shot][0]);
      line.forward(judged(), by_J);
      for (std::size_t k = 0; k < bins_; ++k) {
        // Both spectra have been through the same filter.
        const double filtered = filter_[k] * filter_[k];
        const double noise =
            filtered * effective * (noise_[j][k] + noise_[0][k] * std::norm(on_line[j - 1][k]));
        numerator[k] += std::conj(by_J[k + 1]) * left[k + 1] / noise;
        weight[k] += std::norm(by_J[k + 1]) / noise;
      }
    }
    std::vector<ComplianceStep> of_shot(bins_);
    for (std::size_t k = 0; k < bins_; ++k) {
      of_shot[k] = {path[k].imag() / (2.0 * std::numbers::pi), numerator[k] / weight[k],
                    std::sqrt(0.5 / weight[k])};
    }
    steps.push_back(std::move(of_shot));
  }
  return steps;
}

}  // namespace kolsky
