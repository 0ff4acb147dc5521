#include "processing/criticism/verdict/disbelief.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/verdict/cancelling.hpp"
#include "processing/criticism/verdict/strength_notes.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

/// What one gauge may have that moves its pulses in time.
constexpr std::array kOfTimes = {"gauge-position:", "channel-delay:", "amplifier-bandwidth:"};

std::string chance_text(double log_p) {
  return log_p < kLeastTold ? "less than once in 10^12 campaigns"
                            : fmt::format("once in {:.2g} campaigns", std::exp(-log_p));
}

std::string repeats_text(double log_p) {
  return fmt::format(
      "misfit repeats that no effect of the library explains: noise leaves as much {}",
      chance_text(log_p));
}

std::string apart_text(const ShotsApart& apart, const Campaign& campaign) {
  const ReadingOfShot& most = *apart.furthest;
  return fmt::format(
      "gauges do not read all shots alike, which noise does {}: furthest is {} in {}, which reads "
      "{:+.2g} ± {:.1g} % and {:+.2g} ± {:.1g} us late beside its other shots; look at its bond, "
      "wires and bridge, or at that shot's temperature",
      chance_text(apart.log_p), campaign.bench.gauges[most.gauge].name,
      campaign.shots[most.shot].id, 100.0 * most.gain.value, 100.0 * most.gain.sd,
      most.delay_us.value, most.delay_us.sd);
}

/// What all gauges but one need alike is something of that one which the library does not have.
bool at_all_gauges_but_one(const Diagnosis& diagnosis, const Campaign& campaign) {
  std::map<std::string, std::size_t> gauges;
  for (const std::string& id : diagnosis.effects) {
    if (const auto colon = id.find(':'); colon != std::string::npos) {
      ++gauges[id.substr(0, colon)];
    }
  }
  const std::size_t most = campaign.gauges() - 1;
  return most > 1 && std::any_of(gauges.begin(), gauges.end(),
                                 [&](const auto& own) { return own.second >= most; });
}

bool of_two_gauges(const Campaign& campaign) {
  return campaign.bench.kind == BenchKind::bar && campaign.gauges() == 2;
}

/// Of a bar with two gauges what only begins is as well a channel that droops, and a true
/// relaxation that is no better known says no more than that.
bool only_imitates(const Studied& studied, const std::string& id) {
  const EffectUse* use = studied.model.find(id);
  return use != nullptr && only_begins(*use);
}

/// Of the lesser's change what both together make, at least. Of 69 true pairs it is 1.0 and more; a
/// gauge that creeps was a delay and a wrong position of it, with 0.01 to 0.36.
constexpr double kUndone = 0.5;

std::string undone_text(const Cancelling& pair) {
  return fmt::format(
      "{} and {} undo each other: both together change the records {:.2g} times as much as the "
      "lesser does by itself; what is left of them has a shape of something that the library lacks",
      pair.one, pair.other, pair.left);
}

double peak_strain_of(const Campaign& campaign) {
  double peak = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    peak = std::max(peak, shot.facts.peak_strain);
  }
  return peak;
}

/// Beyond the limit that a parameter has, beyond both where it has two: each is of something else
/// that is built so.
bool stronger_than_built(const EffectParameter& parameter, double value, double sd, double peak,
                         double slack) {
  // What is as strong as anything built comes out stronger every other time.
  constexpr double kDeviations = 3.0;
  constexpr double kExcused = 0.02;
  constexpr double kMostExcused = 0.1;
  const auto within = [&](double unit, double most) {
    const double excused =
        std::clamp(kDeviations * unit * sd, kExcused * most, kMostExcused * most);
    return most > 0.0 && unit * std::abs(value) - excused <= slack * most;
  };
  const bool limited = parameter.most > 0.0 || parameter.most_times_peak > 0.0;
  return limited && !within(1.0, parameter.most) && !within(peak, parameter.most_times_peak);
}

