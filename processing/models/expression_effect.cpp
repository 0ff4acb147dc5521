#include "processing/models/expression_effect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {

namespace {

/// Names that stand for the place on the path, before the parameters.
std::vector<FormulaSymbol> symbols_of(const ExpressionText& text) {
  std::vector<FormulaSymbol> symbols;
  if (text.stage == Stage::record) {
    symbols = {{"strain", {}}};
  } else {
    symbols = {{"s", dimension_of("1/s")}, {"peak_strain", {}}, {"warmer_K", dimension_of("K")}};
    if (text.stage != Stage::material && text.stage != Stage::specimen) {
      symbols.push_back({"gamma_per_m", dimension_of("1/m")});
      symbols.push_back({"radius_m", dimension_of("m")});
      symbols.push_back({"poisson_ratio", {}});
    }
  }
  for (const EffectParameter& parameter : text.parameters) {
    const auto taken = [&](const FormulaSymbol& own) { return own.name == parameter.name; };
    if (parameter.name == "omega" || parameter.name == "pi" || parameter.name == "i" ||
        std::any_of(symbols.begin(), symbols.end(), taken)) {
      throw InputError("parameters." + parameter.name, "has a name that means something else here",
                       "rename it");
    }
    try {
      symbols.push_back({parameter.name, dimension_of(parameter.unit)});
    } catch (const InputError& error) {
      throw InputError("parameters." + parameter.name + ".unit",
                       error.place() + " " + error.problem(), error.mend());
    }
  }
  return symbols;
}

Formula formula_of(const ExpressionText& text) {
  try {
    return {text.formula, symbols_of(text)};
  } catch (const InputError& error) {
    throw error.place().starts_with("column") ? error.inside("formula") : error;
  }
}

std::string definition_of(const ExpressionText& text) {
  switch (text.stage) {
    case Stage::material:
      return "J += " + text.formula;
    case Stage::specimen:
      return "specimen's J += " + text.formula;
    case Stage::propagation:
      return "gamma x (" + text.formula + ")";
    case Stage::boundary:
      return "far end's stress reflection += " + text.formula;
    case Stage::sensor:
      return "reading x (" + text.formula + ")";
    default:
      return "reading = " + text.formula;
  }
}

EffectAbout about_of(const ExpressionText& text) {
  EffectAbout about;
  about.id = text.id;
  about.stage = text.stage;
  about.definition = definition_of(text);
  about.reference = text.note.empty() ? "the model file" : text.note;
  about.kinds = text.stage == Stage::specimen ? std::vector{BenchKind::shpb}
                                              : std::vector{BenchKind::bar, BenchKind::shpb};
  about.parameters = text.parameters;
  // Strengths first: searches and reports go by the first parameter.
  std::stable_partition(about.parameters.begin(), about.parameters.end(),
                        [](const EffectParameter& own) { return !own.auxiliary(); });
  about.per_gauge = text.stage == Stage::sensor || (text.stage == Stage::record && text.per_gauge);
  about.per_shot = text.per_shot;
  return about;
}

ExpressionText in_order(ExpressionText text) {
  text.parameters = about_of(text).parameters;
  return text;
}

void require_unit(const ExpressionText& text, const Formula& formula) {
  const bool compliance = text.stage == Stage::material || text.stage == Stage::specimen;
  const Dimension wanted = dimension_of(compliance ? "1/Pa" : "-");
  if (!formula.dimension().same(wanted)) {
    throw InputError("formula",
                     "is in " + formula.dimension().text() + ", and a " + name_of(text.stage) +
                         " takes " + (compliance ? "1/Pa (" + wanted.text() + ")" : wanted.text()),
                     "mend the formula or its parameters' units");
  }
}

void add_to(std::vector<Complex>& sum, const std::vector<Complex>& term) {
  sum.resize(term.size(), 0.0);
  for (std::size_t k = 0; k < term.size(); ++k) {
    sum[k] += term[k];
  }
}

void multiply(std::vector<Complex>& product, const std::vector<Complex>& factor) {
  for (std::size_t k = 0; k < std::min(product.size(), factor.size()); ++k) {
    product[k] *= factor[k];
  }
}

}  // namespace

ExpressionEffect::ExpressionEffect(ExpressionText text)
    : Effect([&] {
        EffectAbout about = about_of(text);
        const Formula formula = formula_of(in_order(text));
        about.shot_facts = formula.uses("peak_strain") || formula.uses("warmer_K");
        return about;
      }()),
      text_(in_order(std::move(text))),
      formula_(formula_of(text_)) {
  require_unit(text_, formula_);
  for (const EffectParameter& parameter : text_.parameters) {
    if (!formula_.uses(parameter.name)) {
      throw InputError("parameters." + parameter.name, "is not in the formula",
                       "use it there, or remove it");
    }
  }
  if (text_.parameters.empty() || text_.parameters.front().auxiliary()) {
    throw InputError("parameters", "hold no strength, whose null value takes the effect away",
                     "give one parameter a null value instead of starts");
  }
}

std::vector<Complex> ExpressionEffect::along(const Scene& scene, const BarScene& bar,
                                             std::span<const double> values) const {
  std::vector<Complex> numbers{scene.facts->peak_strain, scene.facts->warmer_by_K.value_or(0.0)};
  const bool waves = text_.stage != Stage::material && text_.stage != Stage::specimen;
  if (waves) {
    numbers.insert(numbers.end(), {bar.radius_m, bar.poisson_ratio});
  }
  numbers.insert(numbers.end(), values.begin(), values.end());
  std::vector<std::span<const Complex>> all{scene.s};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i == 2 && waves) {
      all.emplace_back(bar.gamma_per_m);
    }
    all.emplace_back(&numbers[i], 1);
  }
  std::vector<Complex> out(scene.s.size());
  formula_.evaluate(all, out);
  return out;
}

void ExpressionEffect::apply(Scene& scene, std::span<const double> values,
                             std::size_t gauge) const {
  switch (text_.stage) {
    case Stage::material:
      for (BarScene& bar : scene.bars) {
        if (!bar.elastic) {
          add_to(bar.solid.further_per_Pa, along(scene, bar, values));
        }
      }
      break;
    case Stage::specimen:
      add_to(scene.specimen->solid.further_per_Pa, along(scene, scene.bars.front(), values));
      break;
    case Stage::propagation:
      for (BarScene& bar : scene.bars) {
        multiply(bar.gamma_per_m, along(scene, bar, values));
      }
      break;
    case Stage::boundary:
      add_to(scene.bars.back().further_reflection, along(scene, scene.bars.back(), values));
      break;
    case Stage::sensor:
      multiply(scene.gauges[gauge].factor,
               along(scene, scene.bars[scene.gauges[gauge].bar], values));
      break;
    default: {
      auto& maps = scene.record.maps;
      maps.resize(scene.gauges.size());
      for (std::size_t j = 0; j < maps.size(); ++j) {
        if (about().per_gauge && j != gauge) {
          continue;
        }
        maps[j].emplace_back([this, numbers = std::vector<Complex>(values.begin(), values.end())](
                                 std::span<const Complex> strain, std::span<Complex> reading) {
          std::vector<std::span<const Complex>> all{strain};
          for (const Complex& number : numbers) {
            all.emplace_back(&number, 1);
          }
          formula_.evaluate(all, reading);
        });
      }
    }
  }
}

}  // namespace kolsky
