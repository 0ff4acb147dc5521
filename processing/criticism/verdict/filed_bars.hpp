#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// A model whose bars may have any moduli, whatever is filed of them: no effect of the library is
/// that, and what is one may do as well as it can in its place. Of elastic bars only the wave speed
/// counts much, so that this stands for their density too.
/// @return nothing where no bar's moduli are filed
[[nodiscard]] std::optional<Model> with_bars_of_any_moduli(const Model& model, const Bench& bench);

/// How much other moduli explain of what they are held against.
enum class OtherBars { explain_more, explain_nearly_as_much };

/// How far the moduli of such a fit lie from those of the model, in a sentence.
[[nodiscard]] std::string other_bars_text(const Model& model, const Model& fitted, OtherBars bars);

/// Whether an effect that changes the bars' moduli from shot to shot, by each shot's amplitude or
/// temperature, changes them alike in all of these, to a tenth: then it is another modulus.
[[nodiscard]] bool is_one_modulus(const std::string& effect,
                                  const std::vector<CampaignShot>& shots);
/// What to do then, in a sentence that follows on other_bars_text().
[[nodiscard]] std::string one_modulus_text(const std::string& effect);

/// What to do where temperature is claimed beside what bars of other moduli do as well.
[[nodiscard]] std::string no_temperature_text();

}  // namespace kolsky
