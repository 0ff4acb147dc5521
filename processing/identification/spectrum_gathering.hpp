#pragma once

#include <functional>
#include <vector>

#include "processing/identification/bar_model.hpp"
#include "processing/identification/bar_spectrum.hpp"
#include "processing/identification/damped_band.hpp"

namespace kolsky {

/// One estimate of log J at a frequency, and its variance in each of real and imaginary part.
struct LogEstimate {
  Complex log_J;  ///< over the fitted one
  double variance = 0.0;
};

/// Gathers estimates of log (J / J fitted) over shots, and what the bench leaves open of them.
class SpectrumGathering {
 public:
  SpectrumGathering(const BarData& data, const BarFit& fit, const BarModel& model,
                    const DampedBand& band);

  void add(std::size_t shot, LogEstimate estimate) { shots_[shot].push_back(estimate); }
  /// Standard deviations that the bench gives log J, one complex number per independent cause.
  void add_bench(std::size_t k, std::vector<Complex> causes) { bench_[k] = std::move(causes); }
  /// What the estimates are relative to, off the axis.
  [[nodiscard]] Complex fitted_off_axis(std::size_t k) const { return J_path_[k]; }

  [[nodiscard]] BarSpectrum spectrum(double widened) const;

 private:
  using OfLogJ = std::function<double(Complex)>;
  /// A number's mean over shots at a frequency, how it follows log J (real part: by its real part),
  /// and the variance that the shots' noise alone gives the mean.
  struct Mean {
    double value = 0.0;
    Complex slope;
    double variance = 0.0;
  };

  [[nodiscard]] Complex J(std::size_t k, Complex log_J) const;
  [[nodiscard]] Mean mean_of(std::size_t k, const OfLogJ& of) const;
  [[nodiscard]] double variance_by_bench(std::size_t k, Complex slope) const;
  void append(std::size_t k, double widened, const OfLogJ& of, SpectrumLine& line) const;
  [[nodiscard]] MeanLoss mean_loss() const;

  std::vector<double> frequency_Hz_;
  std::vector<Complex> axis_;
  std::vector<BarMode> fitted_;
  std::vector<Complex> J_axis_;
  std::vector<Complex> J_path_;
  std::vector<std::vector<LogEstimate>> shots_;
  std::vector<std::vector<Complex>> bench_;
};

}  // namespace kolsky
