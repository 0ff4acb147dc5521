#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/identification/bar_fit.hpp"
#include "processing/specimen/specimen_fit.hpp"
#include "processing/specimen/specimen_spectrum.hpp"
#include "processing/uncertainty/scatter.hpp"

namespace kolsky {

struct FitDrawOptions {
  std::size_t draws = 200;
  std::uint64_t seed = 1;
  /// Told of each draw that is done, by whichever worker did it.
  std::function<void(std::size_t done, std::size_t of)> progress = [](std::size_t, std::size_t) {};
};

/// Fewer say nothing of a deviation, let alone of an interval.
inline constexpr std::size_t kFewestDraws = 20;

/// What draws make of the numbers of one estimator.
struct DrawnNumbers {
  std::size_t draws = 0;                 ///< that gave a result
  std::size_t failed = 0;                ///< in which nothing was found, or numbers without bounds
  std::vector<UncertainFigure> figures;  ///< empty where fewer than kFewestDraws gave a result
  std::vector<std::string> warnings;     ///< what the figures do not hold
};

/// What draws make of identified numbers.
struct FitDraws {
  DrawnNumbers fit;                      ///< to the records
  std::optional<DrawnNumbers> spectral;  ///< of strain over stress (25), where it is drawn too
};

/// Propagates what is filed with a deviation, and the gauges' noise as it is before the pulses,
/// through the identification of a specimen itself (GUM supplement 1): each draw moves every source
/// of bench and bars by a normal number, the same for all shots, adds noise of the measured
/// spectrum to the samples and is fitted like the shots, from where they led. Theory, band and
/// window are the fit's, and how waves are told apart the estimate's. What a model leaves
/// undescribed, and theories that are not told apart, are not in the draws; where the fit states
/// more for that, a warning says so. Each draw's samples hold noise twice, the shots' own and what
/// is added, and count for that much less beside what is filed: at worst that widens the scatter by
/// 6 %. The same seed gives the same numbers, however the workers share it.
/// @param fit       of these shots with these bars
/// @param spectral  of these shots with the fit's theory; null: none
[[nodiscard]] FitDraws draw_specimen_fits(const std::vector<Shot>& shots, const BarPrior& bars,
                                          const SpecimenFit& fit, const SpectralEstimate* spectral,
                                          const FitDrawOptions& options, const Workers& workers);

/// The same for a bar by itself, whose moduli are what is found: of one that shows no loss E1
/// alone, for the rest stands for none.
/// @param fit  of these shots
[[nodiscard]] FitDraws draw_bar_fits(const std::vector<Shot>& shots, const BarFit& fit,
                                     const FitDrawOptions& options, const Workers& workers);

/// Deviations of what strain over stress (25) finds, at least those that the gauges' noise makes by
/// itself: 60 draws of it, the bench as filed. How far points lie off the fit says little of it,
/// for neighbouring ones are off together, nor do two or three shots by how they scatter: stated
/// so, deviations of one or two shots were a fifth of the errors, of three a third.
/// @param theory  of waves in the bars, by which it was estimated
void take_in_noise(const std::vector<Shot>& shots, const Material& bars, WaveTheory theory,
                   SpectralEstimate& estimate, const Workers& workers);

}  // namespace kolsky
