#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "processing/criticism/impact/flat_effects.hpp"
#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// A candidate refitted in full.
struct ImpactRefit {
  std::size_t candidate = 0;
  Studied studied;
  double freedom = 1.0;
  /// Whether strengths of each shot's own are more than slow noise that they followed.
  bool confirmed = true;
  double lowers = 0.0;        ///< the objective
  double lowers_filed = 0.0;  ///< the part of it by which filed numbers come nearer
  double gain = 0.0;          ///< of the objective, over the noise that the best refit leaves
  double of_filed = 0.0;  ///< the part of it by which filed numbers come nearer to what is filed
  double evidence = 0.0;  ///< as a square of a normal deviate, the search not counted
  double log_p = 0.0;
};

/// One search for what a fitted model of impacts lacks.
///
/// A gain of the records counts against what the best of the refits leaves of the means per degree
/// of freedom (`scale`), and against no less than kSolverDoubt: a regression's F test where the
/// calculation is further off than was allowed for, else a chi2 test. How far numbers are from what
/// is filed of them is no matter of the calculation and counts in full; what claims one of them
/// counts as much less as the records' own part in its uncertainty is in doubt (doubt_of_gain).
class ImpactSearch {
 public:
  /// @param base  the model as fitted
  ImpactSearch(ImpactStudy& study, const Studied& base);

  /// What refits are compared with: the model as the coarse mesh, by which these go, would have it.
  [[nodiscard]] const Studied& base() const { return base_; }

  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }
  /// Of the candidates, one each; a secant where one has no slope at none; without freedom where
  /// every strength within reach is lost in the noise.
  [[nodiscard]] const std::vector<Direction>& directions() const { return directions_; }
  [[nodiscard]] const Candidate& candidate(const ImpactRefit& refit) const {
    return candidates_[refit.candidate];
  }
  /// Of the candidates that have no slope at none and were tried at finite strengths.
  [[nodiscard]] std::vector<FlatEffect> flat() const;
  [[nodiscard]] double log_trials() const;
  /// ln of the chance that the best of all candidates does as well on noise.
  [[nodiscard]] double with_search(double log_p) const;
  /// Of what is allowed for the calculation's error, what the records leave open
  /// (solver_share.hpp).
  [[nodiscard]] double solver_share() const;

  /// Refits the candidates worth it. What would be added to the records (hum, drift) is left out
  /// where it is not in the quiet before the pulse.
  void refit_rivals();
  /// The same, and what was found before among them, whatever first order says, from there as well.
  /// @param found  a model that holds it: this one and more
  void refit_rivals(const std::string& id, const Studied& found);
  /// Settles those nearest to a claim: numbers that do nearly the same to a ball are told apart by
  /// the middle mesh, and a coarse one may lead a rival's fit to where it gains less.
  /// @param base  the search's, as it was settled
  void settle_nearest(const Studied& base);
  /// The best first; none before they are refitted. An effect may be there in several variants.
  [[nodiscard]] const std::vector<ImpactRefit>& refits() const { return refits_; }
  /// Refits of what may not be claimed, for nothing but the fit confirms its strengths, but may be
  /// what another stands for.
  [[nodiscard]] const std::vector<ImpactRefit>& unconfirmed() const { return unconfirmed_; }
  /// Ids of what is not in the quiet and was left out for it, though it stands before nothing.
  [[nodiscard]] const std::set<std::string>& not_in_quiet() const { return not_in_quiet_; }
  /// Squares of deviates are over this, by the refits.
  [[nodiscard]] double scale() const { return scale_; }
  /// What the best refit leaves of it, at least 1: gains are over this.
  [[nodiscard]] double noise() const { return noise_; }

 private:
  struct Known {
    std::size_t candidate;
    const Studied& studied;  ///< with it
  };
  void refit_rivals(const std::optional<Known>& known);
  [[nodiscard]] std::optional<Known> known(const std::string& id, const Studied& found) const;
  [[nodiscard]] std::vector<std::size_t> worth_refitting() const;
  void add_variants_as_likely(std::vector<std::size_t>& chosen) const;
  /// @param least  gain from which on a filed number is tried from afar, too
  [[nodiscard]] std::optional<ImpactRefit> refit(std::size_t index, const Workers& executor,
                                                 double least, const Studied* known);
  [[nodiscard]] std::optional<ImpactRefit> described(std::size_t index, const Model& model,
                                                     Composition composition, ModelFit fit) const;
  void leave_out_what_quiet_lacks();
  void share_out(std::size_t count, const std::function<void(std::size_t, const Workers&)>& work);
  void refine();
  void rate();
  void sort_by_evidence();

  ImpactStudy& study_;
  Studied base_;
  bool astray_ = false;  ///< what is fitted may have taken up what is missing
  std::vector<Candidate> candidates_;
  std::vector<Direction> directions_;
  std::vector<std::optional<FlatEffect>> flat_;  ///< by candidate
  std::vector<double> evidence_;                 ///< at first order, as ImpactRefit's
  std::vector<ImpactRefit> refits_;
  std::vector<ImpactRefit> unconfirmed_;
  std::set<std::string> not_in_quiet_;
  double trials_ = 1.0;
  double scale_ = kSolverDoubt;
  double noise_ = 1.0;
};

}  // namespace kolsky
