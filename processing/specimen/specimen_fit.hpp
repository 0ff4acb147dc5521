#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"
#include "processing/specimen/shpb_model.hpp"

namespace kolsky {

struct SpecimenFitOptions {
  SolidKind solid = SolidKind::three_element;
  std::optional<WaveTheory> bars;         ///< else elementary, unless the data speak for exact
  std::optional<SpecimenWaves> specimen;  ///< else massless, unless the data speak for its mass
  double band_limit_Hz = 0.0;             ///< 0: where the pulses fall below the noise
  std::optional<double> most_band_Hz;     ///< in which the bars are known
  /// Judged after the pulse's foot at the first station. None: until a far end answers, and on to
  /// the record's end where the same model holds there too.
  std::optional<double> after_foot_s;
  /// Three elements without any loss; else only where a loss is sought without end.
  bool lossless = false;
  /// Three elements' parameters to begin from; none: a coarse grid's best places.
  std::vector<double> start{};
};

/// A set of assumptions that was tried, and how far it leaves more than noise.
struct TriedTheory {
  ShpbTheory theory;
  double chi2 = 0.0;                           ///< NaN where it could not be fitted
  SolidKind solid = SolidKind::three_element;  ///< with which it was tried
  std::string refused{};                       ///< why it could not be fitted; else empty
};

/// What three elements make of the records that another family was fitted to.
struct ThreeElementsBeside {
  std::vector<FittedNumber> parameters;
  double chi2_gain = 0.0;  ///< by so much the family's chi2 is less, under the same theory
};

/// One frequency of the specimen's compliance J = J1 - i J2.
struct CompliancePoint {
  double frequency_Hz = 0.0;
  double J1_per_Pa = 0.0;
  double J2_per_Pa = 0.0;
  double J1_sd = 0.0;  ///< of one shot; what all shots share (bench, bars) is in it too
  double J2_sd = 0.0;
  double J1_sd_of_mean = 0.0;  ///< of the mean over the shots
  double J2_sd_of_mean = 0.0;
};

/// The maximum-likelihood fit of a specimen's compliance to whole gauge records of all shots.
struct SpecimenFit {
  SolidKind solid = SolidKind::three_element;
  bool lossless = false;  ///< as good as elastic with E1: what else there is stands for no branch
  std::vector<FittedNumber> parameters;         ///< of the solid, in its order
  std::vector<std::vector<double>> covariance;  ///< of the solid's parameters
  std::vector<FittedNumber> bench;  ///< moves of the known unknowns: relative, or in metres
  /// Covariance of each parameter with each of these moves in their filed deviations: by so much a
  /// deviation of the bench, whatever specimen is on it, moves the parameter.
  std::vector<std::vector<double>> by_bench;
  ShpbTheory theory;
  std::vector<TriedTheory> tried;
  /// None where the family is three elements, or where those cannot be fitted.
  std::optional<ThreeElementsBeside> three_element;
  double chi2_reduced = 0.0;  ///< 1 where the model leaves noise alone
  std::size_t degrees_of_freedom = 0;
  double band_limit_Hz = 0.0;
  double judged_s = 0.0;      ///< of each record
  double after_foot_s = 0.0;  ///< until so long after the pulse's foot; 0: to the record's end
  bool to_the_end = false;    ///< judged past the far ends' first answers
  std::vector<CompliancePoint> spectrum;
  std::vector<std::string> warnings;  ///< what keeps the result from being taken at its word
};

/// Fits one specimen material to any number of shots at once, sources free. The deviations include
/// those of the bench's known unknowns and of the bars' moduli; where chi2_reduced exceeds 1 they
/// are widened by its square root. Another family than three elements is searched from where those
/// are at their best, under the theory and in the window that they take; where it takes more off
/// chi2 than they can, theory and window are decided anew with it.
/// @throws InputError as SpecimenLikelihood, and where the search does not converge
[[nodiscard]] SpecimenFit fit_specimen(const std::vector<Shot>& shots, const BarPrior& bars,
                                       const SpecimenFitOptions& options);

}  // namespace kolsky
