#pragma once

#include "processing/impact/bench_impact.hpp"

namespace kolsky::testing {

/// The paper's Table 3.
inline Material paper_core() {
  return three_element_material({1140.0}, {0.376}, {121e6}, {143e6}, {2860.0}, "");
}
inline Material paper_cover() {
  return three_element_material({960.0}, {0.319}, {987e6}, {452e6}, {6020.0}, "");
}

/// The paper's bench: 35.65 mm of core in 42.7 mm weigh 43.4 g.
inline Bench paper_bench() {
  Bench bench;
  bench.kind = BenchKind::impact;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {3.0};
  bench.input.diameter_m = {0.027};
  bench.input.density_kg_m3 = {4420.0};
  bench.input.poisson_ratio = {0.33};
  bench.input.youngs_modulus_Pa = Measured{113e9};
  bench.ball = Ball{{0.0427}, {0.03565}, Measured{0.0434}, false};
  return bench;
}

inline impact::ImpactModel paper_impact(double speed_m_per_s,
                                        impact::TargetKind target = impact::TargetKind::dashpot,
                                        impact::Reading reading = impact::Reading::full) {
  return impact::impact_on(paper_bench(), {paper_core(), reading}, {paper_cover(), reading}, target,
                           speed_m_per_s);
}

}  // namespace kolsky::testing
