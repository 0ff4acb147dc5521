#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/identification/solids.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

struct BarFitOptions {
  SolidKind solid = SolidKind::three_element;
  WaveTheory theory = WaveTheory::exact;
  double band_limit_Hz = 0.0;  ///< 0: where the pulses fall below the noise
};

/// A fitted number: of the material, or a known unknown of the bench.
struct FittedNumber {
  std::string name;
  double value = 0.0;
  double sd = 0.0;
};

/// The maximum-likelihood fit of a bar's material to whole gauge records (see BarLikelihood).
struct BarFit {
  SolidKind solid = SolidKind::three_element;
  WaveTheory theory = WaveTheory::exact;
  std::vector<FittedNumber> parameters;         ///< of the solid, in its order
  std::vector<std::vector<double>> covariance;  ///< of the solid's parameters
  std::vector<FittedNumber> bench;  ///< what the fit says of the known unknowns, in their own units
  double chi2_reduced = 0.0;        ///< 1 where the model leaves noise alone
  std::size_t degrees_of_freedom = 0;
  double log_evidence =
      0.0;  ///< -(chi2 + parameters log data) / 2: families and theories compare by it
  double band_limit_Hz = 0.0;
  std::string
      warning;  ///< what keeps the result from being taken at its word; empty where nothing does
};

/// Fits one bar's material to any number of shots at once. The deviations include those of the
/// bench's known unknowns; where chi2_reduced exceeds 1 they are widened by its square root.
/// @throws InputError as BarLikelihood, and where the search does not converge
[[nodiscard]] BarFit fit_bar(const std::vector<Shot>& shots, const BarFitOptions& options);

}  // namespace kolsky
