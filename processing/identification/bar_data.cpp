#include "processing/identification/bar_data.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/identification/bar_judge.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/gauge_sign.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

namespace {

/// Beyond this multiple of the low-pass's limit exp(-(w/wc)^4) is below 1e-12.
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
constexpr std::size_t kFewestJudged = 64;
/// In c / a. From about 0.3 on surface gauges see next to nothing of the first mode, and higher
/// modes propagate soon after.
constexpr double kFirstModeAlone = 0.25;
/// A combination of shots tells something where gauge 0 shows more than this many times its noise's
/// power: half of that is the pulses' then.
constexpr double kTelling = 2.0;

std::size_t longest(const std::vector<BarRecords>& shots) {
  std::size_t samples = 0;
  for (const BarRecords& shot : shots) {
    samples = std::max(samples, shot.strain.front().size());
  }
  return samples;
}

/// A wave that a gauge reads with the other sign than the others, in every shot and far out of its
/// noise in one, is no wave of the bar: what a pulse hardly out of its noise does is by chance.
void require_one_sense(const Bench& bench, const std::vector<BarRecords>& shots) {
  const bool loading_pulls = bench.loading == PositiveSense::tension;
  const std::size_t gauges = shots.front().pulls.size();
  std::vector<std::string> odd;
  for (std::size_t j = 0; j < gauges; ++j) {
    const bool always = std::ranges::all_of(
        shots, [&](const BarRecords& shot) { return shot.pulls[j] != loading_pulls; });
    const bool clear = std::ranges::any_of(
        shots, [&](const BarRecords& shot) { return shot.peak[j] > kFarOut * shot.noise_rms[j]; });
    if (always && clear) {
      odd.push_back(bench.gauges[shots.front().channel[j]].name);
    }
  }
  if (!odd.empty() && odd.size() < gauges) {
    throw InputError("gauges", other_sign_text(odd, bench.loading, false),
                     "correct the bench file, or check the leads");
  }
}

std::vector<BarRecords> read_all(const std::vector<Shot>& shots, const FirstPass& first,
                                 Bench& bench) {
  std::vector<BarRecords> records;
  for (const Shot& shot : shots) {
    if (shot.rate != shots.front().rate || shot.bench_toml != shots.front().bench_toml) {
      throw InputError("capture " + shot.id, "is of another bench or rate than " + shots.front().id,
                       "identify a bar from shots on one bench");
    }
    try {
      records.push_back(read_bar_records(shot));
    } catch (const InputError& error) {
      throw error.inside("capture " + shot.id);
    }
  }
  require_one_sense(bench, records);
  if (bench.gauges.size() == 1) {
    split_passes(bench, records, first);
  }
  return records;
}

/// Speed of the first pulse from the first gauge to the last.
double rough_speed_m_per_s(const BarRecords& records) {
  const double span_m = records.position_m.back() - records.position_m.front();
  const double time_s = records.rise_s.back() - records.rise_s.front();
  return time_s > 0.0 ? span_m / time_s : 0.0;
}

/// Spectra of records, low-passed.
class LowPassed {
 public:
  /// @param transform  outlives this
  LowPassed(DampedTransform& transform, double limit_Hz, std::size_t lead, std::size_t bins)
      : transform_(transform),
        lead_(static_cast<std::ptrdiff_t>(lead)),
        bins_(bins),
        filter_(transform.bins(), 1.0),
        padded_(transform.length()) {
    BandLimit(transform, 16).apply(limit_Hz, filter_);
  }

  [[nodiscard]] BarData::Spectrum spectrum_of(std::span<const double> record) {
    std::fill(padded_.begin(), padded_.end(), 0.0);
    std::copy(record.begin(), record.end(), padded_.begin() + lead_);
    BarData::Spectrum spectrum(bins_);
    transform_.forward(padded_, spectrum);
    for (std::size_t k = 0; k < bins_; ++k) {
      spectrum[k] *= filter_[k];
    }
    return spectrum;
  }

