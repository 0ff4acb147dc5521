#include "processing/criticism/comparing/gauge_deviations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/criticism/comparing/drawn_noise.hpp"
#include "processing/criticism/fitting/drawn_rounding.hpp"

namespace kolsky {

namespace {

/// A gauge is off beyond doubt where noise would have it so once in a million.
const double kBeyondDoubt = std::log(1e-6);
/// Others agree where they keep less than this share of all beyond noise, in units in which that of
/// one's and of two gauges' faults compare: found by trial. (A gauge's own leaves 0 to 0.41, once
/// in eighteen 0.5, for the moduli that were fitted with it are still off; what waves lack, with
/// four gauges and more, 0.47 and more.)
constexpr double kStillOff = 0.45;
constexpr double kDeviationsOfChance = 2.0;
constexpr double kFilterPasses = 0.1;
/// Noise of a gauge that is left out, over its own.
constexpr double kLeftOut = 1e8;
/// A long reference gauge's blind frequency: nothing is divided by less.
constexpr double kBlind = 0.1;
/// Draws of noise: more shots together show smaller errors of what is drawn.
constexpr std::size_t kFewestDraws = 48;
constexpr std::size_t kDrawsPerShot = 16;
constexpr std::size_t kMostDraws = 256;

}  // namespace

GaugeDeviations::GaugeDeviations(WhiteResiduals& residuals, const Composition& composition,
                                 const std::vector<double>& theta)
    : residuals_(residuals),
      plain_(residuals.plain(composition, theta)),
      transform_(
          DampedTransform::of_window(2 * residuals.band().judged, residuals.judged_period_s())) {
  const JudgedBand& band = residuals.band();
  while (bins_ < transform_.bins()) {
    const double ratio = static_cast<double>(bins_) * transform_.bin_width_Hz() / band.filter_Hz;
    const double passes = std::exp(-std::numbers::ln2 * std::pow(ratio, 4));
    if (passes <= kFilterPasses) {
      break;
    }
    filter_.push_back(passes);
    ++bins_;
  }
  const std::size_t last = 2 * band.bins_judged;
  double held = 0.0;
  for (std::size_t f = 0; f < bins_; ++f) {
    gain_.push_back(1.0 / filter_[std::min(f, last)]);
    held += f > last ? std::pow(filter_[f] * gain_.back(), 2) : 0.0;
  }
  bins_held_ = band.bins_judged + static_cast<std::size_t>(held / 2.0);

  const std::size_t others = residuals.others().size();
  std::vector<Spectrum> responses;
  std::vector<double> lags(transform_.length());
  for (const std::vector<double>& response : plain_.responses) {
    // Only what comes back within the record is carried in it.
    std::fill(lags.begin(), lags.end(), 0.0);
    for (std::size_t i = 0; i < plain_.before + band.judged; ++i) {
      lags[(i + lags.size() - plain_.before) % lags.size()] = response[i];
    }
    responses.emplace_back(transform_.bins());
    transform_.forward(lags, responses.back());
  }
  for (std::size_t f = 0; responses.size() > others && f < bins_; ++f) {
    const Complex own = responses[others][f] / filter_[f];
    mean_.push_back(std::abs(own) > kBlind ? own : Complex(kBlind));
  }
  const std::size_t gauges = residuals.campaign().gauges();
  waves_.setOnes(static_cast<Eigen::Index>(gauges), static_cast<Eigen::Index>(bins_));
  for (std::size_t f = 0; f < bins_; ++f) {
    for (std::size_t i = 0; i < others; ++i) {
      waves_(static_cast<Eigen::Index>(residuals.others()[i]), static_cast<Eigen::Index>(f)) =
          responses[i][f] / (filter_[f] * (mean_.empty() ? 1.0 : mean_[f]));
    }
  }
  for (const auto& of_shot : plain_.records) {
    y_.push_back(received(of_shot));
  }
  if (residuals.noise().knows_steps()) {
    draw_rounding(residuals, composition, theta);
    draw_noise();
  }
}

/// By gauge, of a shot's residuals: the reference has none.
std::vector<GaugeDeviations::Spectrum> GaugeDeviations::received(
    const std::vector<std::vector<double>>& residuals) {
  std::vector<Spectrum> out(residuals_.campaign().gauges(), Spectrum(transform_.bins(), 0.0));
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    Spectrum& own = out[residuals_.others()[i]];
    transform_.forward(residuals[i], own);
    for (std::size_t f = 0; f < mean_.size(); ++f) {
      own[f] /= mean_[f];
    }
  }
  return out;
}

