#pragma once

#include <array>
#include <optional>
#include <string>

#include "processing/models/model.hpp"

namespace kolsky {

// A material of any family as effects hold it: three elements, and what it has more as an effect of
// its own, which together have its J exactly.

/// Where a family has the spring in line, and a spring with the dashpot beside it.
[[nodiscard]] std::array<std::size_t, 3> three_element_places(SolidKind solid);

/// The three elements of a material. What it has more counts as known: deviations and covariance
/// are what is left of them then.
[[nodiscard]] Material three_elements_of(const Material& material);

/// What a material has more than three elements, its numbers held; none of three elements.
/// @param part  whose it is: "" of bars, "core-", "cover-" or "specimen-"
/// @throws InputError at "solid" where no effect is that, at a parameter that the effect does not
/// take
[[nodiscard]] std::optional<EffectUse> further_effect(const Material& material,
                                                      const std::string& part);

/// Puts it behind the effect that holds the three elements of bars or of a ball's layer.
/// @param base  "three-element-bar", "three-element-core" or "three-element-cover"
void add_behind(const std::string& base, EffectUse further, Model& model);

/// @throws InputError at "solid" where one of the bars is elastic and the effect acts on both
void require_for_all_bars(const EffectUse& further, const Material& material, const Bench& bench);

}  // namespace kolsky
