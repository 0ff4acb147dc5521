#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// Where earlier beginnings of a search have been.
struct Trail {
  /// Effects that stood beside each other when two were found, and which of them was on trial.
  using Pair = std::pair<std::set<std::string>, std::string>;
  std::set<Pair> pairs;
  double excess = 0.0;  ///< misfit that was left where the last one ended
};

/// What a search began with.
struct Beginning {
  std::string effect;                    ///< empty: with nothing
  std::optional<double> lead_over_next;  ///< see `Choice`
  /// What was found beside it leaves more than it explains: no other beginning does better.
  bool far_off = false;

  /// Whether what is left unexplained weighs more than its lead, so that another beginning may be
  /// the right one. @param excess  of chi2
  [[nodiscard]] bool outweighed_by(double excess) const {
    return !far_off && lead_over_next && *lead_over_next < excess;
  }
};

/// A claim that was taken back as what the others leave.
struct SetAside {
  std::string effect;
  double gain = 0.0;  ///< of chi2, which it would explain
  std::string text;   ///< why nothing is named where what it leaves is not the others' own
};

/// What a search has found, before it is known whether that is believed.
struct Findings {
  Studied first;    ///< without it
  Studied current;  ///< with it
  Model start;      ///< unfitted, with the effects found so far
  Diagnosis diagnosis{};
  Beginning beginning{};
  std::map<std::string, double> variants_differ{};  ///< strengths of what is claimed, see `Choice`
  /// Of what is claimed what is to be certified beside others yet.
  std::optional<std::string> on_trial{};
  std::optional<std::string> parting{};  ///< that the specimen's faces part, in a sentence
  std::optional<SetAside> set_aside{};
  /// An earlier beginning came by the same pair: from there on the way is the same.
  bool trodden = false;
};

/// Takes a claim back. @param left  the fit without it, with which the search goes on
void drop(Findings& found, const std::string& id, CandidateVerdict verdict, Studied left);

/// One effect after another, each beside those found before.
/// @param barred  is not what the search begins with
/// @param trail   of earlier beginnings, to which this one's is added
[[nodiscard]] Findings find_what_lacks(Study& study, const Model& model,
                                       const DiagnosisOptions& options,
                                       const std::vector<std::string>& barred, Trail& trail);

}  // namespace kolsky
