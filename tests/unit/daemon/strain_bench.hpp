#pragma once

namespace kolsky {

/// PMMA bars with a gauge each, in strain.
inline constexpr const char* kStrainBench = R"(kind = "shpb"
sampling_frequency_Hz = 1.0e6
[bars.input]
length_m = 0.7
diameter_m = 0.015
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[bars.output]
length_m = 0.7
diameter_m = 0.015
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.4
unit = "strain"
[[gauges]]
name = "g2"
bar = "output"
position_m = 0.05
unit = "strain"
[specimen]
length_m = 0.004
diameter_m = 0.012
)";

}  // namespace kolsky
