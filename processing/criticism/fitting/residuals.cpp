#include "processing/criticism/fitting/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "processing/criticism/fitting/known_departures.hpp"
#include "processing/criticism/fitting/specimen_response.hpp"
#include "processing/criticism/noise/carried_noise.hpp"
#include "processing/criticism/noise/response_end.hpp"
#include "processing/criticism/noise/small_factor.hpp"
#include "processing/reduction/pulse.hpp"

namespace kolsky {

struct WhiteResiduals::Workspace {
  DampedTransform whole;      ///< of records, at their rate
  DampedTransform decimated;  ///< the same bins, for residuals
  DampedTransform plain;      ///< of the judged window
  DampedTransform fine;       ///< the same window at the records' rate
  std::vector<double> record;
  std::vector<double> shaped;
  std::vector<double> residual;
  Spectrum full;
  Spectrum carried;
  Spectrum judged;
  Spectrum fine_spectrum;
  std::vector<double> fine_record;
  std::vector<Spectrum> records;               ///< of one shot where effects change them
  std::vector<Spectrum> residuals;             ///< one shot's, damped, by other gauge
  std::vector<Spectrum> rows;                  ///< the same, plain
  std::vector<std::vector<double>> responses;  ///< of other gauges to the reference's noise
  CarriedNoise::Memory carried_noise;          ///< through these responses
  std::vector<CarriedBin> bins;                ///< the same
  SpecimenResponse response;
  KnownDepartures departures;

  // Much of a fit moves what is added to records alone: how waves travel then stays as it was in
  // the evaluation before.
  std::vector<AppliedEffect> on_waves;  ///< that made scene and transfers, for a shot
  std::optional<std::size_t> shot;
  std::optional<Scene> scene;
  Ratios ratios;
  std::optional<std::vector<AppliedEffect>> on_noise;  ///< that made the whitener
  std::vector<Eigen::MatrixXcd> whitener;              ///< by bin
  std::vector<Eigen::MatrixXcd> cross;                 ///< P G^H by bin
  double leaked = 0.0;                                 ///< shares of a shot's, over all bins

  Workspace(const JudgedBand& band, double period_s, std::size_t shots)
      : whole(band.transformed, period_s, kWrapDamping),
        decimated(band.transformed / band.decimation,
                  period_s * static_cast<double>(band.decimation), kWrapDamping),
        plain(DampedTransform::of_window(band.judged,
                                         period_s * static_cast<double>(band.decimation))),
        fine(DampedTransform::of_window(band.judged * band.decimation, period_s)),
        record(whole.length()),
        residual(decimated.length()),
        full(whole.bins()),
        carried(decimated.bins()),
        judged(plain.bins()),
        fine_spectrum(fine.bins()),
        fine_record(fine.length()),
        departures(shots) {}
};

namespace {

/// A record's strain is that of a pulse from so many standard deviations of its noise on.
constexpr double kStandsOut = 4.0;

/// A shot as the others are on average.
ShotFacts mean_of(const std::vector<CampaignShot>& shots) {
  ShotFacts mean = shots.front().facts;
  const auto count = static_cast<double>(shots.size());
  double peak_strain = 0.0;
  double warmer_by_K = 0.0;
  for (const CampaignShot& shot : shots) {
    peak_strain += shot.facts.peak_strain / count;
    if (shot.facts.warmer_by_K) {
      warmer_by_K += *shot.facts.warmer_by_K / count;
    } else {
      mean.warmer_by_K.reset();
    }
  }
  mean.peak_strain = peak_strain;
  if (mean.warmer_by_K) {
    mean.warmer_by_K = warmer_by_K;
  }
  return mean;
}

/// One shot's effects: those on waves and those on what was made of their strain.
struct Effects {
  std::vector<AppliedEffect> on_waves;
  std::vector<AppliedEffect> on_records;

  Effects(const Composition& composition, const std::vector<double>& theta, std::size_t shot) {
    for (AppliedEffect& effect : composition.applied(theta, shot)) {
      auto& list = effect.effect->about().stage == Stage::record ? on_records : on_waves;
      list.push_back(std::move(effect));
    }
  }
};

}  // namespace

WhiteResiduals::~WhiteResiduals() = default;

WhiteResiduals::WhiteResiduals(const Campaign& campaign, double band_limit_Hz, std::size_t workers)
    : campaign_(campaign),
      band_(judged_band(campaign, band_limit_Hz)),
      noise_(campaign, band_),
      usual_(mean_of(campaign.shots)) {
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    if (j != campaign.reference) {
      others_.push_back(j);
    }
  }
  for (std::size_t w = 0; w < workers; ++w) {
    work_.push_back(std::make_unique<Workspace>(band_, campaign.period_s, campaign.shots.size()));
  }
  const Workspace& work = *work_.front();
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    damped_path_.push_back(work.whole.s(k));
  }
  for (std::size_t k = 1; k <= band_.bins_judged; ++k) {
    plain_path_.push_back(work.plain.s(k));
  }
  prepare_spectra();
  measure_signal();
}

