#include "processing/criticism/verdict/filed_bars.hpp"

#include <fmt/format.h>

namespace kolsky {

namespace {

constexpr const char* kBars = "three-element-bar";

}  // namespace

std::optional<Model> with_bars_of_any_moduli(const Model& model) {
  Model any = model;
  EffectUse* bars = any.find(kBars);
  bool filed = false;
  if (bars != nullptr) {
    for (ModelValue& value : bars->values) {
      filed = filed || !value.free || value.prior_sd > 0.0;
      value.free = true;
      value.prior_sd = 0.0;
    }
    bars->prior_correlation.clear();
  }
  return filed ? std::optional(std::move(any)) : std::nullopt;
}

std::string other_bars_text(const Model& model, const Model& fitted) {
  const EffectUse& filed = *model.find(kBars);
  const EffectUse& found = *fitted.find(kBars);
  std::string moduli;
  for (std::size_t p = 0; p < filed.values.size(); ++p) {
    const ModelValue& own = filed.values[p];
    const double value = own.prior_sd > 0.0 ? own.prior_mean : own.value;
    moduli += fmt::format("{}{} {:+.2g} ± {:.1g} %", moduli.empty() ? "" : ", ",
                          filed.effect->about().parameters[p].name,
                          100.0 * (found.values[p].value / value - 1.0),
                          100.0 * found.values[p].sd / value);
  }
  return "bars of other moduli than filed explain more of it (" + moduli +
         "): identify the bars again, at the shots' temperature";
}

}  // namespace kolsky
