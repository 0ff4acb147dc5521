#include "processing/criticism/noise/gauge_noise.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/noise/converter_steps.hpp"
#include "processing/criticism/noise/quiet_scatter.hpp"
#include "processing/criticism/noise/smooth_power.hpp"
#include "processing/identification/noise_spectrum.hpp"

namespace kolsky {

namespace {

/// Sums over squares of responses may be sampled as if they ended at this multiple of the filter's
/// limit: a fortieth is left.
constexpr double kCarriedFrom = 1.4;
/// What is left may be noise of up to so many times the power that was measured before the pulses:
/// that stretch is too short to show what is slow.
constexpr double kMostHidden = 4.0;

using Quiet = std::vector<std::vector<double>>;  ///< of a gauge, by shot

std::vector<Quiet> quiet_of_gauges(const Campaign& campaign) {
  std::vector<Quiet> list;
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    list.push_back(quiet_scatter(campaign, j));
  }
  return list;
}

std::vector<NoiseSpectrum> spectra_of(const std::vector<Quiet>& gauges) {
  std::vector<NoiseSpectrum> spectra;
  for (const Quiet& quiet : gauges) {
    spectra.emplace_back(std::vector<std::span<const double>>(quiet.begin(), quiet.end()));
  }
  return spectra;
}

/// Sums of products of two gauges' quiet samples, all shots together, the second so much later.
double product_of(const Quiet& a, const Quiet& b, std::size_t later) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    if (later < a[n].size()) {
      const auto left = static_cast<Eigen::Index>(a[n].size() - later);
      const Eigen::Map<const Eigen::VectorXd> first(a[n].data(), left);
      const Eigen::Map<const Eigen::VectorXd> second(b[n].data() + later, left);
      sum += first.dot(second);
    }
  }
  return sum;
}

/// Of a gauge's quiet samples by lag, from 1 to a quarter of the shortest quiet, at most
/// `kMostLags`.
std::vector<double> autocorrelation_of(const Quiet& quiet) {
  constexpr std::size_t kMostLags = 256;
  std::size_t shortest = 4 * kMostLags;
  for (const std::vector<double>& own : quiet) {
    shortest = std::min(shortest, own.size());
  }
  std::vector<double> list;
  const double power = product_of(quiet, quiet, 0);
  for (std::size_t lag = 1; power > 0.0 && lag <= shortest / 4; ++lag) {
    list.push_back(product_of(quiet, quiet, lag) / power);
  }
  return list;
}

/// How many times fewer independent samples tell as much of two gauges' correlation.
double slowness(const Quiet& a, const Quiet& b) {
  const std::vector<double> of_a = autocorrelation_of(a);
  const std::vector<double> of_b = autocorrelation_of(b);
  const auto lags = static_cast<std::ptrdiff_t>(std::min(of_a.size(), of_b.size()));
  const double alike = std::inner_product(of_a.begin(), of_a.begin() + lags, of_b.begin(), 0.0);
  return std::max(1.0, 1.0 + 2.0 * alike);
}

/// The same or what is nearest to it of what correlations can be: pairs that were looked at one by
/// one can contradict each other.
Eigen::MatrixXd as_of_noise(const Eigen::MatrixXd& correlation) {
  constexpr double kLeast = 0.02;
  const SymmetricEigen eigen(correlation);
  if (eigen.eigenvalues().minCoeff() >= kLeast) {
    return correlation;
  }
  const Eigen::MatrixXd possible = eigen.eigenvectors() *
                                   eigen.eigenvalues().cwiseMax(kLeast).asDiagonal() *
                                   eigen.eigenvectors().transpose();
  const Eigen::VectorXd scale = possible.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * possible * scale.asDiagonal();
}

/// How far gauges share their noise; nothing where chance does as much. Slow samples tell less than
/// as many independent ones: var rho = (1 + 2 sum rho_a(k) rho_b(k)) / n (Bartlett 1935).
Eigen::MatrixXd correlation_of(const std::vector<Quiet>& gauges) {
  double samples = 0.0;
  for (const std::vector<double>& own : gauges.front()) {
    samples += static_cast<double>(own.size());
  }
  const auto size = static_cast<Eigen::Index>(gauges.size());
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(size, size);
  for (std::size_t a = 0; a < gauges.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double scale =
          std::sqrt(product_of(gauges[a], gauges[a], 0) * product_of(gauges[b], gauges[b], 0));
      const double rho = scale > 0.0 ? product_of(gauges[a], gauges[b], 0) / scale : 0.0;
      constexpr double kSignificant = 5.0;
      const double least = kSignificant / std::sqrt(samples);
      // How slow they are is asked where it can matter.
      if (std::abs(rho) > least &&
          std::abs(rho) > least * std::sqrt(slowness(gauges[a], gauges[b]))) {
        const auto row = static_cast<Eigen::Index>(a);
        const auto column = static_cast<Eigen::Index>(b);
        correlation(row, column) = correlation(column, row) = std::clamp(rho, -0.95, 0.95);
      }
    }
  }
  return as_of_noise(correlation);
}