std::size_t WhiteResiduals::per_shot() const {
  return 2 * band_.bins_judged * others_.size();
}

double WhiteResiduals::judged_period_s() const {
  return campaign_.period_s * static_cast<double>(band_.decimation);
}

double WhiteResiduals::judged_start_s(std::size_t shot) const {
  return static_cast<double>(band_.begin) * campaign_.period_s - campaign_.shots[shot].foot_s;
}

void WhiteResiduals::transform_record(Workspace& work, std::span<const double> record,
                                      Spectrum& out) const {
  std::fill(work.record.begin(), work.record.end(), 0.0);
  std::copy(record.begin(), record.end(),
            work.record.begin() + static_cast<std::ptrdiff_t>(band_.lead));
  work.whole.forward(work.record, work.full);
  out.resize(band_.bins_carried);
  // The inverse at the decimated rate divides by its own, smaller length.
  const double scale = 1.0 / static_cast<double>(band_.decimation);
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    out[k] = work.full[k] * damped_filter_[k] * scale;
  }
}

void WhiteResiduals::prepare_spectra() {
  const double wc = 2.0 * std::numbers::pi * band_.filter_Hz / std::pow(std::log(2.0), 0.25);
  const auto pass = [&](Complex s) {
    const Complex square = (s / wc) * (s / wc);
    return std::exp(-square * square);
  };
  const std::size_t before = band_.begin / band_.decimation;
  const std::size_t first = band_.lead / band_.decimation;
  const double start_s = static_cast<double>(first + before) * judged_period_s();
  for (const Complex s : damped_path_) {
    damped_filter_.push_back(pass(s));
    filter_of_response_.push_back(damped_filter_.back() * std::exp(-s * start_s));
  }
  for (const Complex s : plain_path_) {
    filter_.push_back(pass(s).real());
  }
  for (const CampaignShot& shot : campaign_.shots) {
    std::vector<Spectrum> of_shot(campaign_.gauges());
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      transform_record(*work_.front(), shot.strain[j], of_shot[j]);
    }
    spectra_.push_back(std::move(of_shot));
  }
}

/// Takes off what lies beyond the judged band: noise alone, by what a band is judged for.
void WhiteResiduals::smooth(Workspace& work, std::vector<double>& record) const {
  std::fill(work.record.begin(), work.record.end(), 0.0);
  std::copy(record.begin(), record.end(),
            work.record.begin() + static_cast<std::ptrdiff_t>(band_.lead));
  work.whole.forward(work.record, work.full);
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    work.full[k] *= damped_filter_[k];
  }
  work.whole.inverse({work.full.data(), band_.bins_carried}, record, band_.lead);
}

/// Undoes what effects say was done to the records after the strain was sensed.
void WhiteResiduals::shape_records(Workspace& work, const std::vector<AppliedEffect>& effects,
                                   std::size_t of_shot) const {
  const CampaignShot& shot = campaign_.shots[of_shot];
  Scene& scene = *work.scene;
  scene.facts = &shot.facts;
  RecordScene& record = scene.record;
  record = RecordScene{};
  record.additions.resize(campaign_.gauges());
  for (const AppliedEffect& effect : effects) {
    effect.effect->apply(scene, effect.values, effect.gauge);
  }
  work.records.resize(campaign_.gauges());
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    work.shaped = shot.strain[j];
    const auto& addition = record.additions[j];
    if (!addition.empty()) {
      const double before = quiet_before(addition, shot.quiet_samples).baseline;
      for (std::size_t n = 0; n < work.shaped.size(); ++n) {
        work.shaped[n] -= addition[n] - before;
      }
    }
    if (record.bends(j)) {
      // What was bent follows from the reading without its noise: bent straight with the signal,
      // noise would shrink under every b > 0, and any record would ask for some.
      std::vector<double> read = work.shaped;
      put_own_noise(work, of_shot, j);
      for (std::size_t n = 0; n < work.fine_record.size(); ++n) {
        read[band_.begin + n] -= work.fine_record[n];
      }
      smooth(work, read);
      std::vector<double> straight = read;
      record.straighten(j, straight);
      for (std::size_t n = 0; n < read.size(); ++n) {
        work.shaped[n] -= read[n] - straight[n];
      }
    }
    transform_record(work, work.shaped, work.records[j]);
  }
}

void WhiteResiduals::plain_spectrum(Workspace& work, const Spectrum& damped, Spectrum& out) const {
  std::copy(damped.begin(), damped.end(), work.carried.begin());
  std::fill(work.carried.begin() + static_cast<std::ptrdiff_t>(damped.size()), work.carried.end(),
            0.0);
  work.decimated.inverse(work.carried, work.residual);
  const std::size_t first = (band_.lead + band_.begin) / band_.decimation;
  work.plain.forward(std::span<const double>(work.residual).subspan(first, band_.judged),
                     work.judged);
  out.resize(band_.bins_judged);
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    out[k] = work.judged[k + 1] / filter_[k];
  }
}

