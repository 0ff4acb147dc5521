#pragma once

#include <span>
#include <vector>

namespace kolsky {

/// Power of a gauge's noise over frequency, from quiet stretches of its records: an autoregressive
/// model whose order is chosen by Schwarz's criterion (Akaike's takes white noise for coloured too often), because a few hundred samples are too few for
/// an averaged periodogram at the frequencies where the pulses live. White noise comes out with
/// order 0.
class NoiseSpectrum {
 public:
  /// @param quiet  stretches of one gauge, each taken about its own mean; empty ones are passed
  /// over
  explicit NoiseSpectrum(const std::vector<std::span<const double>>& quiet);

  /// Power per sample at a frequency in cycles per sample: for white noise its variance.
  [[nodiscard]] double power(double cycles_per_sample) const;

  [[nodiscard]] std::size_t order() const { return coefficients_.size(); }

 private:
  double innovation_ = 0.0;           ///< variance of what drives the model
  std::vector<double> coefficients_;  ///< x[n] + sum a[i] x[n-1-i] = innovation
};

}  // namespace kolsky
