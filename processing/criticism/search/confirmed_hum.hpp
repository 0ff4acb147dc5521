#pragma once

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// `Study::beside_quiet` but for a hum that is none of the noise. A hum with a phase of its own in
/// every shot follows no source and is slow: learning the noise from what is left takes it for slow
/// noise, and nothing fails. So it is fitted beside the model, in the noise that the quiet parts
/// show, and where they confirm it (`own_strengths_confirmed`) the noise is learned from what it
/// leaves. Not where a converter's steps exceed the noise: their slopes before a pulse are its own.
[[nodiscard]] Studied judged(Study& study, Studied studied);

/// The model as it is, but for strengths of each shot's or each gauge's own; judged so.
[[nodiscard]] Studied judged_as_it_is(Study& study, const Model& model);

}  // namespace kolsky