WhiteResiduals::Ratios WhiteResiduals::ratios_of(const Scene& scene) const {
  const std::size_t reference = campaign_.reference;
  Ratios ratios{transfers_of(scene, reference), {}};
  Spectrum& own = ratios.reading[reference];
  if (scene.gauges[reference].length_m > 0.0) {
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      ratios.mean.push_back(mean_over_length(scene, reference, k));
    }
  }
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    const Complex mean = ratios.mean_at(k);
    const Complex seen = own[k] / mean;
    for (const std::size_t j : others_) {
      ratios.reading[j][k] /= seen;
    }
    own[k] = seen * invertible(mean);
  }
  return ratios;
}

/// What of the reference gauge's noise the other gauges' residuals hold, at the judged bins; then,
/// what the mean over a long reference gauge would hold of it; last, where that or what others
/// share of it asks for it, all of it.
void WhiteResiduals::carry_noise(Workspace& work, const Ratios& ratios) const {
  const std::size_t before = band_.begin / band_.decimation;
  const std::size_t first = band_.lead / band_.decimation;
  std::vector<const Spectrum*> filters;
  for (const std::size_t j : others_) {
    filters.push_back(&ratios.reading[j]);
  }
  const Spectrum all_of_it(band_.bins_carried, 1.0);
  if (!ratios.mean.empty()) {
    filters.push_back(&ratios.mean);
  }
  if (!ratios.mean.empty() || noise_.shared_with(campaign_.reference)) {
    filters.push_back(&all_of_it);
  }
  work.responses.resize(filters.size());
  std::fill(work.carried.begin(), work.carried.end(), 0.0);
  for (std::size_t i = 0; i < filters.size(); ++i) {
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      work.carried[k] = (*filters[i])[k] * filter_of_response_[k];
    }
    work.decimated.inverse(work.carried, work.residual);
    const auto begin = work.residual.begin() + static_cast<std::ptrdiff_t>(first);
    work.responses[i].assign(begin, begin + static_cast<std::ptrdiff_t>(band_.judged + 2 * before));
    end_where_unresolved(work.responses[i], damped_path_.front().real() * judged_period_s(), first);
  }
  noise_.carry(work.responses, work.carried_noise, work.bins);
  for (std::size_t k = 0; k < work.bins.size(); ++k) {
    work.bins[k].power /= filter_[k] * filter_[k];
    work.bins[k].ratio /= filter_[k];
  }
}

/// What whitens residuals at one bin: the inverse Cholesky factor of half their covariance, for
/// real and imaginary parts are of unit variance each. `cross` becomes P G^H.
double WhiteResiduals::put_whitener(const CarriedBin& carried, std::size_t bin,
                                    Eigen::MatrixXcd& cross, Eigen::MatrixXcd& whitener) const {
  const auto gauges = static_cast<Eigen::Index>(campaign_.gauges());
  const auto rows = static_cast<Eigen::Index>(others_.size());
  const auto other = [&](Eigen::Index i) { return others_[static_cast<std::size_t>(i)]; };
  const auto noise = [&](std::size_t a, std::size_t b) { return noise_.covariance(bin, a, b); };
  const std::size_t reference = campaign_.reference;
  const bool means = carried.ratio.size() > rows + 1;
  const bool shared = noise_.shared_with(reference);
  // Of what a window of the same length keeps of everything, so that a length of next to nothing
  // is one of nothing.
  const Complex mean = means ? carried.ratio[rows] / carried.ratio[rows + 1] : Complex(1.0);
  const double of_reference = noise(reference, reference);
  const double scale = noise_.scale(reference, bin);
  // What a gauge has of the reference's noise comes through the window with what waves carry of it:
  // the slower it is, the more the two cancel, and no more than that may be left.
  const auto part = [&](std::size_t gauge) { return noise(gauge, reference) / of_reference; };
  const auto rest = [&](std::size_t a, std::size_t b) {
    return shared ? noise(a, b) - part(a) * part(b) * of_reference : noise(a, b);
  };
  const Eigen::Index all = carried.ratio.size() - 1;
  cross.resize(gauges, rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < gauges; ++j) {
      const auto gauge = static_cast<std::size_t>(j);
      cross(j, i) =
          shared ? std::conj(mean) * rest(gauge, other(i)) +
                       part(gauge) * scale *
                           (part(other(i)) * carried.power(all, rows) - carried.power(all, i))
                 : std::conj(mean) * noise(gauge, other(i)) -
                       std::conj(carried.ratio[i]) * noise(gauge, reference);
    }
  }
  // G P G^H, but of the reference's own noise what is carried.
  const auto covariance = [&](Eigen::Index i, Eigen::Index j) -> Complex {
    const Complex carried_on = scale * carried.power(i, j);
    if (!shared) {
      return std::norm(mean) * noise(other(i), other(j)) + carried_on;
    }
    const double a = part(other(i));
    const double b = part(other(j));
    return std::norm(mean) * rest(other(i), other(j)) + carried_on +
           scale * (a * b * carried.power(rows, rows) - a * carried.power(rows, j) -
                    b * carried.power(i, rows));
  };
  // Where the reference is blind, what the window's ends leak of slow noise stays.
  const double kept =
      means ? carried.power(rows, rows).real() / carried.power(rows + 1, rows + 1).real() : 0.0;
  const auto leaked_of_other = [&](Eigen::Index i) {
    return means ? rest(other(i), other(i)) * (kept - std::norm(mean)) : 0.0;
  };
  const auto variance = [&](Eigen::Index i) {
    return covariance(i, i).real() + leaked_of_other(i);
  };
  double leaked = 0.0;
  for (Eigen::Index i = 0; means && i < rows; ++i) {
    // Of the reference's noise as much leaks as ever, and beside what a mean leaves it is more.
    const double carried_on = scale * carried.power(i, i).real();
    const double of_own = std::max(0.0, carried_on - std::norm(carried.ratio[i]) * of_reference);
    const double beside_a_point = of_own / (noise(other(i), other(i)) + carried_on);
    leaked += std::max(0.0, (leaked_of_other(i) + of_own) / variance(i) - beside_a_point);
  }
  whitener.resize(rows, rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      whitener(i, j) = 0.5 * covariance(i, j);
    }
    whitener(i, i) = 0.5 * variance(i);
  }
  if (!invert_factor(whitener)) {
    // What gauges but the reference share is known as if it were stationary: among long echoes it
    // can contradict.
    constexpr double kLeast = 1e-3;
    whitener.setZero();
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double least = kLeast * noise(other(i), other(i));
      whitener(i, i) = 1.0 / std::sqrt(0.5 * std::max(variance(i), least));
    }
  }
  return leaked;
}

