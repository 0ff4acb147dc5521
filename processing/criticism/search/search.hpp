#pragma once

#include <map>
#include <string>
#include <vector>

#include "processing/criticism/search/candidate_verdict.hpp"
#include "processing/criticism/search/rating.hpp"
#include "processing/criticism/search/refit.hpp"
#include "processing/criticism/search/refitter.hpp"
#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/search/search_ground.hpp"
#include "processing/criticism/search/slow_chances.hpp"

namespace kolsky {

/// One search for what a fitted model lacks: every candidate tested at first order, those near the
/// best refitted in full.
class Search {
 public:
  /// @param base   the model as fitted; outlives this
  /// @param start  the same before anything was fitted
  Search(Study& study, const Studied& base, const Model& start, const Safeguards& safeguards = {});
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  [[nodiscard]] const std::vector<Candidate>& candidates() const { return ground_.candidates; }
  /// Of the candidates, one each.
  [[nodiscard]] const std::vector<Direction>& directions() const { return ground_.directions; }

  /// ln of the chance that the best of all candidates does as well on noise.
  [[nodiscard]] double with_search(double log_p) const { return rating_.with_search(log_p); }
  [[nodiscard]] double log_trials() const { return rating_.log_trials(); }
  /// ln of the chance of what was refitted, sought among its own variants only.
  [[nodiscard]] double without_search(const Refit& refit) const {
    return rating_.without_search(refit);
  }
  /// By candidate: degrees of freedom by which noise is known in its direction.
  [[nodiscard]] std::vector<double> known() const;

  /// Refits the candidates worth it. @return those that may explain, the best first; the others are
  ///   dismissed
  [[nodiscard]] std::vector<Refit> refit_rivals();

  /// What was refitted and is no explanation.
  struct Dismissed {
    CandidateVerdict verdict = CandidateVerdict::rejected;  ///< or unconfirmed
    double gain = 0.0;    ///< over the noise; first order may have promised far more
    double chance = 0.0;  ///< ln of that of its gain on noise, the search not counted
  };
  [[nodiscard]] const std::map<std::string, Dismissed>& dismissed() const { return dismissed_; }

 private:
  /// @return whether it may explain anything; strengths of each shot's own are confirmed for it
  [[nodiscard]] bool admit(Refit& refit);
  void dismiss(const Refit& refit);
  void refine(std::vector<Refit>& list);

  SearchGround ground_;
  Safeguards safeguards_;
  Refitter refitter_;
  SlowChances slow_chances_;
  Rating rating_;
  std::map<std::string, Dismissed> dismissed_;
};

}  // namespace kolsky