bool GaugeDeviations::draw_where_waves_ring() {
  if (draws() || !rings_on(plain_, residuals_.band().judged)) {
    return draws();
  }
  draw_noise();
  return true;
}

void GaugeDeviations::draw_noise() {
  const std::size_t draws =
      std::min(kMostDraws, kFewestDraws + kDrawsPerShot * residuals_.campaign().shots.size());
  DrawnNoise noise(residuals_, plain_);
  while (drawn_.size() < draws) {
    drawn_.push_back(received(noise.next()));
  }
}

void GaugeDeviations::draw_rounding(WhiteResiduals& residuals, const Composition& composition,
                                    const std::vector<double>& theta) {
  const DrawnRounding rounding(residuals, StepsLie::alike);
  for (std::size_t n = 0; n < y_.size(); ++n) {
    auto& of_shot = rounded_.emplace_back();
    for (std::size_t d = 0; d < DrawnRounding::kDraws; ++d) {
      of_shot.push_back(
          received(residuals.plain_of_records(composition, theta, rounding.records(n, d), n)));
    }
  }
}

std::size_t GaugeDeviations::judged_bin(std::size_t fine) const {
  return std::clamp<std::size_t>((fine + 1) / 2, 1, residuals_.band().bins_judged) - 1;
}

/// Generalised least squares: s = w^H y / w^H k with w = P^-1 k, k the waves and P the noise.
GaugeDeviations::Estimate GaugeDeviations::estimate(const std::vector<bool>& left_out) const {
  const auto gauges = static_cast<Eigen::Index>(left_out.size());
  Estimate out{Eigen::MatrixXcd(gauges, waves_.cols()), Eigen::MatrixXd(gauges, waves_.cols())};
  Eigen::MatrixXd noise(gauges, gauges);
  Eigen::MatrixXd weighted(gauges, gauges);
  Eigen::MatrixXd inverse(gauges, gauges);
  Eigen::PartialPivLU<Eigen::MatrixXd> factors(gauges);
  for (std::size_t f = 0; f < bins_; ++f) {
    if (f == 0 || judged_bin(f) != judged_bin(f - 1)) {
      residuals_.noise().put_covariance(judged_bin(f), noise);
      weighted = noise;
      for (Eigen::Index j = 0; j < gauges; ++j) {
        weighted(j, j) *= left_out[static_cast<std::size_t>(j)] ? kLeftOut : 1.0;
      }
      inverse = factors.compute(weighted).inverse();
    }
    const auto wave = waves_.col(static_cast<Eigen::Index>(f));
    auto weight = out.weight.col(static_cast<Eigen::Index>(f));
    weight.noalias() = inverse * wave;
    const double known = weight.dot(wave).real();
    weight /= known;
    for (Eigen::Index j = 0; j < gauges; ++j) {
      // What the gauge has of the estimate's error, unlike it or not in it at all.
      const double of_source = std::norm(wave[j]) / known;
      const double square =
          left_out[static_cast<std::size_t>(j)] ? noise(j, j) + of_source : noise(j, j) - of_source;
      out.sd(j, static_cast<Eigen::Index>(f)) = std::sqrt(std::max(square, 1e-6 * noise(j, j)));
    }
  }
  return out;
}

/// By gauge, over their standard deviations.
std::vector<GaugeDeviations::Spectrum> GaugeDeviations::deviations(
    const Estimate& estimate, const std::vector<Spectrum>& received) const {
  const std::size_t gauges = received.size();
  std::vector<Spectrum> out(gauges, Spectrum(transform_.bins(), 0.0));
  for (std::size_t f = 0; f < bins_; ++f) {
    const auto bin = static_cast<Eigen::Index>(f);
    Complex source = 0.0;
    for (std::size_t j = 0; j < gauges; ++j) {
      source += std::conj(estimate.weight(static_cast<Eigen::Index>(j), bin)) * received[j][f];
    }
    for (std::size_t j = 0; j < gauges; ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      out[j][f] = std::numbers::sqrt2 * gain_[f] * (received[j][f] - waves_(at, bin) * source) /
                  estimate.sd(at, bin);
    }
  }
  return out;
}

