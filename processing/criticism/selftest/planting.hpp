#pragma once

#include <cstdint>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/criticism/fitting/source_waves.hpp"
#include "processing/criticism/fitting/study.hpp"

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

  /// Shots as the fitted model foretells them, filed numbers drawn within their deviations, with
  /// noise drawn anew: it has the spectrum, and the covariance between gauges, of the samples
  /// before the pulses. Nothing is in them that the model does not hold.
  [[nodiscard]] std::vector<Shot> drawn_anew(std::uint64_t seed) const;

 private:
  using Record = std::vector<double>;

  [[nodiscard]] std::vector<Record> through(const Composition& composition,
                                            const std::vector<double>& theta,
                                            std::size_t shot) const;

  const std::vector<Shot>& shots_;
  const Campaign& campaign_;
  const Studied& studied_;
  SourceWaves waves_;
};

/// The model with an effect in the place of what it holds of it.
[[nodiscard]] Model with_use(const Model& model, const EffectUse& use);

/// A fit's numbers, with an effect as `use` has it: the opposite strength at every other gauge
/// where it has one at each, a filed number moved from where the fit has it.
/// @param composition  of with_use()
[[nodiscard]] std::vector<double> numbers_with(const Studied& studied,
                                               const Composition& composition, const EffectUse& use,
                                               std::size_t gauges);

/// A fit's numbers with the filed ones drawn anew from what is filed of them. Where a fit has put
/// them they may stand in for what the model lacks, and shots of that would not be shots of
/// nothing.
[[nodiscard]] std::vector<double> drawn_as_filed(const Studied& studied, std::uint64_t seed);

/// Noise of one shot, by gauge: with the spectrum, and the covariance between gauges, of all
/// samples before the pulses. Strain.
[[nodiscard]] std::vector<std::vector<double>> fresh_noise(const Campaign& campaign,
                                                           std::size_t shot, std::uint64_t seed);

/// A channel with so much strain more at a gauge, rounded to codes again.
/// @param strain  as it was, by sample
void add_strain(const Campaign& campaign, std::size_t gauge, const std::vector<double>& strain,
                const std::vector<double>& more, ChannelRecord& channel);

/// A channel with another strain in the place of its own, about the same baseline.
/// @param quiet  samples before the pulse
void replace_strain(const Campaign& campaign, std::size_t gauge, const std::vector<double>& strain,
                    std::size_t quiet, ChannelRecord& channel);

/// Whether an effect makes a difference that grows with its sign: a strength that may be negative.
[[nodiscard]] bool two_sided(const EffectUse& use);

}  // namespace kolsky
