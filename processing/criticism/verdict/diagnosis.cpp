#include "processing/criticism/verdict/diagnosis.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "processing/criticism/records/arrival_order.hpp"
#include "processing/criticism/verdict/conclusion.hpp"
#include "processing/criticism/verdict/findings.hpp"
#include "processing/criticism/verdict/lesser_claims.hpp"
#include "processing/criticism/verdict/slow_ties.hpp"

namespace kolsky {

std::string name_of(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::named:
      return "named";
    case DiagnosisVerdict::tied:
      return "tied";
    case DiagnosisVerdict::unknown:
      return "unknown";
    case DiagnosisVerdict::adequate:
      return "adequate";
    case DiagnosisVerdict::untestable:
      return "untestable";
    case DiagnosisVerdict::bad_data:
      return "bad-data";
  }
  return {};
}

namespace {

/// One beginning of a search, and what became of it.
struct Attempt {
  Diagnosis diagnosis;
  /// What the search began with, where that led nowhere and what came next to it was not beaten:
  /// what was left unexplained outweighs its lead, and may be what made the lead.
  std::optional<std::string> led_nowhere;
};

/// @param barred  is not what the search begins with
/// @param trail   of earlier beginnings, to which this one's is added
Attempt attempt(Study& study, const Model& model, const DiagnosisOptions& options,
                const std::vector<std::string>& barred, Trail& trail) {
  Findings found = find_what_lacks(study, model, options, barred, trail);
  const auto dead_end = [&](bool may_be, double excess) {
    return may_be && found.beginning.outweighed_by(excess) ? std::optional(found.beginning.effect)
                                                           : std::nullopt;
  };
  if (found.trodden) {
    found.diagnosis.effects.clear();
    return {std::move(found.diagnosis), dead_end(true, trail.excess)};
  }
  set_lesser_claims_aside(study, options, found);
  tie_with_drifts(study, found.current, found.diagnosis);
  tie_with_hum(study, found.current, found.diagnosis);
  const std::optional<LeftOver> left = conclude(study, options, found);
  if (!left) {
    return {std::move(found.diagnosis), std::nullopt};
  }
  trail.excess = left->excess;
  return {std::move(found.diagnosis), dead_end(left->in_common, left->excess)};
}

/// Where two effects are missing, what fits best alone may be neither: a slow relaxation for a
/// dashpot beside a quick one. Then nothing fits beside it, and the search begins again with what
/// came next.
Diagnosis begun_rightly(Study& study, const Model& model, const DiagnosisOptions& options) {
  constexpr std::size_t kMostBeginnings = 3;
  std::vector<std::string> barred;
  Trail trail;
  std::optional<Diagnosis> first;
  while (true) {
    Attempt made = attempt(study, model, options, barred, trail);
    if (!made.led_nowhere || barred.size() + 1 == kMostBeginnings) {
      return first && made.diagnosis.effects.empty() ? *std::move(first)
                                                     : std::move(made.diagnosis);
    }
    options.progress("what fits best, " + *made.led_nowhere +
                     ", leaves too much: beginning with the next");
    barred.push_back(*made.led_nowhere);
    study.residuals().believe_quiet();
    first = first ? std::move(first) : std::move(made.diagnosis);
  }
}

}  // namespace

Diagnosis diagnose(Study& study, const Model& model, const DiagnosisOptions& options) {
  Diagnosis diagnosis = begun_rightly(study, model, options);
  std::vector<std::string>& notes = diagnosis.notes;
  std::vector<std::string> misfiled = misfiled_gauges(study.campaign());
  std::erase_if(misfiled, [&](const auto& line) { return std::ranges::count(notes, line) > 0; });
  notes.insert(notes.begin(), misfiled.begin(), misfiled.end());
  return diagnosis;
}

}  // namespace kolsky
