#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kolsky {

/// Power of a gauge's noise over frequency, from quiet stretches of its records, which are short:
/// a few hundred samples, in which slow noise shows hardly at all but does as much harm as it can.
/// Two families of models compete by Whittle's likelihood and Akaike's criterion,
///   white noise and parts with first-order correlation, times from a sample to several stretches;
///   an autoregressive model (noise that is shaped at high frequencies),
/// each as simple as the data allow: white noise comes out as white. A stretch's own mean is
/// unknown and its ends leak: the first family is compared as a stretch of that length shows it.
class NoiseSpectrum {
 public:
  /// Mean power, per sample, that longer stretches of the same noise show at whole cycles of their
  /// length: what quiet stretches are too short for.
  struct Seen {
    double samples = 0.0;    ///< of a stretch
    double stretches = 0.0;  ///< over how many the mean goes
    std::vector<double> cycles;
    std::vector<double> power;
  };

  /// @param quiet  stretches of one gauge, each taken about its own mean; empty ones are passed
  /// over
  explicit NoiseSpectrum(const std::vector<std::span<const double>>& quiet);
  NoiseSpectrum(const std::vector<std::span<const double>>& quiet, const Seen& seen);

  /// Of several gauges, whose amplifiers are mostly of a kind: where their spectra, each at its own
  /// level, differ by no more than chance, all have the shape that they show together. Slow noise
  /// is then known several times as well. @param seen  by gauge
  [[nodiscard]] static std::vector<NoiseSpectrum> of_gauges(
      const std::vector<std::vector<std::span<const double>>>& quiet,
      const std::vector<Seen>& seen);

  /// Power per sample at a frequency in cycles per sample: for white noise its variance.
  [[nodiscard]] double power(double cycles_per_sample) const;

  /// The same as a stretch of so many samples shows it, its ends leaking: what is slow spreads over
  /// the frequencies above.
  [[nodiscard]] double power_within(double cycles_per_sample, double samples) const;

  /// First-order noise: neighbouring samples are correlated by `keep`.
  struct SlowPart {
    double variance = 0.0;
    double keep = 0.0;
    /// @param samples  of the stretch that shows it; 0: without end
    [[nodiscard]] double power(double cycles_per_sample, double samples = 0.0) const;
    [[nodiscard]] double variance_of_mean(double samples) const;
    /// Neighbouring samples are much alike.
    [[nodiscard]] bool is_slow() const { return keep > 0.8; }
  };
  /// The parts that are not white. None of a model that is shaped otherwise.
  [[nodiscard]] const std::vector<SlowPart>& slow_parts() const { return slow_; }

  /// Variance of the mean of so many neighbouring samples.
  [[nodiscard]] double variance_of_mean(std::size_t samples) const;

  /// Numbers beyond the white noise's variance that the model has.
  [[nodiscard]] std::size_t order() const;

 private:
  struct Autoregression {
    double innovation = 0.0;           ///< variance of what drives the model
    std::vector<double> coefficients;  ///< x[n] + sum a[i] x[n-1-i] = innovation
    [[nodiscard]] double power(double cycles_per_sample) const;
  };
  class Fit;

  [[nodiscard]] NoiseSpectrum at_level(double level) const;
  static Autoregression autoregression(const std::vector<std::span<const double>>& quiet);

  double white_ = 0.0;
  std::vector<SlowPart> slow_;
  Autoregression shaped_;  ///< in force where its innovation is above zero
};

}  // namespace kolsky
