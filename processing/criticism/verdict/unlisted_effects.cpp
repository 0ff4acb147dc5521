#include "processing/criticism/verdict/unlisted_effects.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <vector>

#include "processing/models/scene.hpp"

namespace kolsky {

namespace {

/// Between the times of amplifiers, which the library has, and a share that is as good as constant.
constexpr double kQuickest_s = 30e-6;
constexpr double kSlowest_s = 50e-3;
/// Of 3000 microstrain nearly a fifth.
constexpr double kMostCurved = 2e4;

class CreepingGauge final : public Effect {
 public:
  CreepingGauge()
      : Effect({
            .id = "creeping-gauge",
            .stage = Stage::sensor,
            .definition = "reading x (1 + c / (1 + s tau))",
            .reference = "docs/methods/diagnosis.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{.name = "c", .unit = "-", .lower = -1.0, .upper = 1.0, .typical = 0.01},
                           {.name = "tau",
                            .unit = "s",
                            .lower = kQuickest_s,
                            .upper = kSlowest_s,
                            .typical = 1e-4,
                            .starts = {100e-6, 5e-3}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      scene.gauges[gauge].factor[k] *= 1.0 + values[0] / (1.0 + scene.s[k] * values[1]);
    }
  }
};

enum class Curved { one_gauge, all_gauges };

class CurvedReading final : public Effect {
 public:
  CurvedReading(const char* id, Curved curved)
      : Effect({
            .id = id,
            .stage = Stage::record,
            .definition = "reading = e (1 + c e^2)",
            .reference = "docs/methods/diagnosis.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{.name = "c",
                            .unit = "-",
                            .lower = -kMostCurved,
                            .upper = kMostCurved,
                            .typical = 100.0}},
            .per_gauge = curved == Curved::one_gauge,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    const double c = values[0];
    const RecordMap curve = [c](std::span<const std::complex<double>> strain,
                                std::span<std::complex<double>> reading) {
      std::ranges::transform(strain, reading.begin(),
                             [c](const auto& e) { return e * (1.0 + c * e * e); });
    };
    scene.record.maps.resize(scene.gauges.size());
    for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
      if (c != 0.0 && (!about().per_gauge || j == gauge)) {
        scene.record.maps[j].push_back(curve);
      }
    }
  }
};

/// A share of what it reads, from a time on.
class ChangingGauge final : public Effect {
 public:
  ChangingGauge()
      : Effect({
            .id = "changing-gauge",
            .stage = Stage::record,
            .definition = "reading x (1 + c / (1 + exp(-(t - t0) / w)))",
            .reference = "docs/methods/diagnosis.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{.name = "c", .unit = "-", .lower = -0.9, .upper = 9.0, .typical = 0.01},
                           {.name = "t0",
                            .unit = "s",
                            .lower = 0.0,
                            .upper = 5e-3,
                            .typical = 1e-5,
                            .starts = {50e-6, 100e-6, 200e-6, 400e-6, 800e-6}},
                           {.name = "w",
                            .unit = "s",
                            .lower = 1e-6,
                            .upper = 10e-6,
                            .typical = 5e-6,
                            .starts = {5e-6}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    if (values[0] == 0.0) {
      return;
    }
    scene.record.gains.resize(scene.gauges.size());
    std::vector<double>& gain = scene.record.gains[gauge];
    gain.clear();
    for (const double t : scene.facts->time_s) {
      gain.push_back(1.0 + values[0] / (1.0 + std::exp(-(t - values[1]) / values[2])));
    }
  }
};

}  // namespace

const Effect& creeping_gauge() {
  static const CreepingGauge effect;
  return effect;
}

const Effect& curved_gauge() {
  static const CurvedReading effect("curved-gauge", Curved::one_gauge);
  return effect;
}

const Effect& curved_readings() {
  static const CurvedReading effect("curved-readings", Curved::all_gauges);
  return effect;
}

const Effect& changing_gauge() {
  static const ChangingGauge effect;
  return effect;
}

}  // namespace kolsky
