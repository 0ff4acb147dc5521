#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/models/record_map.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// The uniaxial compliance of a bar or a specimen as effects build it up:
///   J = 1/E1 + 1/(E2 (1 + (s eta2/E2)^beta)) + sum D/(1 + s tau) + phi/s + what expressions add
/// An elastic material has no Kelvin branch (`E2_Pa` infinite).
struct Solid {
  struct Relaxation {
    double D_per_Pa = 0.0;
    double tau_s = 0.0;
  };

  double E1_Pa = 0.0;
  double E2_Pa = 0.0;
  double eta2_Pa_s = 0.0;
  double beta = 1.0;
  std::vector<Relaxation> relaxations{};
  double phi_per_Pa_s = 0.0;
  std::vector<Complex> further_per_Pa{};  ///< on the scene's path; empty for none

  /// J at the path's place k.
  [[nodiscard]] Complex compliance(Complex s, std::size_t k) const;
};

/// A bar, and what is known of waves in it at every place of the scene's path.
struct BarScene {
  double length_m = 0.0;
  double radius_m = 0.0;  ///< for dispersion
  double area_m2 = 0.0;
  double density_kg_m3 = 0.0;
  double poisson_ratio = 0.0;
  bool elastic = false;  ///< its modulus is filed, not a model's
  Solid solid{};
  /// Stress reflection of its far end; 0: no wave comes back.
  double far_reflection = 0.0;
  std::vector<Complex> further_reflection{};  ///< what expressions add to it; empty for none

  [[nodiscard]] bool reflects() const {
    return far_reflection != 0.0 || !further_reflection.empty();
  }
  /// At the path's place k.
  [[nodiscard]] Complex reflection(std::size_t k) const {
    return further_reflection.empty() ? far_reflection : far_reflection + further_reflection[k];
  }

  std::vector<Complex> J_per_Pa{};
  std::vector<Complex> gamma_per_m{};
  std::vector<Complex> surface_over_mean{};  ///< axial strain
};

struct GaugeScene {
  std::string name{};
  std::size_t bar = 0;  ///< 0 input, 1 output
  double position_m = 0.0;
  double length_m = 0.0;             ///< over which it takes the mean; 0: a point
  std::vector<Complex> factor{};     ///< reading over that mean, on the path
  double offset_m = 0.0;             ///< chi of bending (`kolsky effects`)
  bool bends_as_deflection = false;  ///< its strain follows w'', not the rotation's slope
  std::vector<std::pair<std::size_t, double>> picks_up{};  ///< crosstalk: gauge and its share
};

/// What becomes of a gap once it has closed.
enum class GapAfter {
  closed_for_good,
  opens_where_it_was,  ///< the bars are as far apart as before
  pulls_nothing,       ///< dry faces: open wherever the specimen would have to be pulled
};

/// The specimen between the bars.
struct SpecimenScene {
  double length_m = 0.0;
  double diameter_m = 0.0;
  double density_kg_m3 = 0.0;
  double poisson_ratio = 0.0;
  Solid solid{};
  double wave_density_kg_m3 = 0.0;        ///< density that waves in it see; 0: equilibrium
  double lateral_inertia_kg_per_m = 0.0;  ///< m of stress += m (strain''/8 + strain'^2/16)
  bool crossed_sideways = false;          ///< waves cross its section; m is their first term
  double punching = 0.0;                  ///< strength of the bar ends' indentation
  double stiffening = 0.0;                ///< E1 (1 + b strain)
  double friction = 0.0;                  ///< mu of Coulomb friction at its faces
  double gap_m = 0.0;                     ///< closes before it is loaded
  GapAfter gap_after = GapAfter::closed_for_good;
  bool parts = false;  ///< faces push and never pull, gap or none
  /// A strain history beside all this, by step of the specimen's histories; empty for none.
  std::vector<double> further_strain{};

  [[nodiscard]] double area_m2() const;
  /// What the material has of the stress measured, at a strain: 1 / (1 + mu d / 3h), with current
  /// sizes at constant volume.
  [[nodiscard]] double share_of_stress(double strain) const;
  /// Whether its answer depends on how hard it is loaded.
  [[nodiscard]] bool nonlinear() const;
};

/// One of the two layers of a ball.
struct BallLayer {
  Solid solid{};  ///< uniaxial
  double density_kg_m3 = 0.0;
  double poisson_ratio = 0.0;
  double nonlinearity = 0.0;  ///< b: instantaneous deviatoric stress x (1 + b strain)
};

/// The ball that strikes an elastic bar.
struct BallScene {
  double core_diameter_m = 0.0;
  double outer_diameter_m = 0.0;
  double heavier = 0.0;  ///< relative: densities of both layers x (1 + heavier)
  BallLayer core{};
  BallLayer cover{};
  double friction = 0.0;
  double offset_m = 0.0;
  double sabot_mass_kg = 0.0;
  double cauchy_share = 0.0;  ///< 0: Kirchhoff stress from Hencky's strain, 1: Cauchy stress
  int reading = 0;            ///< of the uniaxial law, as three-dimensional-reading numbers them
};

/// What is known of one shot besides its records.
struct ShotFacts {
  std::size_t shot = 0;
  double peak_strain = 0.0;                        ///< largest at the first gauge
  std::optional<double> warmer_by_K{};             ///< than the campaign's reference, where logged
  std::vector<double> time_s{};                    ///< of its samples, from the pulse's foot
  std::optional<double> incident_speed_m_per_s{};  ///< of a ball
  double incident_speed_sd_m_per_s = 0.0;          ///< 0: not known
  std::optional<double> rebound_speed_m_per_s{};
  double rebound_speed_sd_m_per_s = 0.0;
};

/// Memoryless maps, gains and additions between strain and what was recorded.
struct RecordScene {
  double bridge_b = 0.0;  ///< reading = e (1 + b e + c e^2), c to first order
  double bridge_c = 0.0;
  std::vector<std::vector<double>> additions{};  ///< by gauge, one per sample; empty for none
  std::vector<std::vector<RecordMap>> maps{};  ///< by gauge, in the order they act; may be shorter

  std::vector<std::vector<double>> gains{};  ///< the same, on what the maps make; may be shorter

  [[nodiscard]] bool bends(std::size_t gauge) const {
    return bridge_b != 0.0 || bridge_c != 0.0 || (gauge < maps.size() && !maps[gauge].empty()) ||
           (gauge < gains.size() && !gains[gauge].empty());
  }
  /// Takes a gauge's gain off its record, the maps, the last first, and the bridge's: what strain
  /// was sensed, in place.
  void straighten(std::size_t gauge, std::vector<double>& record) const;
};

/// One shot's bench and physics on a path of the Laplace variable, as effects shape it stage by
/// stage.
struct Scene {
  std::vector<Complex> s{};  ///< by the clock that the bench has, not the one filed
  const ShotFacts* facts = nullptr;
  std::vector<BarScene> bars{};
  std::vector<GaugeScene> gauges{};
  std::optional<SpecimenScene> specimen{};
  std::optional<BallScene> ball{};
  RecordScene record{};

  /// The bench as filed; right-going waves in a bar, free far ends around a specimen.
  Scene(const Bench& bench, const ShotFacts& shot, std::span<const Complex> path);
};

}  // namespace kolsky
