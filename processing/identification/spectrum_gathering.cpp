#include "processing/identification/spectrum_gathering.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

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

BarSpectrum SpectrumGathering::spectrum(double widened) const {
  BarSpectrum spectrum;
  spectrum.frequency_Hz = frequency_Hz_;
  for (std::size_t k = 0; k < axis_.size(); ++k) {
    const auto J = [&](Complex log_J) { return J_axis_[k] + J_path_[k] * (std::exp(log_J) - 1.0); };
    const auto gamma = [&](Complex log_J) {
      return fitted_[k].gamma * std::exp(fitted_[k].slope * std::log(J(log_J) / J_axis_[k]));
    };
    append(
        k, widened, [&](Complex x) { return gamma(x).real(); }, spectrum.alpha_per_m);
    append(
        k, widened, [&](Complex x) { return gamma(x).imag(); }, spectrum.wavenumber_per_m);
    append(
        k, widened, [&](Complex x) { return J(x).real(); }, spectrum.J1_per_Pa);
    append(
        k, widened, [&](Complex x) { return -J(x).imag(); }, spectrum.J2_per_Pa);
  }
  return spectrum;
}

void SpectrumGathering::append(std::size_t k, double widened,
                               const std::function<double(Complex)>& of, SpectrumLine& line) const {
  constexpr double kStep = 1e-4;
  const double here = of(0.0);
  const Complex slope((of(kStep) - here) / kStep, (of(Complex(0.0, kStep)) - here) / kStep);
  double weights = 0.0;
  double sum = 0.0;
  for (const auto& shot : shots_) {
    weights += 1.0 / shot[k].variance;
    sum += of(shot[k].log_J) / shot[k].variance;
  }
  const double mean = sum / weights;
  double squares = 0.0;
  for (const auto& shot : shots_) {
    squares += std::pow(of(shot[k].log_J) - mean, 2);
  }
  const auto count = static_cast<double>(shots_.size());
  double bench = 0.0;
  for (const Complex cause : bench_[k]) {
    bench += std::pow(slope.real() * cause.real() + slope.imag() * cause.imag(), 2);
  }
  const double noise_of_mean = widened * std::norm(slope) / weights;
  const double of_one =
      shots_.size() > 1 ? std::max(squares / (count - 1.0), noise_of_mean) : noise_of_mean;
  line.mean.push_back(mean);
  line.sd.push_back(std::sqrt(of_one + bench));
  line.sd_of_mean.push_back(std::sqrt(noise_of_mean + bench));
}

}  // namespace kolsky
