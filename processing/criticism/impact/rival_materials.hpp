#pragma once

#include <functional>
#include <optional>
#include <string>

#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

/// The first of the other effects of a ball's materials that explains more than what is claimed,
/// fitted to its end in the place of that. A search goes by derivatives from where the model was
/// led for want of what is missing, and what a ball's materials do has none worth anything there.
/// The study's fine forces are left where the model with the claim has them.
/// @param first    the model without the claim
/// @param current  with it
/// @return its id
[[nodiscard]] std::optional<std::string> better_of_materials(
    ImpactStudy& study, const Model& first, const Studied& current, const std::string& claimed,
    const std::function<void(const std::string&)>& progress);

}  // namespace kolsky
