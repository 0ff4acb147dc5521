#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"

namespace kolsky {

struct Scene;

/// Where in the chain from impact to file an effect acts; they act in this order.
enum class Stage { bench, material, propagation, boundary, specimen, sensor, record };

[[nodiscard]] std::string name_of(Stage stage);

struct EffectParameter {
  std::string name;         ///< "D"
  std::string unit;         ///< "1/Pa"; "-" for none
  double null_value = 0.0;  ///< with which the effect is not there
  double lower = 0.0;       ///< bounds of what is physical
  double upper = 0.0;
  double typical = 0.0;  ///< a step that matters: scales derivatives and searches
  /// An auxiliary parameter (a relaxation time) means nothing while the strength is null: these
  /// are the values from which searches start. Empty for a strength.
  std::vector<double> starts{};

  /// Present or not: first order asks for a share of it, a model that holds the effect has it
  /// whole.
  bool is_switch = false;
  double difference = 2e-3;  ///< step of numeric derivatives, in typical sizes
  bool chosen = false;       ///< one of its starts and nothing between (a neighbour, a harmonic)
  /// The records change with this power of it near null: fits move value^power.
  double power = 1.0;
  /// |value|, or |value| x peak strain, beyond which nothing is built so and a fit is one to noise
  /// or to what the library lacks; 0: no such limit. Of two it is only beyond both.
  double most = 0.0;
  double most_times_peak = 0.0;
  /// First order at null says nothing of a finite size, in which it acts otherwise (a gap that
  /// closes): fits begin at several.
  bool sudden = false;
  /// With any but the first of its starts the effect has the strength of its formula and no other:
  /// a size that is filed is in it otherwise, too.
  bool only_by_formula = false;
  /// The strength that the effect has by its formula with the sizes filed; 0: none is known.
  double by_formula = 0.0;

  [[nodiscard]] bool auxiliary() const { return !starts.empty(); }
};

/// What a number is of which x is the power, with its sign.
[[nodiscard]] inline double root(double x, double power) {
  return power == 1.0 ? x : std::copysign(std::pow(std::abs(x), 1.0 / power), x);
}

/// What people are told of an effect.
struct EffectAbout {
  std::string id;
  Stage stage = Stage::material;
  std::string definition;  ///< one line, with the parameters' symbols
  std::string reference;
  std::vector<BenchKind> kinds;
  std::vector<EffectParameter> parameters;
  bool per_gauge = false;    ///< used once a gauge: "gauge-position:g3"
  bool each_gauge = false;   ///< one effect with strengths of their own at every gauge
  bool per_shot = false;     ///< its strength may differ from shot to shot
  bool shot_facts = false;   ///< depends on the shot's amplitude or temperature
  bool base = false;         ///< of the paper's model; never a candidate
  bool told_only = false;    ///< no candidate either, unless it is filed: people are told of it
  std::size_t strength = 0;  ///< the parameter that people call its strength
  bool quadrature = false;   ///< its first two parameters are cosine and sine of one amplitude
};

/// A physical or instrumental effect that a model may hold. One small class in one file of
/// processing/models/effects, which defines `const Effect& <file name>_effect()`; nothing else
/// needs to know of it.
class Effect {
 public:
  explicit Effect(EffectAbout about) : about_(std::move(about)) {}
  virtual ~Effect() = default;
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;

  [[nodiscard]] const EffectAbout& about() const { return about_; }

  /// Changes the scene at the effect's stage.
  /// @param values  one per parameter
  /// @param gauge   its place in the bench, for effects of one gauge
  virtual void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const = 0;

  /// Relative deviation of its strength by that of filed numbers which the formula goes by and no
  /// number of a model stands for.
  [[nodiscard]] virtual double filed_share(const Bench& /*bench*/) const { return 0.0; }

  /// What keeps the effect from being tested on this bench at all; empty where nothing does.
  [[nodiscard]] virtual std::string untestable_because(const Bench& /*bench*/) const { return {}; }

 private:
  EffectAbout about_;
};

/// All effects, in the order of their file names.
[[nodiscard]] const std::vector<const Effect*>& effect_library();

/// @return nullptr where there is no such effect
[[nodiscard]] const Effect* find_effect(const std::string& id);

}  // namespace kolsky
