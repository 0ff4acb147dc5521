#pragma once

#include <string>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky::cli {

/// "(3.52 ± 0.09)e-6 s": two digits of the deviation, powers of a thousand.
[[nodiscard]] std::string strength_text(double value, double sd, const std::string& unit);

/// A candidate's; named where it is not the effect's first number, as an end's return beside
/// whether it returns anything.
[[nodiscard]] std::string strength_text(const CandidateResult& candidate);

/// What a floor of chi-square is of: what differs from shot to shot counts as noise, and makes more
/// than 1 of it.
[[nodiscard]] std::string floor_name(double chi2);

/// A gain of chi-square, to a tenth; to a digit where a strength from some shots means nothing for
/// another, and it knows no bounds. Empty for what is not finite.
[[nodiscard]] std::string gain_text(double gain);

/// A diagnosis as people read it: verdict, what is missing, the effects that come into question,
/// what their columns and verdicts mean, and what to do next.
[[nodiscard]] std::string diagnosis_text(const Diagnosis& diagnosis);

}  // namespace kolsky::cli
