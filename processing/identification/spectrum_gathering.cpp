#include "processing/identification/spectrum_gathering.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

/// Deviations below which J2 of a frequency is not below 0 by chance.
constexpr double kClearly = 4.0;
/// The same of the mean over a band, which scatters 1.4 times as much as it would did neighbouring
/// frequencies of damped records not share their noise.
constexpr double kMeanClearly = 6.0;

}  // namespace

SpectrumGathering::SpectrumGathering(const BarData& data, const BarFit& fit, const BarModel& model,
                                     const DampedBand& band)
    : frequency_Hz_(band.frequency_Hz), axis_(on_axis(band.path)) {
  const auto compliance = model.solid(fit.at);
  fitted_ = bar_modes(fit.theory, model.moved(fit.at).bar, *compliance, axis_);
  for (std::size_t k = 0; k < axis_.size(); ++k) {
    J_axis_.push_back(compliance->at(axis_[k]));
    J_path_.push_back(compliance->at(band.path[k]));
  }
  shots_.resize(data.shots());
  bench_.assign(axis_.size(), {});
}

Complex SpectrumGathering::J(std::size_t k, Complex log_J) const {
  return J_axis_[k] + J_path_[k] * (std::exp(log_J) - 1.0);
}

BarSpectrum SpectrumGathering::spectrum(double widened) const {
  BarSpectrum spectrum;
  spectrum.frequency_Hz = frequency_Hz_;
  for (std::size_t k = 0; k < axis_.size(); ++k) {
    const auto gamma = [&](Complex log_J) {
      return fitted_[k].gamma * std::exp(fitted_[k].slope * std::log(J(k, log_J) / J_axis_[k]));
    };
    append(
        k, widened, [&](Complex x) { return gamma(x).real(); }, spectrum.alpha_per_m);
    append(
        k, widened, [&](Complex x) { return gamma(x).imag(); }, spectrum.wavenumber_per_m);
    append(
        k, widened, [&](Complex x) { return J(k, x).real(); }, spectrum.J1_per_Pa);
    append(
        k, widened, [&](Complex x) { return -J(k, x).imag(); }, spectrum.J2_per_Pa);
  }
  spectrum.mean_loss = mean_loss();
  return spectrum;
}

SpectrumGathering::Mean SpectrumGathering::mean_of(std::size_t k, const OfLogJ& of) const {
  constexpr double kStep = 1e-4;
  const double here = of(0.0);
  Mean mean;
  mean.slope = {(of(kStep) - here) / kStep, (of(Complex(0.0, kStep)) - here) / kStep};
  double weights = 0.0;
  for (const auto& shot : shots_) {
    weights += 1.0 / shot[k].variance;
    mean.value += of(shot[k].log_J) / shot[k].variance;
  }
  mean.value /= weights;
  mean.variance = std::norm(mean.slope) / weights;
  return mean;
}

double SpectrumGathering::variance_by_bench(std::size_t k, Complex slope) const {
  double variance = 0.0;
  for (const Complex cause : bench_[k]) {
    variance += std::pow(slope.real() * cause.real() + slope.imag() * cause.imag(), 2);
  }
  return variance;
}

void SpectrumGathering::append(std::size_t k, double widened, const OfLogJ& of,
                               SpectrumLine& line) const {
  const Mean mean = mean_of(k, of);
  double squares = 0.0;
  for (const auto& shot : shots_) {
    squares += std::pow(of(shot[k].log_J) - mean.value, 2);
  }
  const auto count = static_cast<double>(shots_.size());
  const double bench = variance_by_bench(k, mean.slope);
  const double noise_of_mean = widened * mean.variance;
  const double of_one =
      shots_.size() > 1 ? std::max(squares / (count - 1.0), noise_of_mean) : noise_of_mean;
  line.mean.push_back(mean.value);
  line.sd.push_back(std::sqrt(of_one + bench));
  line.sd_of_mean.push_back(std::sqrt(noise_of_mean + bench));
}

/// What the bench leaves open moves all frequencies together.
MeanLoss SpectrumGathering::mean_loss() const {
  MeanLoss loss;
  double weights = 0.0;
  std::vector<double> by_cause(bench_.empty() ? 0 : bench_.front().size());
  for (std::size_t k = 0; k < axis_.size(); ++k) {
    const Mean mean = mean_of(k, [&](Complex x) { return -J(k, x).imag(); });
    const double sd = std::sqrt(mean.variance + variance_by_bench(k, mean.slope));
    loss.negative += mean.value < -kClearly * sd ? 1 : 0;
    weights += 1.0 / mean.variance;
    loss.J2_per_Pa += mean.value / mean.variance;
    for (std::size_t i = 0; i < by_cause.size(); ++i) {
      const Complex cause = bench_[k][i];
      by_cause[i] +=
          (mean.slope.real() * cause.real() + mean.slope.imag() * cause.imag()) / mean.variance;
    }
  }
  double variance = weights;
  for (const double cause : by_cause) {
    variance += cause * cause;
  }
  loss.J2_per_Pa /= weights;
  loss.sd_per_Pa = std::sqrt(variance) / weights;
  return loss;
}

bool MeanLoss::gains() const {
  return negative > 0 || J2_per_Pa < -kMeanClearly * sd_per_Pa;
}

}  // namespace kolsky
