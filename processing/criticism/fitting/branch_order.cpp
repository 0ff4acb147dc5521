#include "processing/criticism/fitting/branch_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace kolsky {

namespace {

struct Pair {
  const char* base;     ///< parameters E1, E2, eta2
  const char* further;  ///< parameters D, tau
};

constexpr std::array kPairs{Pair{"three-element-bar", "second-relaxation"},
                            Pair{"three-element-specimen", "specimen-second-relaxation"}};

/// The free number of an effect's parameter, where nothing filed holds it.
std::optional<std::size_t> free_number(const Composition& composition, const std::string& id,
                                       std::size_t parameter) {
  for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (number.parameter == parameter && number.shot < 0 && number.prior_sd == 0.0 &&
        composition.uses()[number.use].id() == id) {
      return i;
    }
  }
  return std::nullopt;
}

bool put_in_order(const Composition& composition, const Pair& pair, std::vector<double>& theta) {
  const auto E2 = free_number(composition, pair.base, 1);
  const auto eta2 = free_number(composition, pair.base, 2);
  const auto D = free_number(composition, pair.further, 0);
  const auto tau = free_number(composition, pair.further, 1);
  if (!E2 || !eta2 || !D || !tau) {
    return false;
  }
  const auto value = [&](std::size_t i) { return composition.numbers()[i].value_at(theta[i]); };
  const double own = value(*D);
  if (!(own * value(*E2) > 1.0)) {
    return false;
  }
  const auto set = [&](std::size_t i, double to) {
    const FreeNumber& number = composition.numbers()[i];
    theta[i] = number.inside(number.theta_of(to));
  };
  const double own_s = value(*tau);
  const double base_s = value(*eta2) / value(*E2);
  set(*D, 1.0 / value(*E2));
  set(*tau, base_s);
  set(*E2, 1.0 / own);
  set(*eta2, own_s / own);
  return true;
}

}  // namespace

bool put_branches_in_order(const Composition& composition, std::vector<double>& theta) {
  // A fractional element is not like the other.
  const bool alike = std::none_of(
      composition.uses().begin(), composition.uses().end(),
      [](const EffectUse& use) { return use.effect->about().id == "fractional-damping"; });
  bool changed = false;
  for (const Pair& pair : kPairs) {
    changed = (alike && put_in_order(composition, pair, theta)) || changed;
  }
  return changed;
}

OwnBranch own_branch(const Model& model, const std::string& further) {
  const auto pair = std::find_if(kPairs.begin(), kPairs.end(),
                                 [&](const Pair& one) { return one.further == further; });
  const EffectUse* own = pair != kPairs.end() ? model.find(pair->base) : nullptr;
  if (own == nullptr) {
    return {};
  }
  const ModelValue& E2 = own->values[1];
  return {own->values[2].value / E2.value, E2.sd < E2.value};
}

std::optional<std::string> either_branch_text(const Model& model, const std::string& further) {
  constexpr double kMuch = 1.0 / 3.0;
  const EffectUse* use = model.find(further);
  const auto pair = std::find_if(kPairs.begin(), kPairs.end(),
                                 [&](const Pair& one) { return one.further == further; });
  const EffectUse* own = pair != kPairs.end() ? model.find(pair->base) : nullptr;
  if (use == nullptr || own == nullptr || use->values[0].value * own->values[1].value < kMuch) {
    return std::nullopt;
  }
  return fmt::format(
      "{}: which of two branches is called further is a convention, and it may as well be the "
      "material's own: the other has D = 1/E2 = {:.4g} 1/Pa and tau = eta2/E2 = {:.4g} s",
      further, 1.0 / own->values[1].value, own->values[2].value / own->values[1].value);
}

}  // namespace kolsky
