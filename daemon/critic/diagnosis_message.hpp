#pragma once

#include <string>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "proto/forward.hpp"

namespace kolsky {

/// Fills all but the summary's id and state, the shots, the model and the file. Sizes that no
/// strength reaches are infinite.
void fill(const Diagnosis& diagnosis, v1::Diagnosis& message);

/// The message as a JSON text, every field there, with the names of the schema.
[[nodiscard]] std::string json_of(const v1::Diagnosis& message);

}  // namespace kolsky
