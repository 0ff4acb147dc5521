#pragma once

#include <string>
#include <vector>

#include "processing/models/effect.hpp"

namespace kolsky {

/// A parameter's number in a model.
struct ModelValue {
  double value = 0.0;
  double sd = 0.0;          ///< from the fit, or as filed; 0: exact or not yet known
  bool free = true;         ///< a fit may move it
  double prior_sd = 0.0;    ///< how far a filed number may be off; 0: nothing is known beforehand
  double prior_mean = 0.0;  ///< the filed number; means nothing without a prior_sd
};

/// One effect as a model uses it.
struct EffectUse {
  const Effect* effect = nullptr;
  std::string gauge;               ///< for effects of one gauge
  bool per_shot = false;           ///< strengths of their own for every shot
  bool alike = false;              ///< the same at all gauges, where each could have its own
  std::vector<ModelValue> values;  ///< one per parameter; of strengths per shot or gauge the mean

  /// "gauge-position:g3".
  [[nodiscard]] std::string id() const;
};

/// A model of an experiment: a composition of effects.
struct Model {
  BenchKind kind = BenchKind::bar;
  std::vector<EffectUse> effects;

  [[nodiscard]] const EffectUse* find(const std::string& id) const;
  [[nodiscard]] EffectUse* find(const std::string& id);
};

/// An effect at its null values, auxiliary parameters at the first of their starts, all free.
[[nodiscard]] EffectUse null_use(const Effect& effect, const std::string& gauge = {});

/// Splits "gauge-position:g3" and looks the effect up.
/// @throws InputError where there is no such effect, or a gauge is missing or too many
[[nodiscard]] EffectUse use_named(const std::string& id);

/// The paper's model (INTERFACE: where every diagnosis starts), moduli free and, for a split bar,
/// those of the bars held.
/// @param elastic  the bench gives the bars' modulus
[[nodiscard]] Model paper_model(BenchKind kind, bool elastic);

}  // namespace kolsky
