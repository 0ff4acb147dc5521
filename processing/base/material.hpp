#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/measured.hpp"
#include "processing/base/solid_kind.hpp"

namespace kolsky {

/// What waves travel in: a linear solid of one family (three elements: a spring in series with a
/// spring and a dashpot in parallel, paper, eq. A3), its density and Poisson's ratio.
struct Material {
  Measured density_kg_m3;
  Measured poisson_ratio;
  SolidKind solid = SolidKind::three_element;
  /// Of the solid, in the order of `parameters_of(solid)`.
  std::vector<Measured> parameters = std::vector<Measured>(3);
  std::string source;  ///< where the numbers come from, for people
  /// Of the parameters, row by row, in their units; none: their own deviations, independent.
  std::optional<std::vector<double>> covariance{};

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

  /// What a wave's front sees, whatever the family.
  [[nodiscard]] Measured& E1_Pa() { return parameters.front(); }
  [[nodiscard]] const Measured& E1_Pa() const { return parameters.front(); }
  /// Of three elements, where nothing else is meant. @throws InputError of any other family
  [[nodiscard]] Measured& E2_Pa();
  [[nodiscard]] const Measured& E2_Pa() const;
  [[nodiscard]] Measured& eta2_Pa_s();
  [[nodiscard]] const Measured& eta2_Pa_s() const;
};

/// Three elements.
[[nodiscard]] Material three_element_material(const Measured& density_kg_m3,
                                              const Measured& poisson_ratio, const Measured& E1_Pa,
                                              const Measured& E2_Pa, const Measured& eta2_Pa_s,
                                              const std::string& source);

/// The stiffest spring [Pa] and dashpot [Pa s] that a material has; a branch of both is none.
inline constexpr double kStiffest = 1e15;

/// PMMA of the paper's Table 4, row 1.
[[nodiscard]] Material paper_pmma();
/// The golf ball's polybutadiene core and ionomer cover, Table 3.
[[nodiscard]] Material paper_golf_core();
[[nodiscard]] Material paper_golf_cover();

/// The values of the solid's parameters, in its order.
[[nodiscard]] std::vector<double> values_of(const std::vector<Measured>& numbers);

/// 1 / sum 1/E over the springs [Pa]: once all branches have crept; of a fluid without its flow.
[[nodiscard]] double relaxed_modulus_Pa(const Material& material);

/// Ranges, as for a bench; of a fractional branch beta at most 1, as of any solid that creeps.
/// @throws InputError whose place is the key, as "E1_Pa"
void check(const Material& material);

}  // namespace kolsky
