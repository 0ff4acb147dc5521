#pragma once

#include <cstdint>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/criticism/study.hpp"

namespace kolsky {

/// Puts effects of known size into measured shots, in raw codes, so that the captures' own noise
/// and whatever else is in them stays.
///
/// What an effect does to a record is reckoned by the models that later look for it: the wave at
/// the reference gauge, smoothed to the judged band, goes through the fitted model with the effect
/// and without. A real effect never fits its model so well; what is found here is found at best.
class Planter {
 public:
  /// @param shots    as measured, those of study.campaign()
  /// @param studied  of this study: the model that the wave goes through
  Planter(const std::vector<Shot>& shots, Study& study, const Studied& studied);

  /// Why an effect cannot be planted; empty where it can: a specimen whose answer is not linear.
  [[nodiscard]] std::string impossible_because(const EffectUse& use) const;

  /// The measured shots with the effect added, rounded to codes again. An effect with a strength at
  /// every gauge has the opposite one at every other.
  [[nodiscard]] std::vector<Shot> planted(const EffectUse& use) const;

  /// Shots as the fitted model foretells them, with noise drawn anew: it has the spectrum, and the
  /// covariance between gauges, of the samples before the pulses. Nothing is in them that the model
  /// does not hold.
  [[nodiscard]] std::vector<Shot> drawn_anew(std::uint64_t seed) const;

 private:
  using Record = std::vector<double>;

  [[nodiscard]] std::vector<Record> through(const Composition& composition,
                                            const std::vector<double>& theta,
                                            std::size_t shot) const;
  [[nodiscard]] std::vector<Record> fresh_noise(std::size_t shot, std::uint64_t seed) const;
  void find_waves();

  const std::vector<Shot>& shots_;
  const Campaign& campaign_;
  const Studied& studied_;
  double smoothing_rad_per_s_;
  std::vector<Record>
      waves_;  ///< by shot: at the reference gauge, smoothed, nothing before the foot
  std::vector<Complex> path_;
};

/// Whether an effect makes a difference that grows with its sign: a strength that may be negative.
[[nodiscard]] bool two_sided(const EffectUse& use);

}  // namespace kolsky
