#include "clients/cli/reports/diagnosis_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include "clients/cli/reports/criticism_text.hpp"
#include "clients/cli/reports/model_text.hpp"

namespace kolsky::cli {

namespace {

bool claimed(const CandidateResult& result) {
  return result.verdict == CandidateVerdict::named || result.verdict == CandidateVerdict::tied;
}

/// What an experimenter wants to see beside what is claimed.
bool came_into_question(const CandidateResult& result) {
  return claimed(result) || result.verdict == CandidateVerdict::rejected ||
         result.verdict == CandidateVerdict::unconfirmed;
}

std::string notes_text(const Diagnosis& diagnosis) {
  std::string text;
  for (const std::string& note : diagnosis.notes) {
    text += "  note: " + note + "\n";
  }
  return text;
}

/// How `kolsky model add` has to be told of what was found.
std::string added_as_text(const Diagnosis& diagnosis, const std::string& id) {
  const EffectUse* use = diagnosis.model ? diagnosis.model->find(id) : nullptr;
  return use != nullptr && use->per_shot
             ? "   with a strength of every shot's own (`model add --per-shot`)"
             : "";
}

std::string missing_text(const Diagnosis& diagnosis) {
  std::string text;
  for (const std::string& id : diagnosis.effects) {
    text += "  missing: " + id + added_as_text(diagnosis, id);
    const auto& ties = diagnosis.tied_with.at(id);
    for (std::size_t i = 0; i < ties.size(); ++i) {
      text += (i == 0 ? "   (cannot be told from " : ", ") + ties[i];
    }
    text += ties.empty() ? "\n" : ")\n";
  }
  return text;
}

std::string chance_text(double log_p) {
  if (log_p < kLeastTold) {
    return "< 1e-12";
  }
  return fmt::format("{:.2g}", std::exp(log_p));
}

/// Claimed first, then what came into question, then what noise makes least likely.
std::vector<CandidateResult> ranked(const Diagnosis& diagnosis) {
  std::vector<CandidateResult> list;
  std::ranges::copy_if(
      diagnosis.candidates, std::back_inserter(list),
      [](const CandidateResult& c) { return c.verdict != CandidateVerdict::untestable; });
  std::ranges::stable_sort(list, {}, [](const CandidateResult& c) {
    return std::tuple(!claimed(c), !came_into_question(c), c.log_p, c.own_log_p);
  });
  return list;
}

std::string size_text(double size) {
  return std::isfinite(size) ? fmt::format("{:.2g}", size) : "-";
}

std::string row_text(const CandidateResult& c) {
  return fmt::format("  {:<27} {:>28} {:>9} {:>10} {:>10} {:>11} {:>10}  {}\n", c.effect,
                     strength_text(c), chance_text(c.log_p), gain_text(c.gain),
                     gain_text(c.held_out_gain), size_text(c.detectable), size_text(c.identifiable),
                     kolsky::name_of(c.verdict));
}

/// Only of the verdicts that are there.
std::string legend_text(const std::vector<CandidateResult>& shown) {
  std::string text =
      "\n  by chance: how often noise alone does as well, the search over all effects counted;\n"
      "  gain: of chi-square, over what noise and the shots' scatter leave of it, and the same on\n"
      "  shots which the strength was not found in;\n"
      "  detectable: the smallest change that stands at 6 deviations here; told apart: and at 5\n"
      "  beside the effect that resembles it most; -: none does within its bounds.\n";
  constexpr std::array<std::pair<CandidateVerdict, const char*>, 3> kMeanings{
      {{CandidateVerdict::rejected,
        "it gains, but other shots do not foretell it, the shots disagree on it, the quiet before "
        "the pulse lacks it, nothing is built so strong, or it stands in for something else"},
       {CandidateVerdict::unconfirmed,
        "it gains with a strength of each shot's own, as slow noise would, and nothing else in the "
        "records shows it"},
       {CandidateVerdict::not_needed, "noise gains as much, or others explain it"}}};
  for (const auto& [verdict, meaning] : kMeanings) {
    if (std::ranges::count(shown, verdict, &CandidateResult::verdict) > 0) {
      text += fmt::format("  {}: {}.\n", kolsky::name_of(verdict), meaning);
    }
  }
  return text;
}

std::string untestable_text(const Diagnosis& diagnosis) {
  std::string text;
  for (const CandidateResult& c : diagnosis.candidates) {
    if (c.verdict == CandidateVerdict::untestable) {
      text += (text.empty() ? "" : ", ") + c.effect;
    }
  }
  return text.empty()
             ? ""
             : "  untestable here, for what is fitted takes up all of it or no strength within\n"
               "  reach shows in what is judged: " +
                   text + ".\n";
}

std::string candidates_text(const Diagnosis& diagnosis) {
  constexpr std::ptrdiff_t kShown = 10;
  std::vector<CandidateResult> list = ranked(diagnosis);
  const auto all = std::ssize(list);
  const auto shown =
      std::min(all, std::max(kShown, std::ranges::count_if(list, came_into_question)));
  list.resize(static_cast<std::size_t>(shown));
  std::string text =
      fmt::format("\n  {:<27} {:>28} {:>9} {:>10} {:>10} {:>11} {:>10}\n", "effect", "strength",
                  "by chance", "chi2 gain", "held out", "detectable", "told apart");
  for (const CandidateResult& c : list) {
    text += row_text(c);
  }
  if (all > shown) {
    text += fmt::format("  and {} more that are not needed (--json has all)\n", all - shown);
  }
  return text + legend_text(list) + untestable_text(diagnosis);
}

std::string separates_text(const NextExperiment& next) {
  if (next.separates.size() < 2) {
    return "";
  }
  std::string text = "        to tell " + next.separates.front() + " from ";
  for (std::size_t i = 1; i < next.separates.size(); ++i) {
    text += (i == 1 ? "" : ", ") + next.separates[i];
  }
  return text + "\n";
}

}  // namespace

std::string strength_text(double value, double sd, const std::string& unit) {
  if (!std::isfinite(value) || !std::isfinite(sd)) {
    return "";
  }
  const double largest = std::max(std::abs(value), sd);
  const int power = largest > 0.0 ? 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0)) : 0;
  const double scale = std::pow(10.0, -power);
  constexpr int kMostDecimals = 5;
  const int decimals =
      sd > 0.0
          ? std::clamp(1 - static_cast<int>(std::floor(std::log10(sd * scale))), 0, kMostDecimals)
          : 3;
  const double tick = std::pow(10.0, -decimals);
  const double shown = std::round(value * scale / tick) * tick + 0.0;  // never "-0.0"
  const std::string numbers =
      fmt::format("{:.{}f} ± {:.{}f}", shown, decimals, sd * scale, decimals);
  const std::string scaled = power == 0 ? numbers : fmt::format("({})e{}", numbers, power);
  return unit == "-" ? scaled : scaled + " " + unit;
}