/// Mean square of a gauge's quiet samples.
double quiet_square(const Campaign& campaign, std::size_t gauge) {
  double sum = 0.0;
  double samples = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    const auto count = static_cast<Eigen::Index>(shot.quiet_samples);
    sum += Eigen::Map<const Eigen::VectorXd>(shot.strain[gauge].data(), count).squaredNorm();
    samples += static_cast<double>(shot.quiet_samples);
  }
  return sum / samples;
}

/// The largest share that is not contradicted. @param against  of a share, growing with it
template <typename Against>
double most_of(const Against& against) {
  constexpr double kContradicted = 2.0;  // ln of likelihoods
  if (against(1.0) <= kContradicted) {
    return 1.0;
  }
  double least = 0.0;
  double beyond = 1.0;
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (least + beyond);
    (against(middle) <= kContradicted ? least : beyond) = middle;
  }
  return least;
}

double rounding_square(double step) {
  return step * step / 12.0;
}

/// Of a converter whose steps are all the noise there is.
double least_power(const Campaign& campaign, std::size_t gauge) {
  return std::max(rounding_square(campaign.step[gauge]), 1e-24);
}

}  // namespace

GaugeNoise::GaugeNoise(const Campaign& campaign, const JudgedBand& band)
    : campaign_(campaign), band_(band) {
  const std::vector<Quiet> quiet = quiet_of_gauges(campaign);
  const std::vector<NoiseSpectrum> spectra = spectra_of(quiet);
  measure(spectra, correlation_of(quiet));
  const auto decimation = static_cast<double>(band.decimation);
  const WindowInRecord place{band.judged, band.begin / band.decimation,
                             campaign.shots.front().quiet_samples / band.decimation,
                             band.decimation,
                             kCarriedFrom * band.filter_Hz * campaign.period_s * decimation};
  carried_ = std::make_unique<CarriedNoise>(spectra[campaign.reference],
                                            least_power(campaign, campaign.reference), place,
                                            band.bins_judged);
  forget();
}

GaugeNoise::~GaugeNoise() = default;

void GaugeNoise::measure(const std::vector<NoiseSpectrum>& spectra,
                         const Eigen::MatrixXd& correlation) {
  // Sums over the decimated window: its samples are the noise's, its power d times less of them.
  const double window = static_cast<double>(band_.judged) / static_cast<double>(band_.decimation);
  const auto samples_judged = static_cast<double>(band_.judged * band_.decimation);
  correlation_ = correlation;
  leaked_.assign(spectra.size(), std::vector<double>(band_.bins_judged, 0.0));
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    const double cycles = band_.frequency_Hz(k) * campaign_.period_s;
    Eigen::VectorXd amplitude(static_cast<Eigen::Index>(spectra.size()));
    for (std::size_t j = 0; j < spectra.size(); ++j) {
      amplitude[static_cast<Eigen::Index>(j)] =
          std::sqrt(window * std::max(spectra[j].power_within(cycles, samples_judged),
                                      least_power(campaign_, j)));
      leaked_[j][k] = window * std::max(0.0, spectra[j].power_within(cycles, samples_judged) -
                                                 spectra[j].power(cycles));
      jumps_ = jumps_ || leaked_[j][k] > 0.0;
    }
    quiet_.emplace_back(amplitude.asDiagonal() * correlation * amplitude.asDiagonal());
  }
}

void GaugeNoise::put_covariance(std::size_t bin, Eigen::MatrixXd& all) const {
  put(scale_, bin, all);
}

void GaugeNoise::put_covariance_but_steps(std::size_t bin, Eigen::MatrixXd& all) const {
  put(knows_steps() ? but_steps_ : scale_, bin, all);
}

