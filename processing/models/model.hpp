#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/material.hpp"
#include "processing/models/expression_effect.hpp"

namespace kolsky {

/// A parameter's number in a model.
struct ModelValue {
  double value = 0.0;
  double sd = 0.0;          ///< from the fit, or as filed; 0: exact or not yet known
  bool free = true;         ///< a fit may move it
  double prior_sd = 0.0;    ///< how far a filed number may be off; 0: nothing is known beforehand
  double prior_mean = 0.0;  ///< the filed number; means nothing without a prior_sd
  /// Narrower than the parameter's own: least and most that a fit may make of it.
  std::optional<std::array<double, 2>> bounds{};
};

/// One effect as a model uses it.
struct EffectUse {
  const Effect* effect = nullptr;
  std::string gauge;      ///< for effects of one gauge
  bool per_shot = false;  ///< strengths of their own for every shot
  bool alike = false;     ///< the same at all gauges, where each could have its own
  /// Whether one strength serves all shots or each has its own is for the next fit to find.
  bool form_open = false;
  std::vector<ModelValue> values;  ///< one per parameter; of strengths per shot or gauge the mean
  /// Of the priors among each other, parameters x parameters row by row; empty: independent.
  std::vector<double> prior_correlation{};

  /// "gauge-position:g3".
  [[nodiscard]] std::string id() const;
};

/// A model of an experiment: a composition of effects.
struct Model {
  BenchKind kind = BenchKind::bar;
  std::vector<EffectUse> effects;
  /// Effects of its own besides the library's, whether it uses them or not; uses point into these.
  std::vector<std::shared_ptr<const ExpressionEffect>> expressions{};

  [[nodiscard]] const EffectUse* find(const std::string& id) const;
  [[nodiscard]] EffectUse* find(const std::string& id);
};

/// An effect at its null values, auxiliary parameters at the first of their starts, all free.
[[nodiscard]] EffectUse null_use(const Effect& effect, const std::string& gauge = {});

/// Splits "gauge-position:g3" and looks the effect up, in the library.
/// @throws InputError where there is no such effect, or a gauge is missing or too many
[[nodiscard]] EffectUse use_named(const std::string& id);
/// The same in the library and among the model's own expressions.
[[nodiscard]] EffectUse use_named(const std::string& id, const Model& model);

/// The library's effects and those that the model declares.
[[nodiscard]] std::vector<const Effect*> effects_known_to(const Model& model);

/// A layer of the ball as a material file has it: what is filed with a deviation is free within it,
/// the moduli with their covariance where there is one; the rest is held.
void take_layer(const Material& material, EffectUse& layer);

/// The moduli of a split bar's bars, likewise.
void take_bars(const Material& material, EffectUse& bars);

/// "bar", "shpb" or "impact".
[[nodiscard]] std::string name_of(BenchKind kind);

/// The paper's model (INTERFACE: where every diagnosis starts), moduli free and, for a split bar,
/// those of the bars held. An impact: the paper's core and cover.
/// @param elastic  the bench gives the bars' modulus
[[nodiscard]] Model paper_model(BenchKind kind, bool elastic);

}  // namespace kolsky