double GaugeDeviations::energy_of(const Spectrum& deviation) const {
  double energy = 0.0;
  for (std::size_t f = 1; f <= 2 * residuals_.band().bins_judged; ++f) {
    // Bins are half as wide as judged ones.
    energy += 0.5 * std::norm(deviation[f]);
  }
  return energy;
}

GaugeDeviations::Found GaugeDeviations::found(const Estimate& estimate) const {
  Found out;
  out.energy.assign(y_.front().size(), 0.0);
  for (const std::vector<Spectrum>& of_shot : y_) {
    out.spectra.push_back(deviations(estimate, of_shot));
    for (std::size_t j = 0; j < out.energy.size(); ++j) {
      out.energy[j] += energy_of(out.spectra.back()[j]);
    }
  }
  return out;
}

GaugeDeviations::Drawn& GaugeDeviations::drawn(const std::vector<bool>& left_out,
                                               const Estimate& estimate) {
  const auto known = drawn_of_.find(left_out);
  if (known != drawn_of_.end()) {
    return known->second;
  }
  Drawn out;
  std::vector<PlaceNoise> energy;
  for (const TileNoise& of_one : drawn_energy(estimate)) {
    PlaceNoise& of_all = energy.emplace_back();
    for (std::size_t n = 0; n < y_.size(); ++n) {
      of_all.normal += of_one;
    }
  }
  add_rounded_energy(estimate, energy);
  for (const PlaceNoise& own : energy) {
    out.energy.push_back(own.whole());
  }
  return drawn_of_.emplace(left_out, std::move(out)).first->second;
}

/// By gauge, of one shot's normal noise.
std::vector<TileNoise> GaugeDeviations::drawn_energy(const Estimate& estimate) const {
  const auto size = static_cast<Eigen::Index>(2 * residuals_.band().bins_judged);
  std::vector<Eigen::MatrixXd> parts(
      y_.front().size(), Eigen::MatrixXd(2 * size, static_cast<Eigen::Index>(drawn_.size())));
  for (std::size_t d = 0; d < drawn_.size(); ++d) {
    const std::vector<Spectrum> own = deviations(estimate, drawn_[d]);
    for (std::size_t j = 0; j < own.size(); ++j) {
      const Eigen::Map<const Eigen::VectorXcd> judged(own[j].data() + 1, size);
      auto out = parts[j].col(static_cast<Eigen::Index>(d));
      out.head(size) = std::sqrt(0.5) * judged.real();
      out.tail(size) = std::sqrt(0.5) * judged.imag();
    }
  }
  std::vector<TileNoise> list;
  for (const Eigen::MatrixXd& of_gauge : parts) {
    list.push_back(tile_noise_of(of_gauge));
  }
  return list;
}

/// By gauge, of all shots: in one draw steps lie alike in all of them.
void GaugeDeviations::add_rounded_energy(const Estimate& estimate,
                                         std::vector<PlaceNoise>& energy) const {
  for (const auto& of_shot : rounded_) {
    for (std::size_t d = 0; d < of_shot.size(); ++d) {
      const std::vector<Spectrum> own = deviations(estimate, of_shot[d]);
      for (std::size_t j = 0; j < own.size(); ++j) {
        energy[j].rounded.resize(of_shot.size(), 0.0);
        energy[j].rounded[d] += energy_of(own[j]);
      }
    }
  }
}

void GaugeDeviations::put_drawn_records(const Estimate& estimate, Drawn& out) {
  out.records.resize(y_.front().size());
  for (const std::vector<Spectrum>& draw : drawn_) {
    const std::vector<Spectrum> own = deviations(estimate, draw);
    for (std::size_t j = 0; j < own.size(); ++j) {
      transform_.inverse(own[j], out.records[j].emplace_back(residuals_.band().judged));
    }
  }
  out.rounded.assign(out.records.size(), std::vector<Records>(rounded_.size()));
  for (std::size_t n = 0; n < rounded_.size(); ++n) {
    for (const std::vector<Spectrum>& draw : rounded_[n]) {
      const std::vector<Spectrum> own = deviations(estimate, draw);
      for (std::size_t j = 0; j < own.size(); ++j) {
        transform_.inverse(own[j], out.rounded[j][n].emplace_back(residuals_.band().judged));
      }
    }
  }
}

