#include "processing/impact/impact_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/impact/mesh.hpp"

namespace kolsky::impact {
namespace {

constexpr std::array kTargetNames = {"rigid", "dashpot", "bar"};
constexpr double kFastest_m_per_s = 500.0;  // shells of the ball would be shocks long before
constexpr std::size_t kMostElements = 1'000'000;
constexpr double kHeaviestSabot_kg = 1.0;
constexpr double kMostNonlinear = 1e3;  // the step would shrink with its root, and on

void require(bool good, const std::string& place, const std::string& what,
             const std::string& mend) {
  if (!good) {
    throw InputError(place, what, mend);
  }
}

bool positive(double value) {
  return value > 0.0 && std::isfinite(value);
}

bool not_negative(double value) {
  return value >= 0.0 && std::isfinite(value);
}

void check_solid(const Solid& solid, const std::string& place) {
  bool passive = positive(solid.density_kg_m3) && positive(solid.shear_relaxed_Pa) &&
                 positive(solid.bulk_relaxed_Pa) && std::isfinite(solid.nonlinearity);
  for (const SolidArm& arm : solid.arms) {
    passive =
        passive && not_negative(arm.shear_Pa) && not_negative(arm.bulk_Pa) && positive(arm.time_s);
  }
  require(passive, place, "has a modulus, a density or a time that no passive solid has",
          "give positive numbers");
  require(std::abs(solid.nonlinearity) <= kMostNonlinear, place + ".nonlinearity",
          in_words(solid.nonlinearity, "") + " is no solid's", "give a number from -1000 to 1000");
}

void check_layers(const std::vector<Layer>& layers) {
  require(!layers.empty(), "layers", "are none", "give the ball a core");
  double inner_m = 0.0;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string place = "layers[" + std::to_string(i) + "]";
    require(positive(layers[i].outer_diameter_m) && layers[i].outer_diameter_m > inner_m,
            place + ".outer_diameter_m",
            in_words(layers[i].outer_diameter_m, "m") + " does not surround the layer inside it",
            "give diameters that grow outwards");
    check_solid(layers[i].solid, place + ".solid");
    inner_m = layers[i].outer_diameter_m;
  }
}

void check_target(const Target& target, double offset_m) {
  if (target.kind == TargetKind::rigid) {
    return;
  }
  require(positive(target.diameter_m) && positive(target.density_kg_m3) &&
              positive(target.youngs_modulus_Pa),
          "target", "lacks a diameter, a density or a modulus", "give positive numbers");
  require(target.poisson_ratio >= 0.0 && target.poisson_ratio < 0.5, "target.poisson_ratio",
          in_words(target.poisson_ratio, "") + " has no finite bulk modulus",
          "give a ratio from 0 to below 0.5");
  require(target.kind != TargetKind::bar || positive(target.length_m), "target.length_m",
          "is not a length", "give metres");
  require(offset_m < 0.5 * target.diameter_m, "offset_m",
          "puts the ball's axis " + in_words(offset_m, "m") + " from the bar's, past its edge",
          "give less than the bar's radius");
}

}  // namespace

TargetKind target_named(const std::string& name, const std::string& place) {
  const auto* const found = std::find(kTargetNames.begin(), kTargetNames.end(), name);
  require(found != kTargetNames.end(), place, "\"" + name + "\" is not a target",
          "give rigid, dashpot or bar");
  return static_cast<TargetKind>(found - kTargetNames.begin());
}

std::string name_of(TargetKind kind) {
  return kTargetNames.at(static_cast<std::size_t>(kind));
}

double Target::area_m2() const {
  return 0.25 * std::numbers::pi * diameter_m * diameter_m;
}

double Target::wave_speed_m_per_s() const {
  return std::sqrt(youngs_modulus_Pa / density_kg_m3);
}

double Target::impedance_kg_per_s() const {
  return density_kg_m3 * wave_speed_m_per_s() * area_m2();
}

void check(const ImpactModel& model) {
  check_layers(model.layers);
  require(positive(model.speed_m_per_s) && model.speed_m_per_s <= kFastest_m_per_s, "speed_m_per_s",
          in_words(model.speed_m_per_s, "m/s") + " is not an impact speed",
          "give m/s, above 0 and at most 500");
  require(not_negative(model.friction) && model.friction <= 10.0, "friction",
          in_words(model.friction, "") + " is not a coefficient of friction",
          "give a number from 0 to 10");
  require(not_negative(model.sabot_mass_kg) && model.sabot_mass_kg <= kHeaviestSabot_kg,
          "sabot_mass_kg", in_words(model.sabot_mass_kg, "kg") + " is no sabot's mass",
          "give kilograms, at most 1, 0 for none");
  require(not_negative(model.offset_m), "offset_m", "is not a distance", "give metres, 0 or more");
  check_target(model.target, model.offset_m);
  const std::size_t least = least_elements(model.layers.size());
  require(model.elements >= least && model.elements <= kMostElements, "elements",
          std::to_string(model.elements) + " cannot mesh a ball of " +
              std::to_string(model.layers.size()) + " layers",
          "give " + std::to_string(least) + " to " + std::to_string(kMostElements));
  require(model.bar_elements_across >= 2 && model.bar_elements_across <= 200, "bar_elements_across",
          "is out of range", "give 2 to 200");
  require(not_negative(model.time_step_s), "time_step_s", "is not a time",
          "give seconds, 0 for the largest safe one");
  require(positive(model.output_interval_s) && model.output_interval_s <= 1e-4, "output_interval_s",
          "is out of range", "give seconds, at most 1e-4");
  require(not_negative(model.duration_s) && model.duration_s <= 0.1, "duration_s",
          "is out of range", "give seconds, at most 0.1, 0 until the ball has left");
  const double radius_m = 0.5 * model.layers.back().outer_diameter_m;
  for (std::size_t i = 0; i < model.probes.size(); ++i) {
    const Probe& probe = model.probes[i];
    const std::string place = "probes[" + std::to_string(i) + "]";
    require(not_negative(probe.radial_m), place,
            in_words(probe.radial_m, "m") + " is no distance from the axis", "give one from 0 up");
    require(std::hypot(probe.radial_m, probe.axial_m) < radius_m, place,
            in_words(probe.radial_m, "m") + " from the axis and " + in_words(probe.axial_m, "m") +
                " from the centre is outside of the ball",
            "stay within " + in_words(radius_m, "m") + " of its centre");
  }
  for (const double time_s : model.field_times_s) {
    require(not_negative(time_s), "field_times_s", in_words(time_s, "s") + " is before the touch",
            "give seconds from the first touch on");
  }
  for (const double position_m : model.gauge_positions_m) {
    require(model.target.kind == TargetKind::bar && position_m > 0.0 &&
                position_m < model.target.length_m,
            "gauge_positions_m", in_words(position_m, "m") + " is not on a meshed bar",
            "give distances from the struck end, and target bar");
  }
}

}  // namespace kolsky::impact