 private:
  DampedTransform& transform_;
  std::ptrdiff_t lead_;
  std::size_t bins_;
  BarData::Spectrum filter_;
  std::vector<double> padded_;
};

/// Records of noise, cut from others twice as long.
class DrawnNoise {
 public:
  explicit DrawnNoise(std::size_t samples)
      : samples_(samples), transform_(2 * samples, 1.0, 1.0), spectrum_(transform_.bins()) {}

  /// @param least  power that it has at least
  [[nodiscard]] std::vector<double> record(const NoiseSpectrum& noise, double least,
                                           std::size_t quiet) {
    const auto length = static_cast<double>(transform_.length());
    for (std::size_t k = 0; k < spectrum_.size(); ++k) {
      const double power = std::max(noise.power(static_cast<double>(k) / length), least);
      const double sd = std::sqrt(0.5 * power * length);
      spectrum_[k] = {sd * normal_(random_), sd * normal_(random_)};
    }
    std::vector<double> record(samples_);
    transform_.inverse(spectrum_, record);
    const double baseline =
        std::accumulate(record.begin(), record.begin() + static_cast<std::ptrdiff_t>(quiet), 0.0) /
        static_cast<double>(quiet);
    for (double& value : record) {
      value -= baseline;
    }
    return record;
  }

