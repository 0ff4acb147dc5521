#pragma once

#include <string>
#include <vector>

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/search/candidate_verdict.hpp"
#include "processing/criticism/search/search.hpp"

namespace kolsky {

/// Deviations at which a strength is detectable.
inline constexpr double kDetected = 6.0;

/// What became of one effect of the library. Of its variants the one that noise makes least likely
/// stands for it.
struct CandidateResult {
  std::string effect;
  std::string parameter;
  std::string unit;
  /// Untestable here: what its bounds alone say of it. Of several strengths (each shot's, each
  /// gauge's) at first order: their root mean square.
  double strength = 0.0;
  double sd = 0.0;
  double own_log_p = 0.0;  ///< ln of its probability under noise, of this effect alone
  double log_p = 0.0;      ///< the same, the search over all effects included
  double gain = 0.0;       ///< of chi2, in units of the noise found
  /// The same on shots that its strength was not found in. Strengths of a shot's own foretell none:
  /// 0 at first order, and of a refit what the rest of the model gained.
  double held_out_gain = 0.0;
  double detectable = 0.0;    ///< the strength that stands at 6 sigma here; infinite: none does
  double identifiable = 0.0;  ///< and still at 5 beside its nearest rival
  std::string nearest_rival;
  bool refitted = false;  ///< in full; else all this is first order
  bool per_shot = false;  ///< with a strength of each shot's own
  CandidateVerdict verdict = CandidateVerdict::not_needed;
};

/// What one search tried at first order.
struct Tried {
  const std::vector<Candidate>& candidates;
  const std::vector<Direction>& directions;  ///< of the candidates, one each
  const Studied& base;                       ///< the model that was searched
  double log_trials = 0.0;                   ///< ln of how many tests the search amounts to
  double scale = 1.0;                        ///< what a square of a normal deviate counts over
  /// Degrees of freedom by which the noise is known in each candidate's direction; empty: known
  std::vector<double> known = {};
  std::size_t residuals_per_shot = 0;  ///< 0: nothing is held out
};

/// First-order strengths and limits of every effect beside the model that was searched.
[[nodiscard]] std::vector<CandidateResult> first_order_table(const Tried& tried);

/// A size of a strength that its bounds allow; infinite: none that they allow is as large.
[[nodiscard]] double within_reach(const Candidate& candidate, double size);

/// Puts what refits found in the place of first order.
/// @param held_out  one per refit
/// @param which     of the refits; of several of one effect the first counts
void note_refits(const Search& search, const std::vector<Refit>& refits,
                 const std::vector<Certification>& held_out, const std::vector<std::size_t>& which,
                 std::size_t residuals_per_shot, std::vector<CandidateResult>& table);

/// Strength and deviation of an effect in a fitted model.
void set_strength(const Studied& studied, const std::string& id, CandidateResult& result);
/// The deviation grows with what the shots differ by beyond noise.
void set_strength(const Studied& studied, const std::string& id, std::size_t residuals_per_shot,
                  CandidateResult& result);

}  // namespace kolsky
