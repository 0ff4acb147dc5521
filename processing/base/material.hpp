#pragma once

#include <array>
#include <optional>
#include <string>

#include "processing/base/measured.hpp"

namespace kolsky {

/// A three-element solid, J = 1/E1 + 1/(E2 + i w eta2): a spring in series with a spring and a
/// dashpot in parallel (paper, eq. A3).
struct Material {
  Measured density_kg_m3;
  Measured poisson_ratio;
  Measured E1_Pa;
  Measured E2_Pa;
  Measured eta2_Pa_s;
  std::string source;  ///< where the numbers come from, for people
  /// Of E1, E2 and eta2, row by row, in their units; none: their own deviations, independent.
  std::optional<std::array<double, 9>> covariance{};

  /// Where an identification from waves holds.
  struct Identified {
    std::optional<double> band_limit_Hz{};  ///< up to which the records were used
    std::optional<double> temperature_K{};  ///< of the bars
    // Of the identification itself: for who takes it from its file, not carried with shots.
    std::optional<double> chi2_reduced{};  ///< what the fit left, per degree of freedom
    bool passive = true;                   ///< false: waves grew on their way
    friend bool operator==(const Identified&, const Identified&) = default;
  };
  /// None: nobody has identified it from waves.
  std::optional<Identified> identified{};
};

/// PMMA of the paper's Table 4, row 1.
[[nodiscard]] Material paper_pmma();
/// The golf ball's polybutadiene core and ionomer cover, Table 3.
[[nodiscard]] Material paper_golf_core();
[[nodiscard]] Material paper_golf_cover();

/// Ranges, as for a bench. @throws InputError whose place is the key, as "E1_Pa"
void check(const Material& material);

}  // namespace kolsky