/// Scene and transfers of a shot under what acts on waves, unless they are known.
void WhiteResiduals::know_waves(Workspace& work, const Composition& composition,
                                std::vector<AppliedEffect> effects, std::size_t shot) const {
  const bool same_shot = work.shot && (*work.shot == shot || !composition.differs_by_shot());
  if (work.scene && same_shot && work.on_waves == effects) {
    return;
  }
  work.scene.emplace(campaign_.bench, campaign_.shots[shot].facts, damped_path_);
  shape(effects, *work.scene);
  work.ratios = ratios_of(*work.scene);
  work.on_waves = std::move(effects);
  work.shot = shot;
}

/// The ratios by which noise is carried: of a shot as the others are on average.
WhiteResiduals::Ratios WhiteResiduals::usual_ratios(
    Workspace& work, const Composition& composition,
    const std::vector<AppliedEffect>& effects) const {
  if (!composition.differs_by_shot()) {
    know_waves(work, composition, effects, 0);
    return work.ratios;
  }
  Scene scene(campaign_.bench, usual_, damped_path_);
  shape(effects, scene);
  return ratios_of(scene);
}

/// What whitens residuals under these effects, unless it is known.
void WhiteResiduals::know_noise(Workspace& work, const Composition& composition,
                                const std::vector<AppliedEffect>& effects) const {
  if (work.on_noise == effects) {
    return;
  }
  carry_noise(work, usual_ratios(work, composition, effects));
  work.whitener.resize(band_.bins_judged);
  work.cross.resize(band_.bins_judged);
  work.leaked = 0.0;
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    work.leaked += put_whitener(work.bins[k], k, work.cross[k], work.whitener[k]);
  }
  work.on_noise = effects;
}

void WhiteResiduals::freeze(const Composition& composition, const std::vector<double>& theta) {
  Workspace& work = *work_.front();
  know_noise(work, composition, Effects(composition, theta, 0).on_waves);
  // With the noise of the freeze before: what it straightens is known no better yet.
  Eigen::VectorXd white = evaluate(composition, theta);
  spread_.resize(band_.bins_judged);
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    // P G^H (L L^H)^-1 L of white: what each gauge's noise would have to be.
    spread_[k].noalias() = 0.5 * work.cross[k].lazyProduct(work.whitener[k].adjoint());
  }
  frozen_ = std::move(white);
  know_source_noise(work);
}

/// What frozen residuals show of the noise of the sources that bend specimens. Where they are more
/// than noise, no more of them counts as that.
void WhiteResiduals::know_source_noise(Workspace& work) {
  source_noise_.clear();
  if (!campaign_.bench.specimen) {
    return;
  }
  const std::vector<double> shares = shares_of_noise();
  std::vector<double> record(campaign_.shots.front().strain[campaign_.reference].size());
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    put_own_noise(work, n, campaign_.reference, shares);
    std::ranges::copy(work.fine_record, record.begin() + static_cast<std::ptrdiff_t>(band_.begin));
    transform_record(work, record, source_noise_.emplace_back());
  }
}

