#include <algorithm>
#include <cmath>
#include <optional>

#include "processing/criticism/fitting/residual_workspace.hpp"
#include "processing/criticism/fitting/residuals.hpp"

namespace kolsky {

namespace {

/// Quiet parts tell all of white noise and little of slow noise.
constexpr double kWhite = 0.98;
/// Noise is there whether waves pass or not: where only so little a chance (ln) leaves residuals
/// more where they pass, what was learned is no noise.
constexpr double kFollowsWaves = -6.9;

}  // namespace

void WhiteResiduals::freeze(const Composition& composition, const std::vector<double>& theta) {
  Workspace& work = *work_.front();
  know_noise(work, composition, StagedEffects(composition, theta, 0).on_waves);
  // With the noise of the freeze before: what it straightens is known no better yet.
  Eigen::VectorXd white = evaluate(composition, theta);
  shares_.take(work.whitener, band_.bins_judged);
  jumps_ = work.jumps;
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    jumps_.put_in({white.data() + n * per_shot(), per_shot()});
  }
  frozen_ = std::move(white);
  know_gauge_noise(work, composition, theta);
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
    std::ranges::copy(shared_out(work, n, campaign_.reference, shares),
                      record.begin() + static_cast<std::ptrdiff_t>(band_.begin));
    work.transforms.carry(record, source_noise_.emplace_back());
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
  const std::span<const double> noise = shared_out(work, shot, gauge);
  std::vector<double> record = campaign_.shots[shot].strain[gauge];
  for (std::size_t n = 0; n < noise.size(); ++n) {
    record[band_.begin + n] -= noise[n];
  }
  work.transforms.smooth(record);
  return record;
}

SpecimenHistories WhiteResiduals::specimen_histories(const Composition& composition,
                                                     const std::vector<double>& theta,
                                                     std::size_t shot) {
  Workspace& work = *work_.front();
  BandTransforms& transforms = work.transforms;
  Scene scene(campaign_.bench, campaign_.shots[shot].facts, path());
  shape(StagedEffects(composition, theta, shot).on_waves, scene);
  scene.specimen->further_strain.assign(transforms.decimated().length(), 0.0);
  Spectrum source;
  transforms.carry(signal(shot, campaign_.reference), source);
  work.response.solve(scene, ratios_of(scene), campaign_.reference, source, transforms.filter(),
                      transforms.decimated());
  return work.response.histories(transforms.decimated());
}

std::span<const double> WhiteResiduals::white_of(std::size_t shot,
                                                 const Eigen::VectorXd& white) const {
  return {white.data() + shot * per_shot(), per_shot()};
}

/// One shot's whitened residuals as they are bin by bin, with what bins have in common.
std::vector<double> WhiteResiduals::by_bin(std::span<const double> white) const {
  std::vector<double> joined(white.begin(), white.end());
  jumps_.put_in(joined);
  return joined;
}

/// A gauge's noise over the judged window at the records' rate, as residuals are shared out bin by
/// bin; until that worker's next transform.
/// @param shares  of them by bin that count; empty: all
std::span<const double> WhiteResiduals::shared_out(Workspace& work, std::size_t shot,
                                                   std::size_t gauge,
                                                   std::span<const double> shares) const {
  Spectrum spectrum(band_.bins_judged + 1, 0.0);
  const auto rate = static_cast<double>(band_.decimation);
  for (std::size_t k = 0; k < band_.bins_judged && shares_.known(); ++k) {
    spectrum[k + 1] =
        shares_.at(gauge, k, white_of(shot, frozen_)) * rate * (shares.empty() ? 1.0 : shares[k]);
  }
  return work.transforms.fine_window_with(spectrum);
}

/// What frozen residuals say of each gauge's noise: of the reference's their share, of any other
/// what its record has beside the reference's without that, carried to it. Shared out bin by bin to
/// all alike, a part of the noise would stay in the readings, and what bends these would find it in
/// the residuals.
void WhiteResiduals::know_gauge_noise(Workspace& work, const Composition& composition,
                                      const std::vector<double>& theta) {
  std::vector<std::vector<std::vector<double>>> noise(campaign_.shots.size());
  const auto rate = static_cast<double>(band_.decimation);
  std::vector<double> record(campaign_.shots.front().strain[campaign_.reference].size());
  Spectrum of_reference;
  Spectrum judged;
  for (std::size_t n = 0; n < noise.size(); ++n) {
    noise[n].resize(campaign_.gauges());
    const std::span<const double> own = shared_out(work, n, campaign_.reference);
    noise[n][campaign_.reference].assign(own.begin(), own.end());
    std::ranges::copy(own, record.begin() + static_cast<std::ptrdiff_t>(band_.begin));
    work.transforms.carry(record, of_reference);
    find_residuals(work, composition, theta, n);
    for (std::size_t i = 0; i < others_.size(); ++i) {
      const std::size_t j = others_[i];
      Spectrum& residual = work.residuals[i];
      for (std::size_t k = 0; k < residual.size(); ++k) {
        residual[k] = (residual[k] + work.ratios.reading[j][k] * of_reference[k]) *
                      invertible(work.ratios.mean_at(k));
      }
      work.transforms.judge(residual, judged);
      Spectrum spectrum(band_.bins_judged + 1, 0.0);
      std::ranges::transform(judged, spectrum.begin() + 1,
                             [&](Complex value) { return rate * value; });
      const std::span<const double> other = work.transforms.fine_window_with(spectrum);
      noise[n][j].assign(other.begin(), other.end());
    }
  }
  gauge_noise_ = std::move(noise);
}

