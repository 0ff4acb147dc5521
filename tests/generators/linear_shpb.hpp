#pragma once

#include <optional>

#include "drivers/simulated/bench_model.hpp"
#include "processing/base/shot.hpp"
#include "tests/generators/kelvin_chain.hpp"

namespace kolsky::testing {

/// A split Hopkinson bar of viscoelastic or elastic rods with a linear specimen that stays in touch
/// with both, solved in the time domain on staggered grids: no transform in it, and nothing shared
/// with the analysis. The defaults are the paper's bench with its core.
struct LinearShpb {
  RodMaterial input{1180.0, 5.66e9, 37.0e9, 1.81e6};
  RodMaterial output = input;
  RodMaterial specimen{1140.0, 121e6, 143e6, 2860.0};
  bool massless = true;  ///< else the specimen is a rod of its own
  /// What a massless specimen is of, instead of the moduli above.
  std::optional<KelvinChain> chain;
  double input_length_m = 0.7;
  double output_length_m = 0.7;
  double bar_diameter_m = 0.015;
  double output_diameter_m = 0.015;
  double specimen_length_m = 0.004;
  double specimen_diameter_m = 0.012;
  double gauge_in_m = 0.4;
  double gauge_out_m = 0.05;
  double pulse_s = 170e-6;
  double ramp_s = 40e-6;
  double peak_strain = 1e-3;
  double pre_s = 300e-6;  ///< quiet, before the impact
  double record_s = 2e-3;
  double sampling_frequency_Hz = 1e6;
  int steps_per_sample = 8;
  /// True values of what the bench file states otherwise, as factors.
  double gain_in = 1.0;
  double gain_out = 1.0;

  [[nodiscard]] Bench bench() const;
  /// Strain at both gauges, noiseless.
  [[nodiscard]] std::vector<std::vector<double>> solve() const;
};

}  // namespace kolsky::testing