/// Why what was rejected is not it, though noise hardly explains as much.
std::string rejected_text(const CandidateResult& own, const Campaign& campaign) {
  // None that a model file declares has a limit.
  const Effect* effect = find_effect(own.effect);
  const bool stronger =
      effect != nullptr && stronger_than_built(effect->about().parameters[effect->about().strength],
                                               own.strength, own.sd, peak_strain_of(campaign), 1.0);
  return fmt::format("{} explains what noise leaves {}, but {}: something else is there",
                     own.effect, chance_text(own.log_p),
                     stronger
                         ? "would have to be stronger than anything is built"
                         : "shots do not foretell it of each other or disagree on it, or it is "
                           "no more than the limit of something else");
}

/// Of chi2 by what is claimed: all of it by the noise as it shows in the end, or one alone by that
/// which its rivals were weighed by.
double most_explained(const Diagnosis& diagnosis, double explained) {
  for (const CandidateResult& own : diagnosis.candidates) {
    if (std::ranges::count(diagnosis.effects, own.effect) > 0) {
      explained = std::max(explained, own.gain);
    }
  }
  return explained;
}

/// What explains so much that noise hardly would, and more than what is claimed does, though the
/// shots do not foretell it of each other or disagree on it, or nothing is built so: something is
/// there, and it is not that.
/// @param explained  by what is claimed, of chi2
const CandidateResult* surest_rejected(const Diagnosis& diagnosis, double explained) {
  // What is there leaves no more than noise does to gain, and what is as good is its own limit.
  constexpr double kAhead = 16.0;
  constexpr double kShare = 0.05;
  const double most = most_explained(diagnosis, explained);
  const double limit = most + std::max(kAhead, kShare * most);
  const CandidateResult* surest = nullptr;
  for (const CandidateResult& own : diagnosis.candidates) {
    if ((diagnosis.effects.empty() || own.gain > limit) && !own.per_shot &&
        own.verdict == CandidateVerdict::rejected &&
        own.log_p < (surest != nullptr ? surest->log_p : kSure)) {
      surest = &own;
    }
  }
  return surest;
}

}  // namespace

std::vector<std::string> beside_the_bar(const std::vector<std::string>& effects) {
  std::vector<std::string> counted = effects;
  std::erase_if(counted, [](const std::string& id) {
    return id == "end-reflection" || id == "geometric-dispersion";
  });
  return counted;
}

std::vector<std::string> surprises(const std::vector<std::string>& effects, const Model& fitted) {
  std::vector<std::string> counted = beside_the_bar(effects);
  std::erase_if(counted, [&](const std::string& id) {
    const EffectUse* use = fitted.find(id);
    return use != nullptr && is_its_formula(*use);
  });
  return counted;
}

bool beyond_belief(const Studied& studied, const std::string& id, const Campaign& campaign,
                   double slack) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr) {
    return false;
  }
  const double peak = peak_strain_of(campaign);
  const auto& parameters = use->effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (stronger_than_built(parameters[p], use->values[p].value, use->values[p].sd, peak, slack)) {
      return true;
    }
  }
  return false;
}

bool blames_bar_of_two_gauges(const Diagnosis& diagnosis, const Campaign& campaign) {
  return of_two_gauges(campaign) &&
         std::ranges::any_of(diagnosis.effects, [](const std::string& id) {
           const Effect* effect = find_effect(id);
           return effect != nullptr && (effect->about().stage == Stage::material ||
                                        effect->about().stage == Stage::propagation);
         });
}

std::string two_gauges_text() {
  return "of two gauges nothing tells what the bar does from what one of their channels does to "
         "all "
         "it reads (an amplifier that droops, an echo in a cable): exchange the channels, or add a "
         "gauge, and ask again";
}

bool blames_times_of_several_gauges(const Diagnosis& diagnosis, const Campaign& campaign) {
  const auto at_gauge_of = [&](const std::string& id, const std::string& bar) {
    return std::ranges::any_of(campaign.bench.gauges, [&](const Gauge& gauge) {
      return gauge.bar == bar && id.ends_with(":" + gauge.name);
    });
  };
  for (const std::string& bar : {std::string("input"), std::string("output")}) {
    const auto gauges = std::ranges::count_if(diagnosis.effects, [&](const std::string& id) {
      return at_gauge_of(id, bar) &&
             std::ranges::any_of(kOfTimes, [&](const char* kind) { return id.starts_with(kind); });
    });
    if (gauges > 1) {
      return true;
    }
  }
  return false;
}