 private:
  std::size_t samples_;
  DampedTransform transform_;
  BarData::Spectrum spectrum_;
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

}  // namespace

BarData::BarData(const std::vector<Shot>& shots, double band_limit_Hz, const FirstPass& first)
    : bench_(shots.front().bench),
      records_(read_all(shots, first, bench_)),
      lead_(static_cast<std::size_t>(std::ceil(kLead_s * shots.front().rate.Hz()))),
      transform_(longest(records_) + 2 * lead_, shots.front().rate.period_s()) {
  choose_band(band_limit_Hz);
  choose_judged_part();
  choose_judged_bins();
  for (std::size_t j = 0; j < gauges(); ++j) {
    noise_.spectra.emplace_back(quiet_of(j));
  }
  weigh(noise_);
  prepare_spectra();
}

void BarData::choose_band(double asked_Hz) {
  BandLimit band(transform_, transform_.length());
  const double nyquist_Hz = 0.5 / records_.front().period_s;
  if (asked_Hz > nyquist_Hz / kFilterOverBand) {
    throw InputError("band limit",
                     "of " + in_words(asked_Hz, "Hz") + " is too near to half the sampling rate",
                     "give at most " + in_words(nyquist_Hz / kFilterOverBand, "Hz"));
  }
  band_limit_Hz_ = asked_Hz;
  if (asked_Hz <= 0.0) {
    for (const BarRecords& records : records_) {
      band_limit_Hz_ = std::max(band_limit_Hz_,
                                band.from_noise(records.strain.front(), records.noise_rms.front()));
    }
    const double speed = rough_speed_m_per_s(records_.front());
    if (speed > 0.0) {
      band_limit_Hz_ =
          std::min(band_limit_Hz_, kFirstModeAlone * speed / bench_.input.dispersion_radius_m());
    }
  }
  filter_limit_Hz_ = kFilterOverBand * band_limit_Hz_;
  const auto carried =
      static_cast<std::size_t>(kFilteredFrom * filter_limit_Hz_ / transform_.bin_width_Hz()) + 1;
  for (std::size_t k = 0; k < std::min(carried, transform_.bins()); ++k) {
    path_.push_back(transform_.s(k));
  }
}

/// Away from the records' cut ends, by as many samples of the lower rate as make a good transform.
void BarData::choose_judged_part() {
  const double period_s = records_.front().period_s;
  const double duration_s = static_cast<double>(transform_.length()) * period_s;
  const std::size_t slow_length =
      std::min(good_transform_length(2 * path_.size()), transform_.length());
  std::size_t shortest = transform_.length();
  for (const BarRecords& records : records_) {
    shortest = std::min(shortest, records.strain.front().size());
  }
  const double per_sample = static_cast<double>(slow_length) /
                            static_cast<double>(transform_.length());  // of the lower rate
  const double edge = kEdge / 2.0 * BandLimit::smear_s(filter_limit_Hz_) / period_s;
  const auto lead = static_cast<double>(lead_);
  places_.samples = slow_length;
  places_.period_s = duration_s / static_cast<double>(slow_length);
  places_.samples_per_place = 1.0 / per_sample;
  places_.records_begin = lead * per_sample;
  places_.quiet_end = (lead + static_cast<double>(records_.front().quiet_samples)) * per_sample;
  places_.records_end = (lead + static_cast<double>(shortest)) * per_sample;
  const double begin = lead + std::max(edge, quiet_to_skip(edge));
  places_.judged_begin = static_cast<std::size_t>(std::ceil(begin * per_sample));
  const double last = (lead + static_cast<double>(shortest) - 1.0 - edge) * per_sample;
  const double room = last - static_cast<double>(places_.judged_begin);
  if (room < static_cast<double>(kFewestJudged)) {
    throw InputError("samples", "are too few for a band of " + in_words(band_limit_Hz_, "Hz"),
                     "give longer records");
  }
  auto judged = static_cast<std::size_t>(room) / 2 * 2;
  while (good_transform_length(judged) != judged) {
    judged -= 2;
  }
  places_.judged_end = places_.judged_begin + judged;
}

void BarData::choose_judged_bins() {
  const DampedTransform plain(places_.judged(), places_.period_s, 1.0);
  const auto bins =
      std::min(plain.bins() - 1, static_cast<std::size_t>(band_limit_Hz_ / plain.bin_width_Hz()));
  if (bins < 2) {
    throw InputError("band limit", "of " + in_words(band_limit_Hz_, "Hz") + " leaves no frequency",
                     "give a wider band or a longer record");
  }
  BandLimit band(plain, 16);
  Spectrum filter(plain.bins(), 1.0);
  band.apply(filter_limit_Hz_, filter);
  for (std::size_t k = 1; k <= bins; ++k) {
    judged_path_.push_back(plain.s(k));
    undo_filter_.push_back(1.0 / filter[k].real());
  }
}

/// Noise of the first gauge reaches the others by way of the model only after a wave's travel: what
/// is judged begins after that, as far as the pulse allows, so that the noise judged is steady.
double BarData::quiet_to_skip(double edge) const {
  double skip = 1e300;
  for (const BarRecords& records : records_) {
    const double travel_s = 1.1 * (records.rise_s.back() - records.rise_s.front());
    const double latest = (records.foot_s / records.period_s) - edge;
    skip = std::min({skip, travel_s / records.period_s + edge, latest});
  }
  return skip;
}

double BarData::least_noise(std::size_t gauge) const {
  double step = 0.0;
  for (const BarRecords& records : records_) {
    step = std::max(step, records.step[gauge]);
  }
  return step * step / 12.0;
}

std::vector<std::span<const double>> BarData::quiet_of(std::size_t gauge) const {
  std::vector<std::span<const double>> quiet;
  for (const BarRecords& records : records_) {
    quiet.push_back(records.quiet(gauge));
  }
  return quiet;
}

BarNoise BarData::noise_with(const std::vector<NoiseSpectrum::Seen>& seen) const {
  std::vector<std::vector<std::span<const double>>> quiet;
  for (std::size_t j = 0; j < gauges(); ++j) {
    quiet.push_back(quiet_of(j));
  }
  BarNoise noise;
  noise.spectra = NoiseSpectrum::of_gauges(quiet, seen);
  weigh(noise);
  return noise;
}

void BarData::weigh(BarNoise& noise) const {
  const double period_s = records_.front().period_s;
  for (std::size_t j = 0; j < gauges(); ++j) {
    const NoiseSpectrum& spectrum = noise.spectra[j];
    const double floor = least_noise(j);
    auto& power = noise.power.emplace_back();
    for (const Complex s : judged_path_) {
      const double cycles = s.imag() / (2.0 * std::numbers::pi) * period_s;
      power.push_back(std::max(spectrum.power(cycles), floor) * power_of_unit());
    }
    auto& of_mean = noise.variance_of_baseline.emplace_back();
    for (const BarRecords& records : records_) {
      const auto quiet_samples = static_cast<double>(records.quiet_samples);
      const double least = records.stays_at_a_code(j) ? floor : floor / quiet_samples;
      of_mean.push_back(std::max(spectrum.variance_of_mean(records.quiet_samples), least));
    }
  }
}

void BarData::prepare_spectra() {
  LowPassed filtered(transform_, filter_limit_Hz_, lead_, path_.size());
  BarJudge judge(*this);
  for (const BarRecords& records : records_) {
    auto& of_shot = spectra_.emplace_back();
    auto& judged_of_shot = judged_.emplace_back();
    for (const auto& strain : records.strain) {
      of_shot.push_back(filtered.spectrum_of(strain));
      judge.judge(of_shot.back(), judged_of_shot.emplace_back(judged_path_.size()));
    }
  }
  combine_shots();
  unit_offset_ =
      filtered.spectrum_of(std::vector<double>(records_.front().strain.front().size(), 1.0));
  unit_impulse_ = filtered.spectrum_of(std::vector<double>{1.0});
}

std::vector<BarData::Spectra> BarData::noise_alone(const BarNoise& noise, std::size_t count) const {
  DampedTransform transform(transform_.length(), records_.front().period_s);
  LowPassed filtered(transform, filter_limit_Hz_, lead_, path_.size());
  BarJudge judge(*this);
  const BarRecords& like = records_.front();
  DrawnNoise drawn(like.strain.front().size());
  std::vector<Spectra> list(count);
  for (Spectra& shot : list) {
    for (std::size_t j = 0; j < gauges(); ++j) {
      const std::vector<double> record =
          drawn.record(noise.spectra[j], least_noise(j), like.quiet_samples);
      shot.damped.push_back(filtered.spectrum_of(record));
      judge.judge(shot.damped.back(), shot.judged.emplace_back(judged_path_.size()));
    }
  }
  return list;
}

/// Weights are the shots' shares in what gauge 0's records have in common, strongest first: by
/// principal components, as far as there is more of the pulses in them than of noise.
void BarData::combine_shots() {
  const auto count = static_cast<Eigen::Index>(shots());
  Eigen::MatrixXd common(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b) {
      double sum = 0.0;
      for (std::size_t k = 0; k < judged_path_.size(); ++k) {
        sum += (judged_[static_cast<std::size_t>(a)][0][k] *
                std::conj(judged_[static_cast<std::size_t>(b)][0][k]))
                   .real() /
               noise_.power[0][k];
      }
      common(a, b) = common(b, a) = sum;
    }
  }
  const SymmetricEigen parts(common);
  const auto noise_alone = static_cast<double>(judged_path_.size());
  combine(parts.eigenvectors().col(count - 1));
  for (Eigen::Index part = count - 2; part >= 0; --part) {
    if (parts.eigenvalues()[part] > kTelling * noise_alone) {
      combine(parts.eigenvectors().col(part));
    }
  }
}

void BarData::combine(const Eigen::VectorXd& weights) {
  const auto combined = [&](const std::vector<std::vector<Spectrum>>& of_shots) {
    std::vector<Spectrum> sums(gauges(), Spectrum(of_shots.front().front().size()));
    for (std::size_t shot = 0; shot < shots(); ++shot) {
      for (std::size_t j = 0; j < gauges(); ++j) {
        for (std::size_t k = 0; k < sums[j].size(); ++k) {
          sums[j][k] += weights[static_cast<Eigen::Index>(shot)] * of_shots[shot][j][k];
        }
      }
    }
    return sums;
  };
  spectra_.push_back(combined(spectra_));
  judged_.push_back(combined(judged_));
}

}  // namespace kolsky
