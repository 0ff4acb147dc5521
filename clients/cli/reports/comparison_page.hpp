#pragma once

#include <string>

#include "clients/report/html.hpp"
#include "processing/criticism/comparing/comparison.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky::cli {

/// What `kolsky compare --report` writes: the misfit in words, where the model fails, the model,
/// prediction over measurement at every gauge.
/// @param notes  how the model came to be as it is compared, and what speaks against the bench
[[nodiscard]] Page comparison_page(const std::string& title, std::vector<std::string> notes,
                                   Study& study, const Studied& studied, Comparer& comparer,
                                   const Comparison& comparison);

/// What `kolsky diagnose --report` writes: the verdict, every candidate, and the comparison before
/// and after what was found is added. Fits both models again.
[[nodiscard]] Page diagnosis_page(const std::string& title, Study& study, const Model& before,
                                  const Diagnosis& diagnosis);

}  // namespace kolsky::cli