/// By bin, what noise makes of the frozen residuals' power around it.
std::vector<double> WhiteResiduals::shares_of_noise() const {
  constexpr std::size_t kAround = 8;
  const std::size_t bins = band_.bins_judged;
  const std::size_t at_bin = 2 * others_.size();
  std::vector<double> power(bins + 1, 0.0);  // summed up to each bin
  for (std::size_t k = 0; k < bins; ++k) {
    power[k + 1] = power[k];
    for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
      const auto first = static_cast<Eigen::Index>(n * per_shot() + k * at_bin);
      power[k + 1] += frozen_.segment(first, static_cast<Eigen::Index>(at_bin)).squaredNorm();
    }
  }
  std::vector<double> shares(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    const std::size_t first = k > kAround ? k - kAround : 0;
    const std::size_t end = std::min(bins, k + kAround + 1);
    const auto expected = static_cast<double>((end - first) * at_bin * campaign_.shots.size());
    shares[k] = std::min(1.0, expected / (power[end] - power[first]));
  }
  return shares;
}

bool WhiteResiduals::know_steps() {
  bool coarse = false;
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    if (!noise_.is_coarse(j)) {
      continue;
    }
    std::vector<std::vector<double>> clean;
    for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
      const std::vector<double> record = signal(n, j);
      const auto judged = static_cast<std::ptrdiff_t>(band_.judged * band_.decimation);
      const auto first = static_cast<std::ptrdiff_t>(band_.begin);
      clean.emplace_back(record.begin() + first, record.begin() + first + judged);
    }
    noise_.add_steps(j, clean);
    coarse = true;
  }
  if (coarse) {
    forget_whitener();
  }
  return coarse;
}

std::vector<double> WhiteResiduals::signal(std::size_t shot, std::size_t gauge) {
  Workspace& work = *work_.front();
  put_own_noise(work, shot, gauge);
  std::vector<double> record = campaign_.shots[shot].strain[gauge];
  const auto first = record.begin() + static_cast<std::ptrdiff_t>(band_.begin);
  std::transform(work.fine_record.begin(), work.fine_record.end(), first, first,
                 [](double noise, double read) { return read - noise; });
  smooth(work, record);
  return record;
}

SpecimenHistories WhiteResiduals::specimen_histories(const Composition& composition,
                                                     const std::vector<double>& theta,
                                                     std::size_t shot) {
  Workspace& work = *work_.front();
  Scene scene(campaign_.bench, campaign_.shots[shot].facts, damped_path_);
  shape(Effects(composition, theta, shot).on_waves, scene);
  scene.specimen->further_strain.assign(work.decimated.length(), 0.0);
  Spectrum source;
  transform_record(work, signal(shot, campaign_.reference), source);
  work.response.solve(scene, ratios_of(scene), campaign_.reference, source, damped_filter_,
                      work.decimated);
  return work.response.histories(work.decimated);
}

/// A gauge's noise over the judged window at the records' rate, as much of it as residuals show.
/// @param shares  of them by bin that count; empty: all
void WhiteResiduals::put_own_noise(Workspace& work, std::size_t shot, std::size_t gauge,
                                   std::span<const double> shares) const {
  std::fill(work.fine_spectrum.begin(), work.fine_spectrum.end(), 0.0);
  const auto rows = static_cast<Eigen::Index>(others_.size());
  for (std::size_t k = 0; k < band_.bins_judged && frozen_.size() > 0; ++k) {
    Complex noise = 0.0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto at =
          static_cast<Eigen::Index>(shot * per_shot() + index(k, static_cast<std::size_t>(i)));
      noise +=
          spread_[k](static_cast<Eigen::Index>(gauge), i) * Complex(frozen_[at], frozen_[at + 1]);
    }
    work.fine_spectrum[k + 1] =
        noise * static_cast<double>(band_.decimation) * (shares.empty() ? 1.0 : shares[k]);
  }
  work.fine.inverse(work.fine_spectrum, work.fine_record);
}

void WhiteResiduals::believe_quiet() {
  noise_.forget();
  forget_whitener();
}

void WhiteResiduals::calibrate(const Composition& composition, const std::vector<double>& theta,
                               NoiseShown shown) {
  // Expectation and maximisation: what the residuals say of each gauge's noise, given the noise of
  // all as known so far. The slowest part halves its error at each step.
  constexpr int kSteps = 6;
  // From below, for too much of it goes slowly.
  believe_quiet();
  for (int step = 0; step < kSteps; ++step) {
    freeze(composition, theta);
    share_out_noise(evaluate(composition, theta), shown);
  }
  freeze(composition, theta);
}

