#pragma once

#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"

namespace kolsky {

/// A number at every frequency: over shots, weighted by what each shot's noise leaves of it.
struct SpectrumLine {
  std::vector<double> mean;
  /// Of one shot's value: over shots (of a single shot, from its noise), and what the known
  /// unknowns of the bench leave open.
  std::vector<double> sd;
  std::vector<double> sd_of_mean;  ///< from the noise of all shots and the bench
};

/// J2 averaged over the band, each frequency weighted by what noise leaves of it. Deviations grow
/// with what a fit leaves beyond noise, and nothing that a passive material can do fits waves that
/// grow: so it is judged by noise, and by what the bench leaves open, alone.
struct MeanLoss {
  double J2_per_Pa = 0.0;
  double sd_per_Pa = 0.0;
  std::size_t negative = 0;  ///< frequencies at which J2 is below 0 by four such deviations of it

  /// Whether waves grow on their way, by more than chance has once in some thousand bars.
  [[nodiscard]] bool gains() const;
};

/// Propagation and compliance J = J1 - i J2 of a bar's material by frequency.
struct BarSpectrum {
  std::vector<double> frequency_Hz;
  SpectrumLine alpha_per_m, wavenumber_per_m, J1_per_Pa, J2_per_Pa;
  MeanLoss mean_loss;

  [[nodiscard]] bool empty() const { return frequency_Hz.empty(); }
};

/// alpha, k and J at each frequency by itself, by maximum likelihood with each gauge's noise: the
/// source is free, the far end returns what the fit says, so that all of the record serves,
/// overlapped or not. Gains and positions are those of the fit, with its deviations. Records are
/// damped so that their cut ends do not matter, which gives J off the imaginary axis; the way back
/// to it is that of the fitted solid.
[[nodiscard]] BarSpectrum likely_spectrum(const BarData& data, const BarFit& fit);

/// The paper's analysis (A1, A2): straight lines through the logarithm and the unwrapped phase of
/// the incident pulse's spectra over position, elementary waves, J from k^2 - alpha^2 and 2 alpha
/// k. Of the records up to where the far end's return arrives; phases are unwrapped from the lowest
/// frequency up, less the delay by which the pulses rise. Empty where the pulse has not gone before
/// its return arrives.
[[nodiscard]] BarSpectrum straight_line_spectrum(const BarData& data, const BarFit& fit);

/// Three-element solid through J1 and J2 of a spectrum up to a frequency, by least squares (paper,
/// A3). Empty where that does not converge.
[[nodiscard]] std::vector<FittedNumber> three_elements_through(const BarSpectrum& spectrum,
                                                               double up_to_Hz);

}  // namespace kolsky
