#include "processing/criticism/impact/impact_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/impact/flat_effects.hpp"

namespace kolsky {

namespace {

const char* const kLaw = "finite-strain-law";

using Lines = std::vector<std::string>;

void note_repeats(const ImpactStudy& study, const ImpactRecords& records, Lines& lines) {
  if (records.groups.size() < 2) {
    lines.emplace_back(
        "one speed: nothing was held out over speeds; what grows with the speed needs three");
  }
  if (study.campaign().shots.size() == records.groups.size()) {
    lines.emplace_back(
        "no shot is repeated: noise is what the samples before the pulse show, and deviations of "
        "the speed go unseen");
  }
}

void note_calculation(const ImpactResiduals& residuals, double scale, Lines& lines) {
  const ImpactWindow& window = residuals.records().window;
  lines.push_back(fmt::format(
      "judged up to {:.3g} kHz{}; the calculation may be off by {:.2g} % of the force slowly and "
      "by as much from sample to sample ({}the mesh of {} elements differs from {} by {:.2g} % "
      "rms once shifted to fit), and a square of a deviate counts over {:.2g}: `detectable` says "
      "what that leaves",
      1e-3 * window.cutoff_Hz,
      window.to_far_end_only ? ", until the far end's reflection is back" : "",
      100.0 * residuals.solver_sd(),
      residuals.solver_share() < 1.0
          ? fmt::format("by these records, {:.2f} of what is allowed for else; ",
                        residuals.solver_share())
          : "",
      residuals.meshes().middle, residuals.meshes().fine, 100.0 * residuals.mesh_difference(),
      scale));
}

void note_rebounds(const ImpactStudy& study, const ImpactResiduals& residuals, Lines& lines) {
  const std::size_t unsaid = residuals.records().unsaid_rebounds();
  const std::size_t shots = study.campaign().shots.size();
  lines.push_back(
      unsaid == shots
          ? "no rebound speeds: what damps the ball is known by the force alone"
          : fmt::format("rebound speeds of {} shots are fitted, each known to {:.2g} %; of "
                        "restitution the calculation may be off by {:.2g}",
                        shots - unsaid, 100.0 * residuals.rebound_sd(),
                        ImpactWhitening::kRestitutionDoubt));
}

void note_law(const Studied& current, Lines& lines) {
  const EffectUse* law = current.model.find(kLaw);
  if (law == nullptr) {
    return;
  }
  std::string note = fmt::format(
      "finite-strain law: {:.2f} ± {:.2f} on the way from Kirchhoff's stress (0) to Cauchy's (1)",
      law->values[0].value, law->values[0].sd);
  if (const double beyond = law_beyond_bounds(current); beyond > 0.0) {
    note += fmt::format(", at its bound, beyond which the records want it by {:.1f} deviations",
                        beyond);
    note += beyond > kPressed ? ": something is missing that nothing tested here explains, and "
                                "what is fitted took it up"
                              : "";
  }
  lines.push_back(std::move(note));
}

/// Friction that is filed within a deviation is fitted, and so it is never missing.
void note_friction(const ImpactStudy& study, const Studied& current,
                   const std::vector<CandidateResult>& candidates, double scale, Lines& lines) {
  const EffectUse* friction = current.model.find("contact-friction");
  if (friction == nullptr || !(friction->values[0].prior_sd > 0.0)) {
    return;
  }
  const ModelValue& mu = friction->values[0];
  std::string note = fmt::format("friction reads {:.2f} ± {:.2f} where {:.2g} ± {:.2g} is filed",
                                 mu.value, mu.sd, mu.prior_mean, mu.prior_sd);
  const double pull = std::abs(mu.value - mu.prior_mean) / mu.prior_sd;
  const auto own = std::ranges::find(candidates, "contact-friction", &CandidateResult::effect);
  constexpr double kFar = 2.0;
  if (pull > kFar && own != candidates.end()) {
    note += fmt::format(
        ", {:.1f} filed deviations off: fitted, and not missing, as what is filed so widely is "
        "claimed only from {:.2g} off on. File what it reads, or a narrower deviation",
        pull, own->detectable);
  }
  if (const auto& second = study.second_minimum()) {
    note +=
        fmt::format("; at {:.2f}, with other moduli, chi2 is more by {:.0f}, where {:.0f} tells",
                    second->friction, second->behind, kStandsBefore * scale);
  }
  lines.push_back(std::move(note));
}

/// What has no slope at none: up to where the records do not speak against it.
void note_flat(ImpactStudy& study, const Studied& current, double scale, const Lines& ids,
               Lines& lines) {
  const double tells = kStandsBefore * scale;
  for (const Candidate& candidate : candidates_for(current, study.campaign())) {
    if (std::ranges::find(ids, candidate.id()) == ids.end()) {
      continue;
    }
    const auto flat = flat_effect(study, current, candidate, tells, study.executor().first);
    if (!flat || !(flat->not_excluded(tells) > 0.0)) {
      continue;
    }
    std::string note = fmt::format("cannot exclude {} up to {:.2g} {}, which has no slope at none",
                                   flat->id, flat->not_excluded(tells), flat->unit);
    if (flat->nearest() > 0.0) {
      note += fmt::format("; at {:.2g} {} chi2 is less by {:.0f}, where {:.0f} tells",
                          flat->nearest(), flat->unit, flat->gain(), tells);
    }
    lines.push_back(std::move(note));
  }
}

void note_falling(const ImpactResiduals& residuals, Lines& lines) {
  if (residuals.falling_share() > 0.0) {
    lines.push_back(fmt::format(
        "at the highest speed {:.2g} % of the softening layer is strained beyond 1/(2|b|), from "
        "where on its law's stress falls with strain: such a strength is outside of what the law "
        "allows, and its size hangs on the mesh",
        100.0 * residuals.falling_share()));
  }
}

void note_speeds(const ImpactResiduals& residuals, Lines& lines) {
  if (residuals.speed_sd() > 0.0) {
    lines.push_back(
        fmt::format("speeds scatter by {:.2g} % beyond what is filed or repeats' noise explains",
                    100.0 * residuals.speed_sd()));
  }
}

}  // namespace

std::optional<std::string> scatter_doubt(ImpactStudy& study, const Studied& current) {
  constexpr double kMuch = 5.0;
  constexpr double kCommon = 2e-3;  // of a speed of which nothing is filed
  const ImpactResiduals& residuals = study.residuals();
  const double filed = std::max(residuals.records().own_speed_sd, kCommon);
  if (residuals.speed_sd() > kMuch * filed) {
    return fmt::format(
        "shots of one speed differ by {:.2g} % where speeds are off by {:.2g} %: something is not "
        "alike in all shots, a bond, an amplifier or how speeds are measured; look at `kolsky "
        "compare` shot by shot, or file the deviation that speeds have",
        100.0 * residuals.speed_sd(), 100.0 * filed);
  }
  constexpr double kMuchNoise = 3.0;  // balls of another code on coarse meshes scatter by 1.9
  const double scale = residuals.noise_scale() * current.misfit.noise_scale;
  const double freedom = study.scatter_freedom();
  if (scale > kMuchNoise && log_chi2_tail(scale * freedom, freedom) < kUnexplained) {
    return fmt::format(
        "shots of one speed differ by {:.2g} times the squares of what is quiet before the pulse, "
        "speeds and offsets of their own apart: something is not alike in all shots, a bond, an "
        "amplifier or what the ball meets; look at `kolsky compare` shot by shot",
        scale);
  }
  return std::nullopt;
}

std::optional<std::string> rebound_doubt(ImpactStudy& study, const Studied& current) {
  const auto [squares, freedom] = study.repeated_of_rebounds(current.fit.residual);
  if (!(log_chi2_tail(squares, freedom) < kUnexplained)) {
    return std::nullopt;
  }
  const ImpactRecords& records = study.residuals().records();
  const Eigen::VectorXd off = study.residuals().whitening().means_behind(current.fit.residual);
  const auto size = static_cast<Eigen::Index>(study.residuals().per_shot());
  double sum = 0.0;
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    sum += off[static_cast<Eigen::Index>(g + 1) * size - 1] / records.incident(g);
  }
  return fmt::format(
      "measured restitutions are off by {:+.2g} in the mean from those that go with the force: "
      "look "
      "at how rebound speeds are measured (a gate's distance, air on the way), and at what takes "
      "energy up besides the ball",
      sum / freedom);
}