void WhiteResiduals::share_out_noise(const Eigen::VectorXd& white, NoiseShown shown) {
  const std::size_t shots = campaign_.shots.size();
  const std::size_t bins = band_.bins_judged;
  std::vector<Spectrum> sources;
  std::vector<std::vector<Spectrum>> noise;
  for (std::size_t n = 0; n < shots; ++n) {
    sources.push_back(source_spectrum(n, white));
    noise.push_back(
        deviation_spectra(std::span<const double>(white.data() + n * per_shot(), per_shot())));
  }
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    std::vector<double> power(bins);
    for (std::size_t k = 0; k < bins; ++k) {
      power[k] = noise_.scale(j, k) * power_over_known(j, k, noise, sources);
    }
    noise_.learn(j, power, shown);
  }
  forget_whitener();
}

void WhiteResiduals::forget_whitener() {
  for (const auto& work : work_) {
    work->on_noise.reset();
  }
}

/// Of a gauge's noise at a bin, as the residuals show it: what they say of it, but for what follows
/// the shots' sources, and what they leave open.
double WhiteResiduals::power_over_known(std::size_t gauge, std::size_t bin,
                                        const std::vector<std::vector<Spectrum>>& noise,
                                        const std::vector<Spectrum>& sources) const {
  const std::size_t shots = noise.size();
  double all = 0.0;
  double source_power = 0.0;
  Complex followed = 0.0;
  for (std::size_t n = 0; n < shots; ++n) {
    const Complex e = noise[n][gauge][bin + 1];
    all += std::norm(e);
    source_power += std::norm(sources[n][bin]);
    followed += e * std::conj(sources[n][bin]);
  }
  // One shot shows nothing that follows its source or not.
  const double shown =
      shots > 1 ? (all - std::norm(followed) / source_power) / static_cast<double>(shots - 1) : all;
  const auto j = static_cast<Eigen::Index>(gauge);
  const double known = noise_.power(gauge, bin);
  const double open = known - 2.0 * spread_[bin].row(j).squaredNorm();
  return (shown + std::max(0.0, open)) / known;
}

Eigen::VectorXd WhiteResiduals::evaluate(const Composition& composition,
                                         const std::vector<double>& theta, std::size_t worker) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(size()));
  evaluate_shots(composition, theta, 0, campaign_.shots.size(), worker, out.data());
  return out;
}

Eigen::VectorXd WhiteResiduals::evaluate_shot(const Composition& composition,
                                              const std::vector<double>& theta, std::size_t shot,
                                              std::size_t worker) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(per_shot()));
  evaluate_shots(composition, theta, shot, shot + 1, worker, out.data());
  return out;
}

/// By what the specimen departs from its linear law, in the scene that is known. It departs by
/// the wave, not by its noise, which the others' residuals have as a linear specimen carries it: a
/// law that lets less of it through would gain by that.
const std::vector<Complex>& WhiteResiduals::departure_of(Workspace& work, Spectrum source,
                                                         std::size_t shot) const {
  for (std::size_t k = 0; k < source.size() && !source_noise_.empty(); ++k) {
    source[k] -= source_noise_[shot][k];
  }
  if (const Spectrum* known = work.departures.find(shot, work.on_waves, source)) {
    return *known;
  }
  work.response.solve(*work.scene, work.ratios, campaign_.reference, source, damped_filter_,
                      work.decimated);
  work.departures.keep(shot, work.on_waves, source, work.response.q());
  return work.response.q();
}

/// One shot's residuals by other gauge, along the damped path and filtered.
void WhiteResiduals::find_residuals(Workspace& work, const Composition& composition,
                                    const std::vector<double>& theta, std::size_t shot) const {
  const std::size_t reference = campaign_.reference;
  Effects effects(composition, theta, shot);
  know_waves(work, composition, std::move(effects.on_waves), shot);
  const Scene& scene = *work.scene;
  const Ratios& ratios = work.ratios;
  const std::vector<Spectrum>* records = &spectra_[shot];
  if (!effects.on_records.empty()) {
    shape_records(work, effects.on_records, shot);
    records = &work.records;
  }
  const Spectrum& source = (*records)[reference];
  // Of the reference record, what the specimen's further strain q has sent there goes first.
  const Spectrum* q = nullptr;
  if (scene.specimen && scene.specimen->nonlinear()) {
    q = &departure_of(work, source, shot);
  }
  work.residuals.resize(others_.size());
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const std::size_t j = others_[i];
    Spectrum& damped = work.residuals[i];
    damped.resize(band_.bins_carried);
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      damped[k] = ratios.mean_at(k) * (*records)[j][k] - ratios.reading[j][k] * source[k];
    }
    if (q != nullptr) {
      for (std::size_t k = 0; k < band_.bins_carried; ++k) {
        damped[k] -= (ratios.mean_at(k) * ratios.reading_of_q[j][k] -
                      ratios.reading[j][k] * ratios.reading_of_q[reference][k]) *
                     damped_filter_[k] * (*q)[k];
      }
    }
  }
}

