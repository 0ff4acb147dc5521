#include "processing/criticism/verdict/going_back.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "processing/criticism/fitting/moduli_starts.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/search/slow_noise.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/refits.hpp"

namespace kolsky {

namespace {

/// A fitted effect as a candidate beside what else is fitted: its times stay where they are.
Candidate candidate_of(const EffectUse& fitted) {
  Candidate candidate{null_use(*fitted.effect, fitted.gauge)};
  for (std::size_t p = 0; p < fitted.values.size(); ++p) {
    const bool auxiliary = fitted.effect->about().parameters[p].auxiliary();
    candidate.use.values[p].free = !auxiliary;
    candidate.use.values[p].prior_sd = fitted.values[p].prior_sd;
    if (auxiliary) {
      candidate.use.values[p].value = fitted.values[p].value;
    }
  }
  candidate.use.per_shot = fitted.per_shot;
  candidate.use.alike = fitted.alike;
  return candidate;
}

/// Whether strengths of each shot's own are still more than slow noise.
/// @param left  the fit without them
bool stands(Study& study, const Studied& left, const Studied& current, const std::string& id) {
  if (own_strengths_confirmed(current, id, study.campaign(), Claim::standing)) {
    return true;
  }
  const EffectUse& use = *current.model.find(id);
  if (!is_addition(*use.effect)) {
    return false;
  }
  const Candidate candidate = candidate_of(use);
  const Direction direction = direction_of(candidate, left, study);
  const SlowNoise::Addition addition{candidate, direction};
  return slow_noise_excluded(SlowNoise(left, study).log_chance({&addition, 1}), Claim::standing);
}

/// The fit without an effect, begun from the moduli that the model started with: what goes may have
/// stood in for one of them, which has moved to where it does nothing and does not find back.
Studied without_from_start(Study& study, const Findings& found, const std::string& id) {
  Model model = model_without(found.current, id);
  for (EffectUse& use : model.effects) {
    const EffectUse* start = found.start.find(use.id());
    use = use.effect->about().base && start != nullptr ? *start : use;
  }
  start_moduli(model, study.campaign(), study.residuals());
  return begun_at(study, model, Composition(model, study.campaign()).start());
}

/// What others have made superfluous goes, but for so many of the last.
void drop_unneeded(Study& study, const DiagnosisOptions& options, std::size_t spared,
                   Findings& found) {
  const std::vector<std::string>& effects = found.diagnosis.effects;
  for (std::size_t i = 0; i + spared < effects.size();) {
    const std::string id = effects[i];
    Studied left = without(study, found.current, id);
    const bool confirmed =
        !options.safeguards.own_strengths || stands(study, left, found.current, id);
    if (confirmed && missed_in(study, left, found.current)) {
      left = without_from_start(study, found, id);
    }
    if (!confirmed || !missed_in(study, left, found.current)) {
      drop(found, id, CandidateVerdict::not_needed, std::move(left));
    } else {
      ++i;
    }
  }
}

/// Seeks one of the claims again beside all others.
/// @return whether anything else took its place
bool reconsider(Study& study, const DiagnosisOptions& options, std::size_t place, Findings& found) {
  Diagnosis& diagnosis = found.diagnosis;
  const std::string id = diagnosis.effects[place];
  options.progress("seeking " + id + " again beside the others");
  const Studied base = without(study, found.current, id);
  Model start = found.start;
  std::erase_if(start.effects, [&](const EffectUse& use) { return use.id() == id; });
  Search search(study, base, start, options.safeguards);
  std::optional<Choice> choice = Chooser(study, options, diagnosis).choose_next(search, base);
  if (!choice || std::ranges::count(diagnosis.effects, choice->id) > (choice->id == id ? 1 : 0)) {
    return false;
  }
  if (found.on_trial == id) {
    found.on_trial.reset();
  }
  if (choice->studied.fit.objective() > found.current.fit.objective() + 1.0) {
    // Not where it was found before: that was better.
    std::ranges::replace(choice->ties, id, choice->id);
    diagnosis.tied_with[id] = std::move(choice->ties);
    return false;
  }
  const bool is_another = choice->id != id;
  if (is_another) {
    set_verdict(diagnosis, id, CandidateVerdict::not_needed);
    diagnosis.tied_with.erase(id);
    diagnosis.effects[place] = choice->id;
  }
  found.start = with(start, search.candidates()[choice->candidate], Auxiliaries::free);
  go_on_with(study, options, *choice, found);
  return is_another;
}

/// What was found first was chosen beside what was not known yet: each but so many of the last is
/// sought again. @return whether anything else took the place of any
bool reconsider_all(Study& study, const DiagnosisOptions& options, std::size_t spared,
                    Findings& found) {
  bool changed = false;
  for (std::size_t i = 0; i + spared < found.diagnosis.effects.size(); ++i) {
    changed = reconsider(study, options, i, found) || changed;
  }
  return changed;
}

}  // namespace

void go_on_with(Study& study, const DiagnosisOptions& options, Choice& choice, Findings& found) {
  // The noise shows better now.
  study.residuals().freeze(choice.studied.composition, choice.studied.fit.theta);
  found.current = study.refit(choice.studied);
  if (options.safeguards.fitted_noise) {
    study.residuals().calibrate(found.current.composition, found.current.fit.theta);
    found.current = study.refit(found.current);
  }
  found.diagnosis.tied_with[choice.id] = std::move(choice.ties);
  found.variants_differ[choice.id] = choice.variants_differ;
}

void go_back(Study& study, const DiagnosisOptions& options, Findings& found) {
  const std::vector<std::string>& effects = found.diagnosis.effects;
  const std::size_t before = effects.size();
  const bool many = beside_the_bar(effects).size() > kMostBelieved;
  // The last was certified beside all others, unless these take its part from another start.
  drop_unneeded(study, options, many ? 0 : 1, found);
  // It stood beside what is gone now, and its rivals may have been what that took up.
  const std::size_t spared = effects.size() < before ? 0 : 1;
  if (reconsider_all(study, options, spared, found)) {
    drop_unneeded(study, options, 0, found);
  }
}

}  // namespace kolsky
