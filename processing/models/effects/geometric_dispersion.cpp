#include <cmath>

#include "processing/models/effect.hpp"
#include "processing/models/exact_waves.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class GeometricDispersion final : public Effect {
 public:
  GeometricDispersion()
      : Effect({
            .id = "geometric-dispersion",
            .stage = Stage::propagation,
            .definition = "gamma, surface-to-mean += s (exact first mode - elementary)",
            .reference = "docs/methods/effects.md; Pochhammer 1876, Chree 1889",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"s", "-", 0.0, 0.0, 3.0, 0.1, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (values[0] != 0.0) {
      for (BarScene& bar : scene.bars) {
        blend_exact_waves(bar, scene.s, values[0]);
      }
    }
  }

  /// It grows with the square of Poisson's ratio times the radius. Between two bars a diameter is a
  /// number of its own.
  [[nodiscard]] double filed_share(const Bench& bench) const override {
    const double diameter =
        bench.kind == BenchKind::bar ? relative_sd(bench.input.diameter_m) : 0.0;
    return 2.0 * std::hypot(relative_sd(bench.input.poisson_ratio), diameter);
  }
};

}  // namespace

const Effect& geometric_dispersion_effect();
const Effect& geometric_dispersion_effect() {
  static const GeometricDispersion effect;
  return effect;
}

}  // namespace kolsky
