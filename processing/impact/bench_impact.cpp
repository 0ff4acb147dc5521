#include "processing/impact/bench_impact.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky::impact {
namespace {

constexpr double kMassTolerance = 1e-3;

double youngs_modulus(double shear_Pa, double bulk_Pa) {
  return 9.0 * bulk_Pa * shear_Pa / (3.0 * bulk_Pa + shear_Pa);
}

Solid located_solid(const BallMaterial& material, const std::string& part) {
  try {
    return solid_of(material);
  } catch (const InputError& error) {
    throw error.inside(part);
  }
}

Target target_of(const Bench& bench, TargetKind kind) {
  Target target;
  target.kind = kind;
  if (kind == TargetKind::rigid) {
    return target;
  }
  if (!bench.input.youngs_modulus_Pa) {
    throw InputError("bars.input.youngs_modulus_Pa", "is missing: the ball strikes an elastic bar",
                     "give the bar's modulus, or --target rigid");
  }
  if (bench.input.poisson_ratio.value >= 0.5) {
    throw InputError("bars.input.poisson_ratio",
                     in_words(bench.input.poisson_ratio, "") + " has no finite bulk modulus",
                     "give a ratio below 0.5, or --target rigid");
  }
  target.diameter_m = bench.input.diameter_m;
  target.length_m = bench.input.length_m;
  target.density_kg_m3 = bench.input.density_kg_m3;
  target.youngs_modulus_Pa = *bench.input.youngs_modulus_Pa;
  target.poisson_ratio = bench.input.poisson_ratio;
  return target;
}

}  // namespace

Solid solid_of(const BallMaterial& material) {
  Solid solid = solid_of(material.material.density_kg_m3, material.material.poisson_ratio,
                         creep_of(material.material, material.second), material.reading);
  solid.nonlinearity = material.nonlinearity;
  solid.law = material.law;
  return solid;
}

double mass_kg(const std::vector<Layer>& layers) {
  double inside_m3 = 0.0;
  double sum_kg = 0.0;
  for (const Layer& layer : layers) {
    const double whole_m3 = std::numbers::pi / 6.0 * std::pow(layer.outer_diameter_m, 3);
    sum_kg += layer.solid.density_kg_m3 * (whole_m3 - inside_m3);
    inside_m3 = whole_m3;
  }
  return sum_kg;
}

bool MassCheck::differs() const {
  return std::abs(filed_kg - geometry_kg) >
         std::max(kMassTolerance * geometry_kg, 3.0 * filed_sd_kg);
}

MassCheck check_mass(const Ball& ball, const Material& core, const Material& cover) {
  std::vector<Layer> layers{{ball.core_diameter_m, {}}, {ball.outer_diameter_m, {}}};
  layers[0].solid.density_kg_m3 = core.density_kg_m3;
  layers[1].solid.density_kg_m3 = cover.density_kg_m3;
  MassCheck mass;
  mass.geometry_kg = mass_kg(layers);
  mass.filed_kg = ball.mass_kg ? ball.mass_kg->value : mass.geometry_kg;
  mass.filed_sd_kg = ball.mass_kg ? ball.mass_kg->sd : 0.0;
  if (!mass.differs()) {
    return mass;
  }
  if (!ball.scale_density) {
    throw InputError("ball.mass_kg",
                     in_words(1e3 * mass.filed_kg, "g") +
                         " is not what geometry and densities give, " +
                         in_words(1e3 * mass.geometry_kg, "g"),
                     "mend a diameter or a density, or give scale_density = true");
  }
  mass.density_scale = mass.filed_kg / mass.geometry_kg;
  return mass;
}

ImpactModel impact_on(const Bench& bench, const BallMaterial& core, const BallMaterial& cover,
                      TargetKind target, double speed_m_per_s) {
  if (!bench.ball) {
    throw InputError("kind", "is not \"impact\"", "give a bench with a [ball]");
  }
  const double scale = check_mass(*bench.ball, core.material, cover.material).density_scale;
  ImpactModel model;
  model.layers = {{bench.ball->core_diameter_m, located_solid(core, "core")},
                  {bench.ball->outer_diameter_m, located_solid(cover, "cover")}};
  for (Layer& layer : model.layers) {
    layer.solid.density_kg_m3 *= scale;
  }
  model.target = target_of(bench, target);
  model.speed_m_per_s = speed_m_per_s;
  return model;
}

double instantaneous_modulus_Pa(const Solid& solid) {
  return youngs_modulus(solid.shear_instantaneous_Pa(), solid.bulk_instantaneous_Pa());
}

double relaxed_modulus_Pa(const Solid& solid) {
  return youngs_modulus(solid.shear_relaxed_Pa, solid.bulk_relaxed_Pa);
}

}  // namespace kolsky::impact
