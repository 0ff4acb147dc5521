#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/search/candidate_table.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// By how many of its deviations the finite-strain law would leave its bounds if it might: to first
/// order, from the slope that is left at the bound.
[[nodiscard]] double law_beyond_bounds(const Studied& studied);
/// From so many deviations on something is missing that what is fitted took up.
inline constexpr double kPressed = 2.0;

/// Where residuals are far smaller than what the quiet before the pulse lets expect.
[[nodiscard]] std::optional<std::string> quiet_note(const Studied& current);

/// What limits a diagnosis of impacts, in sentences: repeats, the judged band, what is allowed for
/// the calculation, rebounds, the law's form, friction, scatter of the speeds.
/// @param candidates  of the first search
/// @param scale       what a square of a normal deviate counts over
/// @param flat        effects without a slope at none that are to be tried at finite strengths
[[nodiscard]] std::vector<std::string> impact_notes(ImpactStudy& study, const Studied& current,
                                                    const std::vector<CandidateResult>& candidates,
                                                    double scale,
                                                    const std::vector<std::string>& flat);

/// Why shots are not alike, where those of one speed differ by five times what their speeds may be
/// off by, or by three times the squares that noise has before the pulse: a reading that changes
/// from shot to shot, which their scatter would pass for.
[[nodiscard]] std::optional<std::string> scatter_doubt(ImpactStudy& study, const Studied& current);

/// By how much measured restitutions are off, where that is by themselves more than noise and what
/// codes differ by leave.
[[nodiscard]] std::optional<std::string> rebound_doubt(ImpactStudy& study, const Studied& current);

/// Why nothing is claimed though something is certified. @param beyond  of law_beyond_bounds()
[[nodiscard]] std::string law_pressed_note(double beyond);

/// Why nothing is claimed where a claim leaves too much of what it would explain.
[[nodiscard]] std::string left_of_claim_note(const HeldOut& misfit);

/// Where what repeats stands out of noise and of what is allowed for the calculation though the
/// verdict names nothing more: that an error of its kind may look so, or that what is left is small
/// beside what was explained.
[[nodiscard]] std::vector<std::string> left_notes(const ImpactStudy& study, const Studied& current,
                                                  const HeldOut& held_out);

/// Restitution, foretold and measured, at each speed.
[[nodiscard]] std::vector<std::string> restitution_notes(const ImpactComparison& comparison);

/// What impacts leave open, whatever they agree with: the law at small strains, where much of the
/// core is beyond them; of each material's three numbers, how many combinations the records know to
/// a tenth, and the one that they know least.
[[nodiscard]] std::vector<std::string> not_constrained(ImpactStudy& study, const Studied& studied);

}  // namespace kolsky
