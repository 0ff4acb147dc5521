#include "processing/criticism/verdict/distortion.hpp"

#include <array>
#include <cmath>

#include "processing/models/scene.hpp"

namespace kolsky {

namespace {

constexpr std::array kRelaxations_s{1e-5, 5e-5, 3e-4};
constexpr std::array kEchoes_s{6e-5, 1.2e-4, 2.4e-4, 4.8e-4};
constexpr std::size_t kPowers = 4;

std::vector<EffectParameter> strengths() {
  std::vector<EffectParameter> list;
  const std::size_t count = kPowers + kRelaxations_s.size() + kEchoes_s.size();
  for (std::size_t i = 0; i < count; ++i) {
    list.push_back({"c" + std::to_string(i), "-", 0.0, -1.0, 1.0, 1e-3, {}});
  }
  list.push_back({"by_peak", "-", 0.0, -1e3, 1e3, 1.0, {}});
  return list;
}

class Distortion final : public Effect {
 public:
  Distortion()
      : Effect({
            .id = "distortion",
            .stage = Stage::sensor,
            .definition = "reading x (1 + sum of powers, relaxations and echoes)",
            .reference = "",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = strengths(),
            .per_gauge = true,
            .shot_facts = true,
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      const Complex s = scene.s[k];
      Complex sum = 0.0;
      Complex power = 1.0;
      std::size_t i = 0;
      for (; i < kPowers; ++i) {
        sum += values[i] * power;
        power *= s / kRateUnit_rad_per_s;
      }
      for (const double tau : kRelaxations_s) {
        sum += values[i++] / (1.0 + s * tau);
      }
      for (const double late : kEchoes_s) {
        sum += values[i++] * std::exp(-s * late);
      }
      sum += values[i] * scene.facts->peak_strain;
      scene.gauges[gauge].factor[k] *= 1.0 + sum;
    }
  }
};

class BentScale final : public Effect {
 public:
  BentScale()
      : Effect({
            .id = "bent-scale",
            .stage = Stage::record,
            .definition = "reading = e (1 + b e + c e^2)",
            .reference = "",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"b", "-", 0.0, -50.0, 50.0, 0.5, {}},
                           {"c", "-", 0.0, -1e5, 1e5, 1e3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.record.bridge_b += values[0];
    scene.record.bridge_c += values[1];
  }
};

}  // namespace

const Effect& bent_scale_effect() {
  static const BentScale effect;
  return effect;
}

const Effect& distortion_effect() {
  static const Distortion effect;
  return effect;
}

}  // namespace kolsky
