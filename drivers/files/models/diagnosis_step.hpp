#pragma once

#include <string>

#include "drivers/files/models/model_file.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// How a fit came out, as a model's history keeps it.
[[nodiscard]] StepFit fit_of(const Misfit& misfit, std::size_t captures);

/// Takes a diagnosis into a model, whoever made it: a step with its verdict, what was added, every
/// test of an effect that was worth one, misfit, held-out misfit and seeds; and the model with what
/// was found, but where the verdict is "unknown".
/// @param left      by the model that it ends with, in the noise that `kolsky fit` states its
/// misfit
///                  in: steps of a history are compared
/// @param captures  that it was made of
void add_diagnosis(ModelFile& file, const Diagnosis& diagnosis, const Misfit& left,
                   const std::vector<std::filesystem::path>& captures, const std::string& note);

}  // namespace kolsky
