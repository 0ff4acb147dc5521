#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kAtOnce = 8;

/// Of some samples in a row. A fit asks for them thousands of times: from one set to the next they
/// only turn, all alike, and none waits for another.
class Phases {
 public:
  Phases(double first, double step)
      : turn_cos_(std::cos(step * kAtOnce)), turn_sin_(std::sin(step * kAtOnce)) {
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      cos_[i] = std::cos(first + step * static_cast<double>(i));
      sin_[i] = std::sin(first + step * static_cast<double>(i));
    }
  }

  /// @param samples  at most kAtOnce
  void add(std::array<double, 2> parts, std::span<double> samples) const {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i] += parts[0] * cos_[i] + parts[1] * sin_[i];
    }
  }
  void turn() {
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      const double turned = cos_[i] * turn_cos_ - sin_[i] * turn_sin_;
      sin_[i] = cos_[i] * turn_sin_ + sin_[i] * turn_cos_;
      cos_[i] = turned;
    }
  }

 private:
  double turn_cos_;
  double turn_sin_;
  std::array<double, kAtOnce> cos_{};
  std::array<double, kAtOnce> sin_{};
};

class MainsHum final : public Effect {
 public:
  MainsHum()
      : Effect({
            .id = "mains-hum",
            .stage = Stage::record,
            .definition = "reading of each gauge += c cos(2 pi f t) + d sin(2 pi f t)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"c", "strain", 0.0, -1e-2, 1e-2, 1e-6, {}},
                           {"d", "strain", 0.0, -1e-2, 1e-2, 1e-6, {}},
                           {"f",
                            "Hz",
                            0.0,
                            45.0,
                            1000.0,
                            1.0,
                            {50.0, 60.0, 100.0, 120.0, 150.0, 180.0},
                            false,
                            2e-3,
                            true}},
            .each_gauge = true,
            .per_shot = true,
            .quadrature = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    const std::vector<double>& time_s = scene.facts->time_s;
    const double period_s = (time_s.back() - time_s.front()) /
                            static_cast<double>(std::max<std::size_t>(time_s.size(), 2) - 1);
    std::vector<double>& addition = scene.record.additions[gauge];
    addition.resize(time_s.size(), 0.0);
    const double w = 2.0 * std::numbers::pi * values[2];
    Phases phases(w * time_s.front(), w * period_s);
    for (std::size_t first = 0; first < addition.size(); first += kAtOnce) {
      phases.add({values[0], values[1]},
                 std::span(addition).subspan(first, std::min(kAtOnce, addition.size() - first)));
      phases.turn();
    }
  }
};

}  // namespace

const Effect& mains_hum_effect();
const Effect& mains_hum_effect() {
  static const MainsHum effect;
  return effect;
}

}  // namespace kolsky