double WhiteResiduals::taken_by_noise(const Composition& composition,
                                      const std::vector<double>& theta, std::size_t worker) {
  Workspace& work = *work_[worker];
  const Effects effects(composition, theta, 0);
  // Only a reference gauge that has a length is blind anywhere.
  if (work.on_noise != effects.on_waves &&
      usual_ratios(work, composition, effects.on_waves).mean.empty()) {
    return 0.0;
  }
  know_noise(work, composition, effects.on_waves);
  // Real and imaginary parts of unit variance each.
  return 2.0 * work.leaked * static_cast<double>(campaign_.shots.size());
}

Eigen::VectorXd WhiteResiduals::evaluate_in_noise_of(const Composition& known,
                                                     const std::vector<double>& known_theta,
                                                     const Composition& composition,
                                                     const std::vector<double>& theta,
                                                     std::size_t worker) {
  know_noise(*work_[worker], known, Effects(known, known_theta, 0).on_waves);
  Eigen::VectorXd out(static_cast<Eigen::Index>(size()));
  whiten_shots(composition, theta, 0, campaign_.shots.size(), worker, out.data());
  return out;
}

Eigen::VectorXd WhiteResiduals::evaluate_shot_in_noise_of(const Composition& known,
                                                          const std::vector<double>& known_theta,
                                                          const Composition& composition,
                                                          const std::vector<double>& theta,
                                                          std::size_t shot, std::size_t worker) {
  know_noise(*work_[worker], known, Effects(known, known_theta, 0).on_waves);
  Eigen::VectorXd out(static_cast<Eigen::Index>(per_shot()));
  whiten_shots(composition, theta, shot, shot + 1, worker, out.data());
  return out;
}

void WhiteResiduals::evaluate_shots(const Composition& composition,
                                    const std::vector<double>& theta, std::size_t first,
                                    std::size_t end, std::size_t worker, double* next) {
  know_noise(*work_[worker], composition, Effects(composition, theta, 0).on_waves);
  whiten_shots(composition, theta, first, end, worker, next);
}

/// With the noise as known.
void WhiteResiduals::whiten_shots(const Composition& composition, const std::vector<double>& theta,
                                  std::size_t first, std::size_t end, std::size_t worker,
                                  double* next) {
  Workspace& work = *work_[worker];
  for (std::size_t n = first; n < end; ++n) {
    find_residuals(work, composition, theta, n);
    whiten_shot(work, next);
  }
}

/// What is in `work.residuals`, with the noise as known there.
void WhiteResiduals::whiten_shot(Workspace& work, double*& next) const {
  const auto rows = static_cast<Eigen::Index>(others_.size());
  Eigen::VectorXcd r(rows);
  Eigen::VectorXcd white(rows);
  work.rows.resize(others_.size());
  for (std::size_t i = 0; i < others_.size(); ++i) {
    plain_spectrum(work, work.residuals[i], work.rows[i]);
  }
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      r[i] = work.rows[static_cast<std::size_t>(i)][k];
    }
    white.noalias() = work.whitener[k].lazyProduct(r);
    for (Eigen::Index i = 0; i < rows; ++i) {
      *next++ = white[i].real();
      *next++ = white[i].imag();
    }
  }
}

Eigen::VectorXd WhiteResiduals::whiten_records(const Composition& composition,
                                               const std::vector<double>& theta,
                                               std::span<const std::vector<double>> records,
                                               std::size_t worker) {
  Workspace& work = *work_[worker];
  const Effects effects(composition, theta, 0);
  know_noise(work, composition, effects.on_waves);
  know_waves(work, composition, effects.on_waves, 0);
  std::vector<Spectrum> spectra(records.size());
  for (std::size_t j = 0; j < records.size(); ++j) {
    transform_record(work, records[j], spectra[j]);
  }
  work.residuals.resize(others_.size());
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const std::size_t j = others_[i];
    Spectrum& damped = work.residuals[i];
    damped.resize(band_.bins_carried);
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      damped[k] = work.ratios.mean_at(k) * spectra[j][k] -
                  work.ratios.reading[j][k] * spectra[campaign_.reference][k];
    }
  }
  Eigen::VectorXd white(static_cast<Eigen::Index>(per_shot()));
  double* next = white.data();
  whiten_shot(work, next);
  return white;
}

Eigen::VectorXd WhiteResiduals::whiten_pulses(const Composition& composition,
                                              const std::vector<double>& theta,
                                              std::size_t worker) {
  Workspace& work = *work_[worker];
  Eigen::VectorXd white(static_cast<Eigen::Index>(size()));
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    const CampaignShot& shot = campaign_.shots[n];
    std::vector<std::vector<double>> pulses = shot.strain;
    for (std::vector<double>& record : pulses) {
      smooth(work, record);
      const double least = kStandsOut * quiet_before(record, shot.quiet_samples).noise_rms;
      std::ranges::replace_if(
          record, [&](double strain) { return std::abs(strain) < least; }, 0.0);
    }
    const auto at = static_cast<Eigen::Index>(n * per_shot());
    white.segment(at, static_cast<Eigen::Index>(per_shot())) =
        whiten_records(composition, theta, pulses, worker);
  }
  return white;
}

