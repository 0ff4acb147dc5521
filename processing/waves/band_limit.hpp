#pragma once

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "processing/waves/transform.hpp"

namespace kolsky {

/// The band in which a pulse stands above the noise, and the low-pass that keeps it.
///
/// Carrying a wave back multiplies its spectrum by exp(+alpha l), which grows with frequency: what
/// holds only noise must go first. The filter is exp(-(s/wc)^4), on the imaginary axis
/// exp(-(w/wc)^4): flat where the pulse is, hardly any ringing, no shift in time, and exact off the
/// axis too. It passes half at the limit.
class BandLimit {
 public:
  /// Power over noise, averaged over neighbouring bins, that noise alone passes once in some 10^5
  /// places.
  static constexpr double kAlike = 2.0;

  /// @param transform      whose spectra are filtered
  /// @param pulse_samples  longest pulse that is judged
  BandLimit(const DampedTransform& transform, std::size_t pulse_samples);

  /// The frequency [Hz] up to which the pulse's power, averaged over neighbouring bins, is above
  /// twice that of white noise, so that pulse and noise are alike; at most a fifth of the
  /// sampling rate. Of a noiseless pulse: that fifth. The noise is that before the pulse, or what
  /// the octave below that fifth holds, if that is more: a converter of few bits makes none while
  /// nothing moves.
  /// @param pulse      the samples that hold it, and little else; no more than `pulse_samples`
  /// @param noise_rms  of its samples
  /// @param power_over_noise  at the limit, where more is wanted than that pulse and noise are
  /// alike
  [[nodiscard]] double from_noise(std::span<const double> pulse, double noise_rms,
                                  double power_over_noise = kAlike);

  /// Share of a pulse's energy, less that of its noise, that the filter with this limit takes off.
  [[nodiscard]] double loss(std::span<const double> pulse, double noise_rms, double limit_Hz);

  /// Sum of a pulse's squares, less that of its noise, of what the filter with this limit lets
  /// through, each frequency [Hz] by its weight.
  [[nodiscard]] double weighed_energy(std::span<const double> pulse, double noise_rms,
                                      double limit_Hz, const std::function<double(double)>& weight);

  /// Multiplies a spectrum, or its first bins, by the filter with this limit.
  void apply(double limit_Hz, std::span<Complex> spectrum);

  /// By the filter's square root: a wave that is cut in time between two steps is filtered before
  /// and after.
  void apply_half(double limit_Hz, std::span<Complex> spectrum);

  /// Share of white noise's rms that the filter lets through.
  [[nodiscard]] double noise_share(double limit_Hz) const;

  /// Bins in which a filter with this limit leaves more than 1e-18.
  [[nodiscard]] static std::size_t bins_within(const DampedTransform& transform, double limit_Hz);

  /// At how many times its limit the filter has fallen to a share of what it passes.
  [[nodiscard]] static double falls_to(double share);

  /// How far the filter's kernel reaches to each side, in seconds (where it has fallen to a tenth).
  [[nodiscard]] static double smear_s(double limit_Hz);

  /// From how far before a step in time on, in seconds, the filter shows less than half a per cent
  /// of it: what a record that ends under a wave can be believed up to. One smear before it is off
  /// by 4 % of that wave.
  [[nodiscard]] static double reach_s(double limit_Hz);

 private:
  [[nodiscard]] double floor_below(std::size_t top);
  /// A filter and its square root, one gain a bin.
  struct Filter {
    std::vector<Complex> whole;
    std::vector<Complex> half;
  };
  const Filter& filter(double limit_Hz);

  std::vector<Complex> s_;
  double sampling_frequency_Hz_;
  DampedTransform pulse_transform_;
  std::vector<Complex> pulse_spectrum_;
  std::vector<double> floor_;
  std::map<double, Filter> filters_;
};

}  // namespace kolsky
