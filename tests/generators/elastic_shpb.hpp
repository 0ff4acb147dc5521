#pragma once

#include <optional>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky::testing {

/// A split Hopkinson bar of two elastic bars and a massless linear spring, solved in the time
/// domain by d'Alembert: waves are delayed copies, the spring is a first-order equation stepped
/// finely. It has no transform in it and shares nothing with the reduction.
struct ElasticShpb {
  double length_in_m = 1.0;
  double length_out_m = 1.0;
  double diameter_m = 0.020;
  double youngs_modulus_Pa = 206e9;
  double density_kg_m3 = 7850.0;
  double gauge_to_A_m = 0.5;
  double gauge_to_B_m = 0.3;
  std::optional<double> second_to_A_m{};  ///< another gauge on the input bar, filed last
  double specimen_length_m = 0.004;
  double specimen_diameter_m = 0.008;
  double specimen_modulus_Pa = 2e9;
  double pulse_s = 100e-6;
  double rise_s = 20e-6;
  double pulse_strain = 1e-3;
  double foot_at_gauge_s = 300e-6;
  double duration_s = 1.5e-3;
  double sampling_frequency_Hz = 1e6;

  struct Truth {
    double arrival_s = 0.0;  ///< at interface A, from the record's start
    double step_s = 0.0;
    std::vector<double> strain, strain_rate_per_s, force_N;  ///< from the arrival on
    [[nodiscard]] double at(const std::vector<double>& history, double time_s) const;
  };
  struct Records {
    std::vector<double> input_strain, output_strain;
    std::vector<double> second_strain;  ///< empty where there is none
    Truth truth;
  };
  [[nodiscard]] Records solve() const;

  [[nodiscard]] Bench bench() const;
  /// Codes of `bits` over +-`range_strain`, Gaussian noise of that rms, seeded.
  [[nodiscard]] Shot shot(const Records& records, double noise_rms, int bits, double range_strain,
                          unsigned seed) const;
};

/// A shot from strain records: one channel per record.
[[nodiscard]] Shot digitise(const Bench& bench, const std::vector<std::vector<double>>& strains,
                            double noise_rms, int bits, double range_strain, unsigned seed);

}  // namespace kolsky::testing
