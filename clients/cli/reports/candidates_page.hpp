#pragma once

#include <string>

#include "clients/report/html.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky::cli {

/// Every candidate of a diagnosis, the least probable by chance first; cells of what was not tried
/// are empty.
/// @param held_out  what certifies: "shots", "speeds"
[[nodiscard]] PageTable candidates_table(const Diagnosis& diagnosis, const std::string& held_out);

}  // namespace kolsky::cli
