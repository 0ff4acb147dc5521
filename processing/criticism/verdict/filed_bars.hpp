#pragma once

#include <optional>
#include <string>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// A model whose viscoelastic bars may have any moduli, whatever is filed of them: no effect of the
/// library is that, and what is one may do as well as it can in its place.
/// @return nothing where the model's bars have none that are filed
[[nodiscard]] std::optional<Model> with_bars_of_any_moduli(const Model& model);

/// How far the moduli of such a fit lie from those of the model, in a sentence.
[[nodiscard]] std::string other_bars_text(const Model& model, const Model& fitted);

}  // namespace kolsky
