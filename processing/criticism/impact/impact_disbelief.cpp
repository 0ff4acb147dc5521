#include "processing/criticism/impact/impact_disbelief.hpp"

#include <algorithm>
#include <optional>

#include "processing/criticism/impact/impact_notes.hpp"
#include "processing/criticism/impact/impulse_doubt.hpp"
#include "processing/criticism/verdict/filed_conflict.hpp"

namespace kolsky {

namespace {

constexpr double kAllowedRest = 0.03;  ///< of a misfit that certified effects explain

double explained_by(const ImpactFindings& found) {
  return found.first.fit.objective() - found.current.fit.objective();
}

/// Whether misfit repeats that nothing explains.
bool remains(const ImpactFindings& found, const ImpactStudy& study) {
  const Eigen::VectorXd& residual = found.current.fit.residual;
  const auto [chi2, freedom] = study.repeated(residual);
  return study.unexplained_log_p(residual) < kUnexplained &&
         chi2 - freedom > kAllowedRest * std::max(0.0, explained_by(found));
}

/// What is missing closes the misfit of speeds that the fit did not see, as far as noise and the
/// calculation leave it closed. What only resembles it closes a part, or nothing once it is
/// settled, unless it is for what is filed that it is claimed.
bool leaves_too_much(const ImpactFindings& found, const HeldOut& held_out,
                     const ImpactStudy& study) {
  constexpr double kPart = 0.5;
  constexpr double kMuch = 2.0;  // of noise alone: another code's coarse mesh leaves less
  const double closed = held_out.before - held_out.after;
  if (study.allowance(found.current) != Allowance::kept) {
    const double shown = std::max(0.0, held_out.before - held_out.floor);
    return closed <= 0.0 || closed < kPart * shown ||
           (closed < (1.0 - kAllowedRest) * shown && held_out.after > kMuch * held_out.floor);
  }
  const double of_filed = found.first.fit.penalty - found.current.fit.penalty;
  return closed <= 0.0 && !(of_filed > 0.5 * explained_by(found));
}

/// What holds whether anything is claimed or not: shots that are not alike, impulses and rebounds
/// that no ball has, an effect that nobody believes.
std::vector<std::string> doubts_of_any_ball(const ImpactFindings& found, bool left,
                                            ImpactStudy& study) {
  const std::optional<std::string> rebounds =
      left ? rebound_doubt(study, found.current) : std::nullopt;
  std::vector<std::string> doubts;
  for (const auto& doubt : {scatter_doubt(study, found.current),
                            impulse_doubt(study, found.current), rebounds, found.unbelievable}) {
    if (doubt) {
      doubts.push_back(*doubt);
    }
  }
  return doubts;
}

}  // namespace

ImpactDisbelief disbelief_in(const ImpactFindings& found, const HeldOut& held_out, double log_alpha,
                             ImpactStudy& study) {
  const bool claims = !found.diagnosis.effects.empty();
  const double pressed = law_beyond_bounds(found.current);
  const FiledConflict filed = conflict_with_filed(found.current);
  const bool contradicts = filed.log_p < log_alpha;
  ImpactDisbelief disbelief;
  disbelief.taken_up = pressed > kPressed || contradicts;
  std::vector<std::string>& reasons = disbelief.reasons;
  if (claims && pressed > kPressed) {
    reasons.push_back(law_pressed_note(pressed));
  }
  if (contradicts) {
    reasons.push_back(filed_note(filed, claims));
  }
  if (claims && leaves_too_much(found, held_out, study)) {
    reasons.push_back(left_of_claim_note(held_out));
  }
  const bool left = remains(found, study);
  const std::vector<std::string> of_any_ball = doubts_of_any_ball(found, left, study);
  reasons.insert(reasons.end(), of_any_ball.begin(), of_any_ball.end());
  disbelief.gives_up =
      left || found.overruled || !of_any_ball.empty() || (claims && !reasons.empty());
  return disbelief;
}

bool surely_disbelieved(const ImpactFindings& found, double log_alpha, const ImpactStudy& study) {
  constexpr double kSurely = 1.5;
  const bool claims = !found.diagnosis.effects.empty();
  const bool contradicts = claims && conflict_with_filed(found.current).log_p < kSurely * log_alpha;
  const bool left = remains(found, study) &&
                    study.unexplained_log_p(found.current.fit.residual) < kSurely * kUnexplained;
  return found.overruled || found.unbelievable || contradicts || left;
}

}  // namespace kolsky
