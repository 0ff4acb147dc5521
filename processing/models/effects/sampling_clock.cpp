#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

/// Where a deviation of it is filed.
class SamplingClock final : public Effect {
 public:
  SamplingClock()
      : Effect({
            .id = "sampling-clock",
            .stage = Stage::bench,
            .definition = "true sampling frequency = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"delta", "-", 0.0, -0.1, 0.1, 1e-4, {}}},
            .told_only = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    // A second of the records is 1 / (1 + delta) of a second.
    for (Complex& s : scene.s) {
      s *= 1.0 + values[0];
    }
  }
};

}  // namespace

const Effect& sampling_clock_effect();
const Effect& sampling_clock_effect() {
  static const SamplingClock effect;
  return effect;
}

}  // namespace kolsky