/// By gauge, over the judged bins and all shots.
std::vector<TileNoise> GaugeDeviations::noise_energy(const std::vector<bool>& left_out,
                                                     const Estimate& estimate) {
  if (draws()) {
    return drawn(left_out, estimate).energy;
  }
  const double freedom =
      2.0 * static_cast<double>(residuals_.band().bins_judged) * static_cast<double>(y_.size());
  return std::vector<TileNoise>(left_out.size(), {freedom, freedom, freedom});
}

/// What the gauges that are not left out have beyond noise.
double GaugeDeviations::excess_of_others(const Found& now, const std::vector<bool>& left_out,
                                         const std::vector<TileNoise>& noise) {
  double excess = 0.0;
  for (std::size_t j = 0; j < left_out.size(); ++j) {
    excess += left_out[j] ? 0.0 : now.energy[j] - noise[j].mean;
  }
  return excess;
}

/// The gauges that stand out beyond doubt, each beside those before it, until the others agree; as
/// long as more are left. Where they never do the fault is in the waves, which all gauges read, and
/// none is left out: of an end's reflection the gauge that shows most of it is not to blame.
std::vector<bool> GaugeDeviations::at_fault(const Found& all, const Estimate& estimate_of_all) {
  const std::size_t gauges = all.energy.size();
  std::vector<bool> out(gauges, false);
  std::vector<TileNoise> noise = noise_energy(out, estimate_of_all);
  const double whole = excess_of_others(all, out, noise);
  const auto unit_share = [gauges](std::size_t left) {
    return static_cast<double>(left * (left - 1)) / static_cast<double>(gauges * (gauges - 1));
  };
  Found now = all;
  for (std::size_t left = gauges - 1; left > gauges - 1 - (gauges - 1) / 2; --left) {
    std::size_t worst = gauges;
    const auto beyond = [&](std::size_t j) { return now.energy[j] / noise[j].mean; };
    for (std::size_t j = 0; j < gauges; ++j) {
      if (!out[j] && (worst == gauges || beyond(j) > beyond(worst))) {
        worst = j;
      }
    }
    if (noise[worst].log_tail(now.energy[worst]) > kBeyondDoubt) {
      break;
    }
    out[worst] = true;
    const Estimate without = estimate(out);
    now = found(without);
    noise = noise_energy(out, without);
    double variance = 0.0;
    for (std::size_t j = 0; j < gauges; ++j) {
      variance += out[j] ? 0.0 : 2.0 * noise[j].second;
    }
    if (excess_of_others(now, out, noise) <
        kStillOff * unit_share(left) * whole + kDeviationsOfChance * std::sqrt(variance)) {
      return out;
    }
  }
  return std::vector<bool>(gauges, false);
}

std::vector<GaugeDeviation> GaugeDeviations::by_gauge() {
  const std::size_t gauges = y_.front().size();
  Estimate used = estimate(std::vector<bool>(gauges, false));
  Found all = found(used);
  const std::vector<bool> faulty = at_fault(all, used);
  if (std::find(faulty.begin(), faulty.end(), true) != faulty.end()) {
    used = estimate(faulty);
    all = found(used);
  }
  Drawn* noise = draws() ? &drawn(faulty, used) : nullptr;
  if (noise != nullptr && noise->records.empty()) {
    put_drawn_records(used, *noise);
  }
  std::vector<GaugeDeviation> list;
  for (std::size_t j = 0; j < gauges; ++j) {
    GaugeDeviation own{j,
                       {},
                       {},
                       noise != nullptr ? &noise->records[j] : nullptr,
                       rounded_.empty() ? nullptr : &noise->rounded[j]};
    for (const std::vector<Spectrum>& of_shot : all.spectra) {
      own.records.emplace_back(residuals_.band().judged);
      transform_.inverse(of_shot[j], own.records.back());
    }
    for (std::size_t k = 1; k <= residuals_.band().bins_judged; ++k) {
      own.scale.push_back(used.sd(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(2 * k)) /
                          std::numbers::sqrt2);
    }
    list.push_back(std::move(own));
  }
  return list;
}

}  // namespace kolsky