std::optional<std::string> quiet_note(const Studied& current) {
  constexpr double kFarLess = 0.3;  // where nothing is hidden 0.7 to 1.1
  constexpr double kEnough = 30.0;
  const Misfit& misfit = current.misfit;
  if (!(misfit.chi2_reduced < kFarLess && misfit.degrees_of_freedom > kEnough)) {
    return std::nullopt;
  }
  return fmt::format(
      "residuals are {:.2g} times what the quiet before the pulse lets expect, in squares: "
      "something "
      "in the quiet is taken for noise (a hum, a drift), and as much may be missing unseen",
      misfit.chi2_reduced);
}

double law_beyond_bounds(const Studied& studied) {
  const ModelFit& fit = studied.fit;
  const std::vector<FreeNumber>& numbers = studied.composition.numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const FreeNumber& own = numbers[i];
    const double value = own.value_at(fit.theta[i]);
    const double edge = 1e-6 * (own.upper - own.lower);
    if (studied.composition.uses()[own.use].id() != kLaw ||
        (value > own.lower + edge && value < own.upper - edge)) {
      continue;
    }
    const auto at = static_cast<Eigen::Index>(i);
    double slope = fit.jacobian.col(at).dot(fit.residual);
    if (own.prior_sd > 0.0) {
      slope += (value - own.prior_mean) * own.scale / (own.prior_sd * own.prior_sd);
    }
    const double variance = fit.covariance(at, at);
    const double doubt = fit.doubt.size() > 0 ? fit.doubt(at, at) : 0.0;
    return std::abs(slope) * variance / std::sqrt(variance + doubt);
  }
  return 0.0;
}

