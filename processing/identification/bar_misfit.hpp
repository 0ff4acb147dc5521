#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace kolsky {

/// Above this reduced chi2 a fit leaves more than noise.
inline constexpr double kMoreThanNoise = 1.3;

/// What a fit leaves of a bar's shots in one octave of frequency, in the power of what is taken for
/// noise: 1 where it is noise alone.
struct OctaveLeft {
  double low_Hz = 0.0;
  double high_Hz = 0.0;
  double numbers = 0.0;    ///< that are judged of each shot
  double of_all = 1.0;     ///< mean over the shots
  double in_common = 1.0;  ///< of what they have in common, as one shot (see BarData::all_as_one)
  /// As how many independent numbers of one variance they scatter: fewer where weights are not the
  /// noise's everywhere or bins are tied to each other, as where a bar without loss rings.
  double count_as = 0.0;

  /// Of what they do not have in common; of a single shot there is no such thing.
  [[nodiscard]] double apart(std::size_t shots) const;
};

/// Whether what the shots have in common goes beyond what they do not have in common by more than
/// chance, by Fisher's ratio of variances: for octaves of a model that fits once in a thousand
/// times. Never of a single shot, of which noise and misfit cannot be told apart.
[[nodiscard]] bool beyond_chance(const OctaveLeft& octave, std::size_t shots);

/// That a model does not fit: what all shots' residuals have in common goes beyond what they do not
/// have in common, which is noise. Noise has no reason to repeat, whatever its spectrum.
struct CommonMisfit {
  double low_Hz = 0.0;  ///< the octave in which it is farthest from chance
  double high_Hz = 0.0;
  double power = 0.0;       ///< there, of the noise's
  double deviations = 0.0;  ///< how far from chance, in a normal number's standard deviations
};

/// The octave that is farthest beyond chance; nothing where none is.
[[nodiscard]] std::optional<CommonMisfit> common_misfit(const std::vector<OctaveLeft>& left,
                                                        std::size_t shots);

/// Standard normal number that is exceeded as rarely as a ratio of two variances of normal numbers
/// (Paulson's approximation, Ann. Math. Stat. 13 (1942) 233).
/// @param above, below  degrees of freedom of the two variances
[[nodiscard]] double normal_of_variance_ratio(double ratio, double above, double below);

}  // namespace kolsky