std::string strength_text(const CandidateResult& c) {
  const std::string text = strength_text(c.strength, c.sd, c.unit);
  const Effect* effect = find_effect(c.effect.substr(0, c.effect.find(':')));
  const bool another = effect != nullptr && !effect->about().quadrature &&
                       effect->about().parameters.front().name != c.parameter;
  return another && !text.empty() ? c.parameter + " = " + text : text;
}

std::string gain_text(double gain) {
  constexpr double kFitsAColumn = 1e7;
  if (!std::isfinite(gain)) {
    return "";
  }
  // Rounded first, so that no "-0.0" comes out.
  return std::abs(gain) < kFitsAColumn ? fmt::format("{:.1f}", std::round(10.0 * gain) / 10.0 + 0.0)
                                       : fmt::format("{:.1g}", gain);
}

std::string floor_name(double chi2) {
  constexpr double kScattered = 1.25;
  return chi2 > kScattered ? "noise and what differs from shot to shot" : "noise alone";
}

std::string diagnosis_text(const Diagnosis& diagnosis) {
  std::string text =
      "verdict: " + kolsky::name_of(diagnosis.verdict) + "\n" + missing_text(diagnosis);
  if (!diagnosis.model) {
    return text + notes_text(diagnosis);
  }
  const HeldOut& held_out = diagnosis.held_out;
  text += fmt::format("  held-out misfit {:.4f} -> {:.4f}, {} {:.4f}{}\n", held_out.before,
                      held_out.after, floor_name(held_out.floor), held_out.floor,
                      judged_text(diagnosis.before));
  text += notes_text(diagnosis);
  if (const std::string strained = strained_list(*diagnosis.model); !strained.empty()) {
    text += "  strained, in filed deviations: " + strained +
            ": not as filed, or in place of what is missing\n";
  }
  text += candidates_text(diagnosis);
  for (const NextExperiment& next : diagnosis.next_experiment) {
    text += "\n  next: " + next.change + "\n" + separates_text(next);
  }
  return text;
}

}  // namespace kolsky::cli
