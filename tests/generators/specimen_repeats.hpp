#pragma once

#include <array>

#include "processing/specimen/specimen_fit.hpp"
#include "tests/generators/linear_shpb.hpp"
#include "tests/generators/noise.hpp"

namespace kolsky::testing {

/// Repeats of one experiment: the shots are always of the same specimen, noise is drawn anew, and
/// what the bench file and the bars' model state is off from the truth by their own deviations.
class SpecimenRepeats {
 public:
  struct Filed {
    double gain_sd = 0.01;  ///< relative
    double position_m_sd = 0.2e-3;
    double specimen_length_sd = 2e-3;                    ///< relative
    std::array<double, 3> bars_sd = {5e-5, 1e-3, 1e-3};  ///< E1, E2, eta2, relative
  };

  SpecimenRepeats(const LinearShpb& model, const Filed& filed, std::size_t shots, double noise_rms,
                  NoiseColour colour = NoiseColour::white);

  /// Fits the repeat of this number.
  [[nodiscard]] SpecimenFit fit(unsigned repeat, const SpecimenFitOptions& options) const;

  /// (fitted - true) / stated deviation, for E1, E2 and eta2.
  [[nodiscard]] std::array<double, 3> deviations(const SpecimenFit& fit) const;

 private:
  [[nodiscard]] Shot shot_of(const Bench& bench, unsigned seed) const;

  LinearShpb model_;
  Filed filed_;
  std::size_t shots_;
  double noise_rms_;
  NoiseColour colour_;
  std::vector<std::vector<double>> records_;
};

}  // namespace kolsky::testing
