#include "processing/criticism/verdict/filed_bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace kolsky {

namespace {

constexpr std::array<const char*, 2> kViscoelastic{"three-element-bar", "output-three-element-bar"};
constexpr std::array<const char*, 2> kElastic{"bar-modulus", "output-bar-modulus"};

bool is_filed(const ModelValue& value) {
  return !value.free || value.prior_sd > 0.0;
}

void let_go(EffectUse& use) {
  for (ModelValue& value : use.values) {
    value.free = true;
    value.prior_sd = 0.0;
  }
  use.prior_correlation.clear();
}

/// A change of elastic bars' modulus, which a bench that states no deviation holds at none.
EffectUse& elastic_change(Model& model, const std::string& id) {
  if (model.find(id) == nullptr) {
    model.effects.push_back(null_use(*find_effect(id), ""));
  }
  return *model.find(id);
}

std::string change_text(const std::string& name, double change, double sd) {
  return fmt::format("{} {:+.2g} ± {:.1g} %", name, 100.0 * change, 100.0 * sd);
}

}  // namespace

std::optional<Model> with_bars_of_any_moduli(const Model& model, const Bench& bench) {
  Model any = model;
  bool filed = false;
  for (const std::string id : kViscoelastic) {
    if (EffectUse* bars = any.find(id)) {
      filed = filed || std::ranges::any_of(bars->values, is_filed);
      let_go(*bars);
    }
  }
  const std::array elastic{bench.input.youngs_modulus_Pa.has_value(),
                           bench.output && bench.output->youngs_modulus_Pa};
  for (std::size_t bar = 0; bar < elastic.size(); ++bar) {
    if (elastic[bar]) {
      filed = true;
      let_go(elastic_change(any, kElastic[bar]));
    }
  }
  return filed ? std::optional(std::move(any)) : std::nullopt;
}

std::string other_bars_text(const Model& model, const Model& fitted, OtherBars bars) {
  std::string moduli;
  // A number that is less than two of its deviations says nothing of a bar.
  const auto add = [&](const std::string& name, double change, double sd) {
    constexpr double kKnown = 2.0;
    if (std::abs(change) > kKnown * sd) {
      moduli += (moduli.empty() ? "" : ", ") + change_text(name, change, sd);
    }
  };
  for (const std::string id : kViscoelastic) {
    const EffectUse* filed = model.find(id);
    const EffectUse* found = fitted.find(id);
    for (std::size_t p = 0; filed != nullptr && p < filed->values.size(); ++p) {
      const ModelValue& own = filed->values[p];
      const double value = own.prior_sd > 0.0 ? own.prior_mean : own.value;
      add(filed->effect->about().parameters[p].name, found->values[p].value / value - 1.0,
          found->values[p].sd / value);
    }
  }
  for (const std::string id : kElastic) {
    if (const EffectUse* found = fitted.find(id)) {
      add(id, found->values[0].value, found->values[0].sd);
    }
  }
  const bool identified = std::ranges::any_of(
      kViscoelastic, [&](const std::string& id) { return model.find(id) != nullptr; });
  return std::string("bars of other moduli than filed explain ") +
         (bars == OtherBars::explain_more ? "more of it (" : "nearly as much (") +
         (moduli.empty() ? "these records do not tell which" : moduli) + "): " +
         (identified ? "identify the bars again, at the shots' temperature"
                     : "measure their wave speed (`kolsky calibrate`); a modulus or density that "
                       "is filed without a deviation counts as exact");
}

bool is_one_modulus(const std::string& effect, const std::vector<CampaignShot>& shots) {
  constexpr double kAlike = 0.1;
  const bool by_temperature = effect == "temperature";
  if (!by_temperature && effect != "amplitude-dependence") {
    return false;
  }
  std::vector<double> amounts;
  for (const CampaignShot& shot : shots) {
    amounts.push_back(by_temperature ? shot.facts.warmer_by_K.value_or(0.0)
                                     : shot.facts.peak_strain);
  }
  const auto [least, most] = std::ranges::minmax(amounts);
  return most - least < kAlike * std::max(std::abs(least), std::abs(most));
}

std::string one_modulus_text(const std::string& effect) {
  return "; that is all that " + effect + " is here, as all shots have nearly the same " +
         (effect == "temperature" ? "temperature" : "amplitude: shoot at others, too");
}

std::string no_temperature_text() {
  return "a temperature dependence with bars of other moduli than filed explains as much as two "
         "effects: file `temperature_K`, at which the bars' moduli hold";
}

}  // namespace kolsky
