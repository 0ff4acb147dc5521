#pragma once

#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// What single shots say of an effect's strength.
struct ShotStrengths {
  std::vector<double> over_common;  ///< each shot's strength over the common one
  std::vector<double> weight;       ///< one over the variances of these

  /// The chi2 that strengths of their own would gain over strengths in proportion to `like`.
  [[nodiscard]] double departure_from(const std::vector<double>& like) const;
  [[nodiscard]] double disagreement() const;
  [[nodiscard]] double freedom() const;
};

/// @return nothing for strengths that are each shot's own, or fewer than three shots
[[nodiscard]] ShotStrengths shot_strengths(const Studied& studied, const std::string& id,
                                           std::size_t residuals_per_shot);

/// A drift or a hum, as against what is done to the waves' own readings.
[[nodiscard]] bool is_addition(const Effect& effect);

/// What is known of the noise beforehand counts as much as this many shots; of slow noise, among
/// which additions to a record are sought, little is known.
[[nodiscard]] double belief_in(const Effect& effect);

/// With what the residuals of three shots or more say: the flatter the noise, the more frequencies
/// tell of its power in any direction.
[[nodiscard]] double belief_in(const Effect& effect, const GaugeNoise& noise, std::size_t shots);

/// How much more than noise the shots differ in the direction of an effect's strength: noise
/// whose frequencies hang together scatters more there than its spectrum says. At least 1.
[[nodiscard]] double scatter_over_noise(const Studied& studied, const std::string& id,
                                        std::size_t residuals_per_shot);

/// An effect with the right shape but the wrong name has strengths that differ from shot to shot by
/// more than noise, and by more than a small part of what it explains. Of what is added to the
/// records, slow noise makes strengths differ anyway: there it tells that they follow the shots'
/// amplitudes.
/// @param gain  of chi2 over the noise that the effect brought
[[nodiscard]] bool shots_agree(const Studied& studied, double gain, const std::string& id,
                               const Campaign& campaign, std::size_t residuals_per_shot);

}  // namespace kolsky
