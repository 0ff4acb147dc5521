#pragma once

#include <optional>
#include <string>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Bars this near to each other in temperature count as alike.
inline constexpr double kNearEnough_K = 2.0;

/// A shot's temperature: the fact `temperature_K` of the capture, else the bench's.
/// @throws InputError where that fact is no number
[[nodiscard]] std::optional<double> temperature_of(const Shot& shot);

/// Refuses a bar model that was identified from waves that grow on their way: no bar does that.
/// @param name  of the model, for the message
/// @throws InputError
void require_passive(const Material& model, const std::string& name);

/// Refuses a material for a bar of another density: moduli tell a wave's speed only with the one
/// they were identified with. More than 1 % and three filed deviations off.
/// @throws InputError
void require_density(const Material& model, const Bar& bar, const std::string& name);

/// Refuses a shot, or a bench, whose output bar's own material was identified more than 2 K from
/// its temperature. (That it suits the bar is the bench's own check.)
/// @throws InputError
void require_own_material_holds(const Shot& shot);
void require_own_material_holds(const Bench& bench);

/// Up to where both the bar model and an output bar's own material are known, as far as either
/// says.
[[nodiscard]] std::optional<double> known_band_Hz(const Bench& bench, const Material& bar_model);

/// Refuses a bar model for what it does not hold for: one that is not passive; viscoelastic bars of
/// another density (moduli tell a wave's speed only with the density they were identified with),
/// more than 1 % and three filed deviations off; and, where both are known, bars more than 2 K from
/// the temperature it was identified at (PMMA changes by some 0.3 % per kelvin). A bench of elastic
/// bars takes any.
/// @param name  of the model, for the message
/// @throws InputError
void require_bar_model_holds(const Material& model, const Bench& bench, const std::string& name);
void require_bar_model_holds(const Material& model, const Shot& shot, const std::string& name);

/// Refuses a band that reaches beyond the one in which the model was identified.
/// @throws InputError
void require_band_known(const Material& model, std::optional<double> asked_Hz,
                        const std::string& name);

/// The same of an output bar's own material.
/// @throws InputError
void require_own_band_known(const Bench& bench, std::optional<double> asked_Hz);

/// What to say where a bar model's temperature is known and the shot's is not; else nothing.
[[nodiscard]] std::string temperature_unchecked(const Material& model, const Shot& shot);

/// What to say of a bar model whose identification left far more than noise; else nothing.
[[nodiscard]] std::string poorly_identified(const Material& model);

/// What viscoelastic bars of which nothing is filed are taken to be: the paper's PMMA.
/// @throws InputError where a bar without a modulus is more than 5 % denser or lighter than that
[[nodiscard]] Material assumed_bars(const Bench& bench);

/// What viscoelastic bars are taken to be, for people: the source of the model given, else of that
/// which is assumed. @throws InputError as assumed_bars
[[nodiscard]] std::string viscoelastic_in_words(const Bench& bench,
                                                const std::optional<Material>& given);

}  // namespace kolsky
