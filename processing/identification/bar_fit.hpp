#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/identification/bar_data.hpp"
#include "processing/identification/bar_misfit.hpp"
#include "processing/identification/bar_model.hpp"

namespace kolsky {

struct BarFitOptions {
  SolidKind solid = SolidKind::three_element;
  WaveTheory theory = WaveTheory::exact;
  double band_limit_Hz = 0.0;  ///< 0: where the pulses fall below the noise
  FarEndReturn far_end = FarEndReturn::free;
};

/// A fitted number: of the material, or a known unknown of the bench.
struct FittedNumber {
  std::string name;
  double value = 0.0;
  double sd = 0.0;
};

[[nodiscard]] std::vector<double> values_of(const std::vector<FittedNumber>& numbers);
[[nodiscard]] std::vector<std::string> names_of(const std::vector<FittedNumber>& numbers);
/// With their deviations.
[[nodiscard]] std::vector<Measured> measured_of(const std::vector<FittedNumber>& numbers);

/// As a material file has a covariance.
[[nodiscard]] std::vector<double> row_by_row(const std::vector<std::vector<double>>& matrix);

/// What one shot by itself says of the solid, the bench as all shots together have it.
struct ShotEstimate {
  std::vector<FittedNumber> parameters;
  double chi2_reduced = 0.0;
};

/// The maximum-likelihood fit of a bar's material to whole gauge records (see BarLikelihood).
struct BarFit {
  SolidKind solid = SolidKind::three_element;
  WaveTheory theory = WaveTheory::exact;
  FarEndReturn far_end = FarEndReturn::free;
  bool lossless = false;                        ///< E2 and eta2 stand for none
  std::vector<FittedNumber> parameters;         ///< of the solid, in its order
  std::vector<std::vector<double>> covariance;  ///< of the solid's parameters
  std::optional<FittedNumber> reflection;  ///< stress returned by the far end, where it is fitted
  std::vector<FittedNumber> bench;  ///< what the fit says of the known unknowns, in their own units
  /// Covariance of each parameter with each of these, in filed deviations of these.
  std::vector<std::vector<double>> by_bench;
  std::vector<ShotEstimate> shots;
  double chi2_reduced = 0.0;  ///< 1 where the model leaves noise alone
  /// Where the model does not fit: deviations are widened for it, which is no more than a guess at
  /// what they then are.
  std::optional<CommonMisfit> misfit;
  std::size_t degrees_of_freedom = 0;
  double log_evidence =
      0.0;  ///< -(chi2 + parameters log data) / 2: families and theories compare by it
  double band_limit_Hz = 0.0;
  std::string
      warning;  ///< what keeps the result from being taken at its word; empty where nothing does
  std::vector<double> at;                      ///< in BarModel's parameters
  std::vector<std::vector<double>> posterior;  ///< covariance of `at`
};

/// A loss is seen that is known at least as well as this, as deviation of its number's logarithm:
/// above zero by three deviations.
inline constexpr double kWidestLogOfALoss = 0.3;

/// Fits one bar's material to any number of shots at once. The deviations include those of the
/// bench's known unknowns; where the fit leaves more than noise they are widened for it, as if what
/// it leaves were chance. The
/// solid's parameters have a prior of five natural logarithms' deviation about values typical of
/// the wave's speed: it matters only to those that the data leave open.
/// @throws InputError as BarData, and where the search does not converge
[[nodiscard]] BarFit fit_bar(const std::vector<Shot>& shots, const BarFitOptions& options);

/// The same on data that are ready. Where a bar shows no loss, its retardation can be anything and
/// a search may not end; it does from the elastic fit. @param start  in BarModel's parameters;
/// empty: from the pulses'
///   speed and decay
[[nodiscard]] BarFit fit_bar(const BarData& data, const BarTheory& theory,
                             const std::vector<double>& start = {});

/// Data of shots on one bar. Of a bar with one gauge: by a first fit of three elements and of what
/// is asked, as far as that goes, what the first pass leaves under the return is taken off, and
/// again by the next fit, until that no longer moves it.
[[nodiscard]] BarData bar_data(const std::vector<Shot>& shots, double band_limit_Hz,
                               WaveTheory theory = WaveTheory::elementary);

/// Where a search for a solid may begin: logarithms of its parameters, in its order.
[[nodiscard]] std::vector<double> first_guess(const BarData& data, SolidKind solid);

}  // namespace kolsky
