#pragma once

#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/impact/impact_model.hpp"

namespace kolsky::impact {

/// A material of the ball as the comparison varies it: the filed three-element solid, how it is
/// read in three dimensions, and what it may have beyond.
struct BallMaterial {
  Material material;
  Reading reading = Reading::full;
  double nonlinearity = 0.0;  ///< b of core-, cover-nonlinearity
  KelvinUnit second{};        ///< D and tau of core-, cover-second-relaxation
  FiniteStrain law = FiniteStrain::kirchhoff;
};

/// @throws InputError as solid_of does
[[nodiscard]] Solid solid_of(const BallMaterial& material);

/// Of a ball of such layers, by its spheres exactly.
[[nodiscard]] double mass_kg(const std::vector<Layer>& layers);

/// The filed mass of a ball against what its geometry and densities give.
struct MassCheck {
  double geometry_kg = 0.0;
  double filed_kg = 0.0;  ///< the same where no mass is filed
  double density_scale =
      1.0;  ///< what both densities are multiplied by; 1 unless the bench asks for it
  [[nodiscard]] double difference() const { return filed_kg / geometry_kg - 1.0; }
  [[nodiscard]] bool differs() const;  ///< by more than a thousandth and three filed deviations
  double filed_sd_kg = 0.0;
};

/// @throws InputError "ball.mass_kg" if the filed mass differs and the bench does not say
/// scale_density
[[nodiscard]] MassCheck check_mass(const Ball& ball, const Material& core, const Material& cover);

/// The impact that a bench describes, at a speed; everything else of the model as it comes.
/// @throws InputError, place as in the bench file: not an impact bench, no modulus for the target,
/// a
///   mass that does not fit
[[nodiscard]] ImpactModel impact_on(const Bench& bench, const BallMaterial& core,
                                    const BallMaterial& cover, TargetKind target,
                                    double speed_m_per_s);

/// Young's modulus of the solid at once, and relaxed: what a reading does to the uniaxial law.
[[nodiscard]] double instantaneous_modulus_Pa(const Solid& solid);
[[nodiscard]] double relaxed_modulus_Pa(const Solid& solid);

}  // namespace kolsky::impact
