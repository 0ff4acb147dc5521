#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "processing/models/additions.hpp"
#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class MainsHum final : public Effect {
 public:
  MainsHum()
      : Effect({
            .id = "mains-hum",
            .stage = Stage::record,
            .definition = "reading of each gauge += c cos(2 pi f t) + d sin(2 pi f t)",
            .reference = "effects.md",
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
    const double w = 2.0 * std::numbers::pi * values[2];
    const std::vector<double>& time_s = scene.facts->time_s;
    // A fit asks for it thousands of times: from sample to sample the phase only turns.
    const double period_s = (time_s.back() - time_s.front()) /
                            static_cast<double>(std::max<std::size_t>(time_s.size(), 2) - 1);
    Complex phase = std::polar(1.0, w * time_s.front());
    const Complex turn = std::polar(1.0, w * period_s);
    add_to(scene.record.additions[gauge], time_s, [&](double) {
      const double reading = values[0] * phase.real() + values[1] * phase.imag();
      phase *= turn;
      return reading;
    });
  }
};

}  // namespace

const Effect& mains_hum_effect();
const Effect& mains_hum_effect() {
  static const MainsHum effect;
  return effect;
}

}  // namespace kolsky
