#pragma once

#include <random>
#include <tuple>

#include "tests/generators/campaign_draw.hpp"

namespace kolsky::testing {

/// The paper's split bar with three gauges and one shot, struck by a pulse of about that stress.
inline ShpbWorld paper_split_bar(double source_Pa) {
  ShpbWorld world;
  world.base.radius_m = 0.0075;
  world.base.length_m = 0.7;
  world.base.timing.samples = 1200;
  for (const auto& [name, bar, x] :
       {std::tuple{"g1", "input", 0.4}, {"g2", "output", 0.05}, {"g3", "input", 0.25}}) {
    TrueGauge gauge;
    gauge.name = name;
    gauge.bar = bar;
    gauge.position_m = x;
    world.base.gauges.push_back(gauge);
  }
  std::mt19937_64 random(3);
  TrueShot shot;
  shot.source = draw_pulse(random, 450e-6, world.base.timing.knot_s(), 400);
  for (double& bell : shot.source) {
    bell *= source_Pa;
  }
  world.base.shots = {shot};
  return world;
}

}  // namespace kolsky::testing