std::vector<std::string> impact_notes(ImpactStudy& study, const Studied& current,
                                      const std::vector<CandidateResult>& candidates, double scale,
                                      const std::vector<std::string>& flat) {
  ImpactResiduals& residuals = study.residuals();
  Lines lines;
  note_repeats(study, residuals.records(), lines);
  note_calculation(residuals, scale, lines);
  if (auto quiet = quiet_note(current)) {
    lines.push_back(*std::move(quiet));
  }
  note_rebounds(study, residuals, lines);
  note_law(current, lines);
  note_friction(study, current, candidates, scale, lines);
  note_flat(study, current, scale, flat, lines);
  note_falling(residuals, lines);
  note_speeds(residuals, lines);
  std::ranges::move(not_constrained(study, current), std::back_inserter(lines));
  return lines;
}

std::string law_pressed_note(double beyond) {
  return fmt::format(
      "with what came nearest in the model the records want the finite-strain law beyond its bound "
      "by {:.1f} deviations: what is missing is something else",
      beyond);
}

std::string left_of_claim_note(const HeldOut& misfit) {
  if (!(misfit.after < misfit.before && misfit.floor < misfit.before)) {
    return "what came nearest does not bring the speeds closer that the fit did not see: something "
           "else is missing";
  }
  return fmt::format(
      "what came nearest explains {:.0f} % of what noise does not of speeds that the fit did not "
      "see, and what it leaves stands out of noise and of what is allowed for the calculation: "
      "something else is missing, or more",
      1e2 * (misfit.before - misfit.after) / (misfit.before - misfit.floor));
}

std::vector<std::string> left_notes(const ImpactStudy& study, const Studied& current,
                                    const HeldOut& held_out) {
  switch (study.allowance(current)) {
    case Allowance::kept:
      return {};
    case Allowance::mimicked:
      return {fmt::format(
          "what repeats stands out of noise and of what is allowed for the calculation (held-out "
          "misfit {:.3g}, noise alone {:.3g}), by no more than an error of the calculation may "
          "look "
          "like: it cannot be told from something that is missing",
          held_out.after, held_out.floor)};
    case Allowance::exceeded:
      return {fmt::format(
          "what is left beside this exceeds what noise and the calculation leave (held-out misfit "
          "{:.3g}, noise alone {:.3g}), and nothing tested explains it: it is little beside what "
          "was "
          "explained, and the strength is good to as much",
          held_out.after, held_out.floor)};
  }
  return {};
}

std::vector<std::string> restitution_notes(const ImpactComparison& comparison) {
  Lines lines;
  for (const SpeedSummary& speed : comparison.speeds) {
    if (speed.restitution_measured > 0.0) {
      lines.push_back(fmt::format("restitution at {:.1f} m/s: {:.4f} foretold, {:.4f} measured",
                                  speed.speed_m_per_s, speed.restitution_foretold,
                                  speed.restitution_measured));
    }
  }
  return lines;
}

}  // namespace kolsky
