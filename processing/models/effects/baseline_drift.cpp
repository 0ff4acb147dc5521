#include "processing/models/additions.hpp"
#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class BaselineDrift final : public Effect {
 public:
  BaselineDrift()
      : Effect({
            .id = "baseline-drift",
            .stage = Stage::record,
            .definition = "reading += b1 (t - t_trigger)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"b1", "1/s", 0.0, -10.0, 10.0, 1e-2, {}}},
            .per_gauge = true,
            .per_shot = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    add_to(scene.record.additions[gauge], scene.facts->time_s,
           [&](double t) { return values[0] * t; });
  }
};

}  // namespace

const Effect& baseline_drift_effect();
const Effect& baseline_drift_effect() {
  static const BaselineDrift effect;
  return effect;
}

}  // namespace kolsky
