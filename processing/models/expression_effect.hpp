#pragma once

#include <memory>
#include <string>
#include <vector>

#include "processing/models/effect.hpp"
#include "processing/models/formula.hpp"

namespace kolsky {

struct BarScene;

/// An effect as a model file declares it.
struct ExpressionText {
  std::string id;
  Stage stage = Stage::material;
  std::string formula;
  std::string note{};      ///< for people
  bool per_gauge = false;  ///< of maps; a sensor's transfer always is
  bool per_shot = false;
  std::vector<EffectParameter> parameters{};
};

/// Physics that a user adds to a model without compiling: a formula at one stage.
///
/// | stage | the formula is | its unit | null |
/// |---|---|---|---|
/// | material | added to the bars' compliance J(s) | 1/Pa | 0 |
/// | specimen | added to the specimen's compliance | 1/Pa | 0 |
/// | propagation | a factor of gamma(s) | - | 1 |
/// | boundary | added to the far end's stress reflection | - | 0 |
/// | sensor | a factor of one gauge's reading | - | 1 |
/// | record | the reading, of the strain | - | strain |
///
/// It may use its parameters and, but for `record`, s, omega = -i s, and the shot's `peak_strain`
/// and `warmer_K`; from `propagation` on also gamma_per_m, radius_m and poisson_ratio of the bar.
class ExpressionEffect final : public Effect {
 public:
  /// @throws InputError whose place is a key of the declaration: "formula: column 3",
  /// "parameters.D.unit"
  explicit ExpressionEffect(ExpressionText text);

  [[nodiscard]] const ExpressionText& text() const { return text_; }
  [[nodiscard]] const Formula& formula() const { return formula_; }

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override;

 private:
  /// The formula along a scene's path, waves being those of one bar.
  [[nodiscard]] std::vector<Complex> along(const Scene& scene, const BarScene& bar,
                                           std::span<const double> values) const;

  ExpressionText text_;
  Formula formula_;
};

}  // namespace kolsky