void GaugeNoise::put(const Scales& scale, std::size_t bin, Eigen::MatrixXd& all) const {
  const auto gauges = static_cast<Eigen::Index>(scale_.size());
  all.resize(gauges, gauges);
  for (Eigen::Index a = 0; a < gauges; ++a) {
    for (Eigen::Index b = 0; b < gauges; ++b) {
      all(a, b) = covariance(scale, bin, static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    }
  }
}

bool GaugeNoise::shared_with(std::size_t gauge) const {
  const auto own = static_cast<Eigen::Index>(gauge);
  return (quiet_.front().col(own).array() != 0.0).count() > 1;
}

double GaugeNoise::power(std::size_t gauge, std::size_t bin) const {
  const auto j = static_cast<Eigen::Index>(gauge);
  return scale_[gauge][bin] * quiet_[bin](j, j);
}

double GaugeNoise::quiet_power(std::size_t gauge) const {
  const auto j = static_cast<Eigen::Index>(gauge);
  double sum = 0.0;
  for (const Eigen::MatrixXd& power : quiet_) {
    sum += power(j, j);
  }
  const auto n = static_cast<double>(band_.judged);
  return 2.0 * sum / (n * n);
}

void GaugeNoise::carry(std::span<const std::vector<double>> responses, CarriedNoise::Memory& memory,
                       std::vector<CarriedBin>& bins) const {
  carried_->through(responses, memory, bins);
}

void GaugeNoise::forget() {
  but_steps_.clear();
  times_jumps_ = 1.0;
  scale_.assign(campaign_.gauges(), std::vector<double>(band_.bins_judged, 1.0));
}

double GaugeNoise::unrounded_sd(std::size_t gauge) const {
  std::vector<std::span<const double>> records;
  for (const CampaignShot& shot : campaign_.shots) {
    records.emplace_back(shot.strain[gauge]);
  }
  return kolsky::unrounded_sd(records, campaign_.step[gauge]);
}

bool GaugeNoise::is_coarse(std::size_t gauge) const {
  const double step = campaign_.step[gauge];
  const double square = quiet_square(campaign_, gauge);
  // Noise of 0.42 steps leaves a thousandth of the saw teeth; rounding adds its own to it.
  return step > 0.0 && square - rounding_square(step) < 0.18 * step * step;
}

void GaugeNoise::add_steps(std::size_t gauge, std::span<const std::vector<double>> clean) {
  if (!knows_steps()) {
    but_steps_ = scale_;
  }
  const double step = campaign_.step[gauge];
  const double noise_sd = unrounded_sd(gauge);
  DampedTransform transform(clean.front().size(), campaign_.period_s, 1.0);
  std::vector<double> sum(band_.bins_judged, 0.0);
  for (const std::vector<double>& record : clean) {
    const std::vector<double> power =
        rounding_power(transform, record, step, noise_sd, band_.bins_judged);
    std::transform(sum.begin(), sum.end(), power.begin(), sum.begin(), std::plus<>());
  }
  // The judged window's samples are so many times fewer.
  const auto fewer = static_cast<double>(band_.decimation);
  const auto j = static_cast<Eigen::Index>(gauge);
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    const double power = sum[k] / static_cast<double>(clean.size()) / (fewer * fewer);
    scale_[gauge][k] = std::max(scale_[gauge][k], 1.0 + power / quiet_[k](j, j));
  }
}

/// Noise over what the quiet parts say of it, at most: slower than they last its power may grow as
/// fast as that of a random walk. The noise of 177 campaigns with nothing hidden stays within it,
/// but for the odd gauge that reaches 1.1 times as much.
double GaugeNoise::most_hidden(std::size_t bin) const {
  const double quiet_s =
      static_cast<double>(campaign_.shots.front().quiet_samples) * campaign_.period_s;
  const double cycles = band_.frequency_Hz(bin) * quiet_s;
  return kMostHidden * std::max(1.0, 1.0 / (cycles * cycles));
}

void GaugeNoise::learn(std::size_t gauge, const std::vector<double>& power_over_quiet,
                       NoiseShown shown) {
  SmoothPower smooth = smooth_power(power_over_quiet);
  if (shown == NoiseShown::pink_alone) {
    // The quiet tells all of white noise, and drifts are slower than that.
    smooth.white = std::min(1.0, smooth.white);
    smooth.walk = 0.0;
  }
  for (std::size_t k = 0; k < scale_[gauge].size(); ++k) {
    scale_[gauge][k] = smooth.at(static_cast<double>(k + 1));
  }
  if (campaign_.shots.size() == 1) {
    for (double& scale : scale_[gauge]) {
      scale = std::clamp(scale, 1.0, kMostHidden);
    }
  } else if (shown != NoiseShown::all && !is_coarse(gauge)) {
    for (std::size_t k = 0; k < scale_[gauge].size(); ++k) {
      scale_[gauge][k] = std::min(scale_[gauge][k], most_hidden(k));
    }
  }
}