PlainResiduals WhiteResiduals::plain(const Composition& composition,
                                     const std::vector<double>& theta) {
  Workspace& work = *work_.front();
  know_noise(work, composition, Effects(composition, theta, 0).on_waves);
  PlainResiduals plain;
  plain.before = band_.begin / band_.decimation;
  plain.responses = work.responses;
  if (plain.responses.size() == others_.size() + 1) {
    plain.responses.pop_back();
  }
  const auto first = static_cast<std::ptrdiff_t>((band_.lead + band_.begin) / band_.decimation);
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    find_residuals(work, composition, theta, n);
    plain.records.emplace_back();
    for (const Spectrum& damped : work.residuals) {
      std::copy(damped.begin(), damped.end(), work.carried.begin());
      std::fill(work.carried.begin() + static_cast<std::ptrdiff_t>(damped.size()),
                work.carried.end(), 0.0);
      work.decimated.inverse(work.carried, work.residual);
      const auto begin = work.residual.begin() + first;
      plain.records.back().emplace_back(begin, begin + static_cast<std::ptrdiff_t>(band_.judged));
    }
  }
  return plain;
}

std::vector<WhiteResiduals::Spectrum> WhiteResiduals::deviation_spectra(
    std::span<const double> white) const {
  const Workspace& work = *work_.front();
  const auto rows = static_cast<Eigen::Index>(others_.size());
  std::vector<Spectrum> spectra(campaign_.gauges(), Spectrum(work.plain.bins(), 0.0));
  Eigen::VectorXcd w(rows);
  Eigen::VectorXcd e(static_cast<Eigen::Index>(campaign_.gauges()));
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      const std::size_t at = index(k, static_cast<std::size_t>(i));
      w[i] = {white[at], white[at + 1]};
    }
    e.noalias() = spread_[k].lazyProduct(w);
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      spectra[j][k + 1] = e[static_cast<Eigen::Index>(j)];
    }
  }
  return spectra;
}

std::vector<std::vector<double>> WhiteResiduals::deviations(std::span<const double> white) const {
  Workspace& work = *work_.front();
  std::vector<std::vector<double>> list;
  for (const Spectrum& spectrum : deviation_spectra(white)) {
    std::vector<double> record(band_.judged);
    work.plain.inverse(spectrum, record);
    list.push_back(std::move(record));
  }
  return list;
}

std::vector<double> WhiteResiduals::judged_part(Workspace& work, const Spectrum& damped) const {
  Spectrum plain;
  plain_spectrum(work, damped, plain);
  std::fill(work.judged.begin(), work.judged.end(), 0.0);
  const Complex mean = [&] {
    double sum = 0.0;
    const std::size_t first = (band_.lead + band_.begin) / band_.decimation;
    for (std::size_t n = 0; n < band_.judged; ++n) {
      sum += work.residual[first + n];
    }
    return Complex(sum);
  }();
  work.judged[0] = mean;
  std::copy(plain.begin(), plain.end(), work.judged.begin() + 1);
  std::vector<double> record(band_.judged);
  work.plain.inverse(work.judged, record);
  return record;
}

void WhiteResiduals::measure_signal() {
  double sum = 0.0;
  for (const std::vector<Spectrum>& of_shot : spectra_) {
    judged_records_.emplace_back();
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      const auto& record =
          judged_records_.back().emplace_back(judged_part(*work_.front(), of_shot[j]));
      const Eigen::Map<const Eigen::VectorXd> values(record.data(),
                                                     static_cast<Eigen::Index>(record.size()));
      sum += values.squaredNorm() / noise_.quiet_power(j);
    }
  }
  // Noise of unit power has as many whitened residuals as its band has bins, twice.
  signal_energy_ =
      sum * 2.0 * static_cast<double>(band_.bins_judged) / static_cast<double>(band_.judged);
}

std::vector<Complex> WhiteResiduals::source_spectrum(std::size_t shot, const Eigen::VectorXd& white,
                                                     std::size_t worker) {
  Spectrum plain;
  plain_spectrum(*work_[worker], spectra_[shot][campaign_.reference], plain);
  const auto rows = static_cast<Eigen::Index>(others_.size());
  const auto reference = static_cast<Eigen::Index>(campaign_.reference);
  Eigen::VectorXcd w(rows);
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto at =
          static_cast<Eigen::Index>(shot * per_shot() + index(k, static_cast<std::size_t>(i)));
      w[i] = {white[at], white[at + 1]};
    }
    plain[k] -= (spread_[k].row(reference) * w)(0, 0);
  }
  return plain;
}

}  // namespace kolsky