/// Over the judged window at the records' rate; nothing before `freeze`.
std::span<const double> WhiteResiduals::own_noise(std::size_t shot, std::size_t gauge) const {
  return gauge_noise_.empty() ? std::span<const double>{} : gauge_noise_[shot][gauge];
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
  // Of noise that is not white the quiet parts are known to show too little.
  const bool white = noise_.flatness() >= kWhite;
  const std::optional<GaugeNoise::QuietPower> quiet =
      shown == NoiseShown::what_quiet_hides && white
          ? std::optional(noise_.quiet_power_over_known())
          : std::nullopt;
  for (int step = 0; step < kSteps; ++step) {
    freeze(composition, theta);
    share_out_noise(evaluate(composition, theta), quiet ? NoiseShown::pink_alone : shown);
    if (quiet) {
      noise_.hold_to(*quiet);
      forget_whitener();
    }
  }
  freeze(composition, theta);
  if (shown == NoiseShown::all || around_waves().log_p > kFollowsWaves) {
    return;
  }
  if (quiet) {
    believe_quiet();
    freeze(composition, theta);
  } else {
    keep_what_is_between_waves(composition, theta);
  }
}

void WhiteResiduals::share_out_noise(const Eigen::VectorXd& white, NoiseShown shown) {
  const std::size_t shots = campaign_.shots.size();
  const std::size_t bins = band_.bins_judged;
  std::vector<Spectrum> sources;
  std::vector<std::vector<Spectrum>> noise;
  for (std::size_t n = 0; n < shots; ++n) {
    sources.push_back(source_spectrum(n, white));
    noise.push_back(deviation_spectra(by_bin(white_of(n, white))));
  }
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    std::vector<double> power(bins);
    for (std::size_t k = 0; k < bins; ++k) {
      power[k] = noise_.scale(j, k) * power_over_known(j, k, noise, sources);
    }
    noise_.learn(j, power, shown);
  }
  noise_.keep_times_jumps(times_jumps(white));
  forget_whitener();
}

/// Over what the quiet parts foretell, as whitened residuals show it.
double WhiteResiduals::times_jumps(const Eigen::VectorXd& white) const {
  Eigen::VectorXd sizes(static_cast<Eigen::Index>(campaign_.shots.size()));
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    sizes[static_cast<Eigen::Index>(n)] = campaign_.shots[n].facts.peak_strain;
  }
  constexpr double kLeast = 0.01;
  // More would be a hum's or a drift's, which jump, too.
  constexpr double kMost = 1.0;
  const double known = noise_.times_jumps();
  return std::max(kLeast, known * jumps_.times_seen({white.data(), size()}, sizes, kMost / known));
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
  const double open = known - 2.0 * shares_.spread(bin).row(j).squaredNorm();
  return (shown + std::max(0.0, open)) / known;
}

/// From frequency zero on, by gauge. @param by_bin  of one shot
std::vector<WhiteResiduals::Spectrum> WhiteResiduals::deviation_spectra(
    std::span<const double> by_bin) const {
  const std::size_t bins = work_.front()->transforms.window_bins();
  std::vector<Spectrum> spectra(campaign_.gauges(), Spectrum(bins, 0.0));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    for (std::size_t k = 0; k < band_.bins_judged; ++k) {
      spectra[j][k + 1] = shares_.at(j, k, by_bin);
    }
  }
  return spectra;
}

std::vector<std::vector<double>> WhiteResiduals::deviations(std::span<const double> white) const {
  std::vector<std::vector<double>> list;
  for (const Spectrum& spectrum : deviation_spectra(by_bin(white))) {
    list.push_back(work_.front()->transforms.window_with(spectrum));
  }
  return list;
}

std::vector<WhiteResiduals::Spectrum> WhiteResiduals::deviation_bins(
    std::size_t shot, const Eigen::VectorXd& white) const {
  const std::vector<double> joined = by_bin(white_of(shot, white));
  std::vector<Spectrum> spectra(campaign_.gauges());
  for (std::size_t j = 0; j < spectra.size(); ++j) {
    for (std::size_t k = 0; k < band_.bins_judged; ++k) {
      spectra[j].push_back(shares_.at(j, k, joined));
    }
  }
  return spectra;
}

double WhiteResiduals::energy_of_noise() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    // Real and imaginary parts of unit variance each.
    sum += 2.0 * shares_.spread(k).squaredNorm();
  }
  return sum * static_cast<double>(campaign_.shots.size());
}

void WhiteResiduals::measure_signal() {
  double sum = 0.0;
  double squares = 0.0;
  for (const std::vector<Spectrum>& of_shot : spectra_) {
    judged_records_.emplace_back();
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      const auto& record =
          judged_records_.back().emplace_back(work_.front()->transforms.judged_record(of_shot[j]));
      const Eigen::Map<const Eigen::VectorXd> values(record.data(),
                                                     static_cast<Eigen::Index>(record.size()));
      sum += values.squaredNorm() / noise_.quiet_power(j);
      squares += values.squaredNorm();
    }
  }
  // Noise of unit power has as many whitened residuals as its band has bins, twice.
  signal_energy_ =
      sum * 2.0 * static_cast<double>(band_.bins_judged) / static_cast<double>(band_.judged);
  // Each bin stands for its negative frequency, too.
  energy_of_records_ = squares * static_cast<double>(band_.judged) / 2.0;
}

std::vector<Complex> WhiteResiduals::source_spectrum(std::size_t shot, const Eigen::VectorXd& white,
                                                     std::size_t worker) {
  const std::vector<double> joined = by_bin(white_of(shot, white));
  Spectrum source;
  work_[worker]->transforms.judge(spectra_[shot][campaign_.reference], source);
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    source[k] -= shares_.at(campaign_.reference, k, joined);
  }
  return source;
}

}  // namespace kolsky