GaugeNoise::QuietPower GaugeNoise::quiet_power_over_known() const {
  std::size_t samples = campaign_.shots.front().quiet_samples;
  for (const CampaignShot& shot : campaign_.shots) {
    samples = std::min(samples, shot.quiet_samples);
  }
  DampedTransform transform = DampedTransform::of_window(samples / 2 * 2, campaign_.period_s);
  const auto bins = std::min(
      transform.bins(), static_cast<std::size_t>(band_.limit_Hz / transform.bin_width_Hz()) + 1);
  QuietPower out;
  for (std::size_t m = 1; m < bins; ++m) {
    out.at_bin.push_back(static_cast<double>(m) * transform.bin_width_Hz() / band_.bin_width_Hz);
  }
  out.shots = static_cast<double>(campaign_.shots.size());
  // Sums over the decimated window, as `measure` has them.
  const double window = static_cast<double>(band_.judged) / static_cast<double>(band_.decimation);
  const double per_power = window / (static_cast<double>(transform.length()) * out.shots);
  std::vector<Complex> spectrum(bins);
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    std::vector<double>& own = out.by_gauge.emplace_back(out.at_bin.size(), 0.0);
    for (const CampaignShot& shot : campaign_.shots) {
      transform.forward(std::span(shot.strain[j]).first(transform.length()), spectrum);
      for (std::size_t m = 0; m < own.size(); ++m) {
        own[m] += per_power * std::norm(spectrum[m + 1]) / power(j, judged_bin(out.at_bin[m]));
      }
    }
  }
  return out;
}

std::size_t GaugeNoise::judged_bin(double at) const {
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(at)), 1, band_.bins_judged) -
         1;
}

/// By how much (ln of likelihoods, Whittle's) a gauge's quiet parts speak against so much of what
/// was learned, for the noise as it was known.
double GaugeNoise::against(const QuietPower& quiet, std::size_t gauge, double share) const {
  double sum = 0.0;
  for (std::size_t m = 0; m < quiet.at_bin.size(); ++m) {
    const double scale = 1.0 + share * (scale_[gauge][judged_bin(quiet.at_bin[m])] - 1.0);
    sum += quiet.shots * (std::log(scale) + quiet.by_gauge[gauge][m] * (1.0 / scale - 1.0));
  }
  return sum;
}

/// Amplifiers are mostly of a kind: what one gauge has far more of than another is no noise.
void GaugeNoise::keep_alike() {
  constexpr double kAlike = 1.5;
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    double least = scale_.front()[k];
    for (const std::vector<double>& own : scale_) {
      least = std::min(least, own[k]);
    }
    for (std::vector<double>& own : scale_) {
      own[k] = std::min(own[k], kAlike * std::max(1.0, least));
    }
  }
}

void GaugeNoise::keep_share(std::size_t gauge, double share) {
  for (double& scale : scale_[gauge]) {
    scale = 1.0 + share * (scale - 1.0);
  }
}

void GaugeNoise::scale_by(const Scales& learned, double share) {
  scale_ = learned;
  for (std::size_t j = 0; j < scale_.size(); ++j) {
    keep_share(j, share);
  }
}

void GaugeNoise::hold_to(const QuietPower& quiet) {
  keep_alike();
  for (std::size_t j = 0; j < scale_.size(); ++j) {
    const auto own = [&](double share) { return against(quiet, j, share); };
    keep_share(j, is_coarse(j) ? 0.0 : most_of(own));
  }
  const double share_of_all = most_of([&](double share) {
    double sum = 0.0;
    for (std::size_t j = 0; j < scale_.size(); ++j) {
      sum += against(quiet, j, share);
    }
    return sum;
  });
  for (std::size_t j = 0; j < scale_.size(); ++j) {
    keep_share(j, share_of_all);
  }
}

double GaugeNoise::flatness() const {
  double least = 1.0;
  for (std::size_t j = 0; j < scale_.size(); ++j) {
    double sum = 0.0;
    double logs = 0.0;
    for (std::size_t k = 0; k < band_.bins_judged; ++k) {
      sum += power(j, k);
      logs += std::log(power(j, k));
    }
    const auto bins = static_cast<double>(band_.bins_judged);
    least = std::min(least, std::exp(logs / bins) / (sum / bins));
  }
  return least;
}

}  // namespace kolsky