std::string several_times_text() {
  return "several gauges of one bar are said to be reached at other times than foretold: a speed "
         "that changes along the bar (its temperature, its section) does so with one cause, which "
         "the library lacks; measure the bar along its length before these are added";
}

bool blames_even_loss(const Diagnosis& diagnosis) {
  return std::ranges::find(diagnosis.effects, "series-dashpot") != diagnosis.effects.end();
}

std::string even_loss_text() {
  return "series-dashpot takes the same share of waves of every frequency on each metre, as a bar "
         "does that widens on its way or rubs where it is held: no record tells these apart; "
         "measure the bar's diameter along it and lift it off its supports before it is believed";
}

std::string left_of_one_shot_text(const std::string& what, double misfit) {
  return fmt::format(
      "{} leaves {:.3g} times the noise before the pulse, and of one shot nothing tells noise from "
      "what is missing: repeat the shot",
      what, misfit);
}

std::string loud_text(const std::vector<LoudPulses>& loud, const Campaign& campaign) {
  std::string names;
  for (const std::size_t gauge : loudest(loud)) {
    names += (names.empty() ? "" : " or ") + campaign.bench.gauges[gauge].name;
  }
  return fmt::format(
      "{} reads the pulses with {:.2g} times the noise power of the quiet before them, which noise "
      "does {}, and not alike in every shot: something of it goes with what it reads; look at its "
      "bond, amplifier and converter",
      names, loud.front().power, chance_text(loud.front().log_p));
}

std::optional<std::string> where_text(const std::vector<LoudPulses>& loud,
                                      const Campaign& campaign) {
  if (!beyond_noise(loud.front()) || loudest(loud).size() > 1) {
    return std::nullopt;
  }
  return fmt::format(
      "most of it is at {}, {:.2g} times the noise power of its quiet; `kolsky compare` shows when "
      "and in which shots",
      campaign.bench.gauges[loud.front().gauge].name, loud.front().power);
}

std::vector<std::string> why_unknown(const Diagnosis& diagnosis, const Studied& current,
                                     const Campaign& campaign,
                                     const std::optional<Unexplained>& remains, double explained,
                                     double log_alpha) {
  std::vector<std::string> reasons;
  if (remains) {
    const bool apart = remains->apart.log_p < log_alpha;
    if (!apart || remains->common_log_p < log_alpha) {
      reasons.push_back(repeats_text(remains->common_log_p));
    }
    if (apart) {
      // It says where to look: about as sure, it comes first.
      constexpr double kAbout = 0.9;
      const bool as_sure = remains->apart.log_p < kAbout * remains->common_log_p;
      reasons.insert(as_sure ? reasons.begin() : reasons.end(),
                     apart_text(remains->apart, campaign));
    }
  }
  if (const CandidateResult* own = surest_rejected(diagnosis, explained)) {
    reasons.push_back(rejected_text(*own, campaign));
  }
  if (at_all_gauges_but_one(diagnosis, campaign)) {
    reasons.emplace_back(
        "the records ask for one effect at every gauge but one: it stands for something of that "
        "one which the library lacks");
  }
  if (surprises(diagnosis.effects, current.model).size() > kMostBelieved) {
    reasons.push_back(
        fmt::format("it takes {} effects of the library: likelier than that so many are missing is "
                    "that one is which the library lacks",
                    diagnosis.effects.size()));
  }
  for (const std::string& id : diagnosis.effects) {
    if (beyond_belief(current, id, campaign, 1.0)) {
      reasons.push_back(id + " would have to be stronger than anything is built");
    }
    if ((of_two_gauges(campaign) || diagnosis.effects.size() > 1) && only_imitates(current, id)) {
      reasons.push_back(id + " has neither a strength nor a time of its own: it stands for " +
                        (of_two_gauges(campaign)
                             ? "something slow, of the bar or of one of its two channels"
                             : "whatever slow is left beside what else was found"));
    }
  }
  if (const auto pair = most_cancelling(current, diagnosis.effects); pair && pair->left < kUndone) {
    reasons.push_back(undone_text(*pair));
  }
  return reasons;
}

}  // namespace kolsky
