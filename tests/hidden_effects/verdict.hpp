#pragma once

#include <optional>
#include <set>

#include "tests/hidden_effects/localisation.hpp"

namespace kolsky::scoring {

/// A case, judged.
struct Verdict {
  std::string id;
  CaseKind kind = CaseKind::null;
  std::vector<std::string> truth;
  std::vector<double> multiples;
  std::string answered;                     ///< "named", "unknown", ..., "failed" or "timeout"
  std::vector<std::string> named;           ///< representatives
  std::vector<std::set<std::string>> sets;  ///< with what each is tied to
  int found = 0;                            ///< how many of the truth lie in some set
  bool exact = false;                       ///< the names are the truth's and nothing is tied
  double set_size = 0.0;                    ///< mean over the sets
  std::optional<double> closure;            ///< (before - after)/(before - floor), held out
  std::optional<double> strength_in_sd;     ///< (claimed - true)/sd
  std::vector<double> moduli_in_sd;         ///< after adding: (fitted - true)/sd
  std::vector<double> curve_in_sd;          ///< likewise of a specimen's stress-strain curve
  std::string proposal;                     ///< what would break the tie, as it says
  std::optional<bool> tie_broken;           ///< by doing that; none where it cannot be made
  std::optional<Localisation> places;       ///< those that `compare` marks
  std::optional<double> null_p;             ///< p-value of one candidate drawn by the case's id
  double seconds = 0.0;
  std::string error;
};

[[nodiscard]] Verdict judge(const Case& drawn, const Answer& answer);
/// The experiment proposed to break the first tie; empty for none.
[[nodiscard]] std::string proposal_of(const Answer& answer);
/// Adds what a refit with the certified effects says about the moduli.
void judge_refit(Verdict& verdict, const Case& drawn, const Answer& fit);

[[nodiscard]] nlohmann::json json_of(const Verdict& verdict);

}  // namespace kolsky::scoring
