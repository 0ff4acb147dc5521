#include "processing/criticism/verdict/doubts.hpp"

#include <algorithm>
#include <utility>

#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/filed_bars.hpp"
#include "processing/criticism/verdict/filed_conflict.hpp"
#include "processing/criticism/verdict/other_law.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/criticism/verdict/unlisted.hpp"

namespace kolsky {

namespace {

/// What shots that were held out are farther from with it explains nothing.
bool is_worse_where_held_out(const Diagnosis& diagnosis, const DiagnosisOptions& options) {
  return !diagnosis.effects.empty() && options.safeguards.held_out &&
         diagnosis.held_out.after > diagnosis.held_out.before;
}

/// No other shot tells what a claim leaves from noise. Of one shot, then, that must be no more than
/// noise may be beyond what the quiet part shows of it.
bool leaves_much_of_one_shot(const Diagnosis& diagnosis, std::size_t shots) {
  const HeldOut& misfit = diagnosis.held_out;
  return shots < 2 && !diagnosis.effects.empty() && beyond_quiet(misfit) &&
         misfit.after - misfit.floor >
             allowed_rest(diagnosis.effects.size()) * (misfit.before - misfit.after);
}

/// Where nobody filed at which temperature the bars have their moduli, these are off by what it
/// was: that is no second effect.
std::optional<std::string> moduli_in_place_of_temperature(Study& study, const Findings& found,
                                                          double noise) {
  const std::string temperature = "temperature";
  const Bench& bench = study.campaign().bench;
  const std::vector<std::string>& effects = found.diagnosis.effects;
  if (bench.temperature_K || effects.size() < 2 || std::ranges::count(effects, temperature) == 0) {
    return std::nullopt;
  }
  Model alone = found.current.model;
  std::erase_if(alone.effects, [&](const EffectUse& use) {
    return use.id() != temperature && std::ranges::count(effects, use.id()) > 0;
  });
  const std::optional<Model> any = with_bars_of_any_moduli(alone, bench);
  const bool as_good = any && changed(study, found.current, *any).fit.objective() <
                                  found.current.fit.objective() + kTie * noise;
  return as_good ? std::optional(no_temperature_text()) : std::nullopt;
}

/// Where all shots are so alike that what is claimed to change the bars' moduli from shot to shot
/// is another modulus in all of them.
std::optional<std::string> one_modulus_in_place_of_an_effect(Study& study, const Findings& found,
                                                             double noise) {
  for (const std::string& id : found.diagnosis.effects) {
    if (!is_one_modulus(id, study.campaign().shots)) {
      continue;
    }
    const Model left = model_without(found.current, id);
    const std::optional<Model> any = with_bars_of_any_moduli(left, study.campaign().bench);
    const Studied other = changed(study, found.current, any.value_or(left));
    if (any && other.fit.objective() < found.current.fit.objective() + kTie * noise) {
      return other_bars_text(left, other.model, OtherBars::explain_nearly_as_much) +
             one_modulus_text(id);
    }
  }
  return std::nullopt;
}

/// What is claimed must do at least as well as other bars would. Where it is doubted anyway, they
/// are told too if they do nearly as well: of a wrong wave speed lengths and positions make up
/// three effects.
std::optional<std::string> other_bars_in_place_of(Study& study, const Findings& found,
                                                  const Studied& before, double noise,
                                                  bool doubted) {
  constexpr double kBetter = 16.0;  // three numbers gain as much from noise once in a thousand
  constexpr double kNearly = 0.1;
  const std::optional<Model> any = with_bars_of_any_moduli(before.model, study.campaign().bench);
  if (!any) {
    return std::nullopt;
  }
  const Studied other = changed(study, before, *any);
  const double behind = other.fit.objective() - found.current.fit.objective();
  const double explained = before.fit.objective() - found.current.fit.objective();
  if (auto one = one_modulus_in_place_of_an_effect(study, found, noise)) {
    return one;
  }
  if (behind < (doubted ? kNearly * explained : -kBetter * noise)) {
    return other_bars_text(
        before.model, other.model,
        behind < 0.0 ? OtherBars::explain_more : OtherBars::explain_nearly_as_much);
  }
  return std::nullopt;
}

/// What needs no other fit to be said.
std::vector<std::string> doubts_at_hand(const Study& study, const DiagnosisOptions& options,
                                        const Findings& found, const Studied& before,
                                        const std::optional<Unexplained>& remains, double noise) {
  const Studied& current = found.current;
  std::vector<std::string> reasons =
      why_unknown(found.diagnosis, current, study.campaign(), remains,
                  (before.fit.objective() - current.fit.objective()) / noise, options.log_alpha);
  if (const FiledConflict filed = conflict_with_filed(current); filed.log_p < kSure) {
    reasons.push_back(filed_text(filed));
  }
  // An effect's limit is another effect that it only imitates.
  for (const AtBound& number : claimed_at_bounds(found)) {
    if (number.auxiliary) {
      reasons.push_back(in_words(number));
    }
  }
  if (is_worse_where_held_out(found.diagnosis, options)) {
    reasons.emplace_back("what was found makes shots that were held out misfit more");
  }
  if (leaves_much_of_one_shot(found.diagnosis, study.campaign().shots.size())) {
    reasons.push_back(left_of_one_shot_text("what was found", found.diagnosis.held_out.after));
  }
  return reasons;
}

}  // namespace

double allowed_rest(std::size_t effects) {
  const auto count = static_cast<double>(std::max<std::size_t>(effects, 1));
  return kAllowedRest / (count * count);
}

bool beyond_quiet(const HeldOut& misfit) {
  constexpr double kOfQuiet = 1.5;
  return misfit.after > kOfQuiet * misfit.floor;
}

std::vector<AtBound> claimed_at_bounds(const Findings& found) {
  std::vector<AtBound> list = numbers_at_bounds(found.current.model);
  std::erase_if(list, [&](const AtBound& number) {
    return std::ranges::count(found.diagnosis.effects, number.effect) == 0;
  });
  return list;
}

std::vector<std::string> doubts(Study& study, const DiagnosisOptions& options,
                                const Findings& found, const Studied& before,
                                const std::optional<Unexplained>& remains, double noise) {
  if (!options.safeguards.unknown) {
    return {};
  }
  if (found.parting) {
    return {*found.parting};
  }
  const std::vector<std::string>& effects = found.diagnosis.effects;
  std::vector<std::string> reasons = doubts_at_hand(study, options, found, before, remains, noise);
  const auto add = [&](std::optional<std::string> reason) {
    if (reason) {
      reasons.push_back(*std::move(reason));
    }
  };
  if (!reasons.empty() || !effects.empty()) {
    const bool doubted = !reasons.empty() && !effects.empty();
    add(other_bars_in_place_of(study, found, before, noise, doubted));
  }
  if (reasons.empty()) {
    add(moduli_in_place_of_temperature(study, found, noise));
  }
  if (reasons.empty()) {
    if (const auto law = other_law_in_place_of(study, found.current, effects)) {
      reasons.push_back(other_law_text(*law));
    }
  }
  add(unlisted_in_place_of(study, before, found.current, beside_the_bar(effects).size(),
                           reasons.empty() ? InPlaceOf::claims : InPlaceOf::all));
  return reasons;
}

}  // namespace kolsky
