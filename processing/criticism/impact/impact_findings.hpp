#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// What a search for what a model of impacts lacks ended with, before anything is said of it.
struct ImpactFindings {
  Studied first;                     ///< the model as fitted, nothing added
  std::vector<double> first_anchor;  ///< where its fine forces were taken
  Studied current;                   ///< with what was found
  Settle settled = Settle::fully;    ///< how far that one was fitted
  Diagnosis diagnosis;               ///< claims, ties, candidates and notes so far, no verdict yet
  double scale = kSolverDoubt;       ///< what a square of a normal deviate counts over
  bool overruled = false;  ///< another reading of the law explains more than what is found
  /// Why what would be claimed next is not believed; none: nothing would be.
  std::optional<std::string> unbelievable;
  std::set<std::string> not_in_quiet;  ///< ids of what the quiet before the pulse does not hold
  std::vector<std::string> flat;       ///< ids of what has no slope at none
};

/// One effect after another, or two at once, each weighed again beside what else is found and
/// beside the other readings of the law. What was found last may be fitted roughly only.
[[nodiscard]] ImpactFindings find_what_impacts_lack(ImpactStudy& study, const Model& model,
                                                    const DiagnosisOptions& options);

}  // namespace kolsky
