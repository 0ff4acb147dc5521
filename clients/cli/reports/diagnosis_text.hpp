#pragma once

#include <string>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky::cli {

/// "(3.52 ± 0.09)e-6 s": two digits of the deviation, powers of a thousand.
[[nodiscard]] std::string strength_text(double value, double sd, const std::string& unit);

/// A gain of chi-square, to a tenth; to a digit where a strength from some shots means nothing for
/// another, and it knows no bounds. Empty for what is not finite.
[[nodiscard]] std::string gain_text(double gain);

/// A diagnosis as people read it: verdict, what is missing, the effects that come into question,
/// what their columns and verdicts mean, and what to do next.
[[nodiscard]] std::string diagnosis_text(const Diagnosis& diagnosis);

}  // namespace kolsky::cli
