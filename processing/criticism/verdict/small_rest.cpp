#include "processing/criticism/verdict/small_rest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

using Gain = std::pair<const std::string, double>;

bool explains_less(const Gain& one, const Gain& other) {
  return one.second < other.second;
}

/// What small rests are measured by: of formulas that stand beside each other, the greatest.
std::optional<Gain> least_of(const ClaimGains& gains) {
  if (gains.by_formula.empty()) {
    return std::nullopt;
  }
  const Gain formula = *std::ranges::max_element(gains.by_formula, explains_less);
  if (gains.others.empty()) {
    return formula;
  }
  return std::min(formula, *std::ranges::min_element(gains.others, explains_less), explains_less);
}

double little_beside(const ClaimGains& gains) {
  const std::optional<Gain> least = least_of(gains);
  return least ? kSmallRest * least->second : 0.0;
}

}  // namespace

ClaimGains claim_gains(Study& study, const Studied& current,
                       const std::vector<std::string>& effects, double noise) {
  ClaimGains gains;
  for (const std::string& id : beside_the_bar(effects)) {
    (may_be_its_formula(*current.model.find(id)) ? gains.by_formula : gains.others)[id] =
        (without(study, current, id).fit.objective() - current.fit.objective()) / noise;
  }
  return gains;
}

double small_rest(const ClaimGains& gains) {
  constexpr double kStillKnown = 0.1;  // of what a formula explains: a third of its strength
  if (gains.by_formula.empty()) {
    return 0.0;
  }
  const double formula = std::ranges::min_element(gains.by_formula, explains_less)->second;
  return std::min(little_beside(gains), kStillKnown * formula);
}

std::optional<std::string> dwarfed(const ClaimGains& gains) {
  if (gains.by_formula.empty() || gains.others.empty() ||
      gains.by_formula.size() + gains.others.size() < 3) {
    return std::nullopt;
  }
  const auto [id, gain] = *std::ranges::min_element(gains.others, explains_less);
  ClaimGains without_it = gains;
  without_it.others.erase(id);
  return gain < little_beside(without_it) ? std::optional(id) : std::nullopt;
}

double share_moved(const std::optional<SmallRest>& rest, const std::string& effect) {
  if (!rest) {
    return 0.0;
  }
  for (const auto* claims : {&rest->gains.by_formula, &rest->gains.others}) {
    if (const auto own = claims->find(effect); own != claims->end() && own->second > 0.0) {
      return std::sqrt(std::max(0.0, rest->chi2) / own->second);
    }
  }
  return 0.0;
}

std::string small_rest_text(const SmallRest& rest, const std::string& aside) {
  const auto [least, gain] = least_of(rest.gains).value();
  return fmt::format(
      "something is left that noise does not leave, {:.1g} % of what {} explains{}: formulas of a "
      "solid are seldom better, and what else there may be cannot be told beside them; deviations "
      "of these strengths allow for it",
      100.0 * rest.chi2 / gain, least,
      aside.empty() ? "" : " (" + aside + " would take up some of it)");
}

std::string dwarfed_text(ClaimGains gains, const std::string& aside) {
  const double own = gains.others.at(aside);
  gains.others.erase(aside);
  const auto [least, gain] = least_of(gains).value();
  return fmt::format(
      "{} would take up what is left, {:.1g} % of what {} explains: formulas of a solid are seldom "
      "better, and nothing tells which it is",
      aside, 100.0 * own / gain, least);
}

}  // namespace kolsky
