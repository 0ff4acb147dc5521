#include "processing/calibration/part_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/identification/known_unknowns.hpp"
#include "processing/models/material_effects.hpp"

namespace kolsky {

namespace {

constexpr double kGainStep = 0.01;
constexpr double kPlaceStep_m = 1e-3;
constexpr double kDelayStep_s = 2e-7;
constexpr double kModulusStep = 0.01;
/// What is filed as exact is held to this share of a step that matters.
constexpr double kExactly = 1e-4;
/// Stiffness of a specimen that is not there, Pa.
constexpr double kRigid_Pa = 1e16;

ModelNumber of_gauge(CalibratedNumber::Of of, const std::string& effect, const Gauge& gauge,
                     const Measured& filed, double step) {
  ModelNumber number;
  number.of = of;
  number.id = number.effect = effect + ":" + gauge.name;
  number.gauge = gauge.name;
  number.filed = filed;
  number.step = step;
  number.least_sd = kExactly * step;
  return number;
}

/// Of two passes at one gauge, whose second is filed as a gauge on a bar without an end.
ModelNumber way_to_end(const Bench& bench) {
  const Gauge& first = bench.gauges[0];
  const Gauge& second = bench.gauges[1];
  const Measured way{0.5 * (second.position_m - first.position_m), 0.5 * second.position_m.sd};
  ModelNumber number =
      of_gauge(CalibratedNumber::Of::way_to_end, "gauge-position", second, way, 2.0 * kPlaceStep_m);
  number.gauge = first.name;
  number.id = "way-to-end:" + first.name;
  number.per_value = 0.5;
  return number;
}

/// Where both bars are viscoelastic they are of one material as filed, but each ages by itself.
constexpr const char* kBars = "three-element-bar";
constexpr const char* kOutputBar = "output-three-element-bar";

ModelNumber of_material(CalibratedNumber::Of of, std::size_t parameter, const std::string& effect,
                        const std::string& id, const Measured& filed, bool believed) {
  ModelNumber number;
  number.of = of;
  number.id = id;
  number.effect = effect;
  number.bar = effect == kOutputBar ? "output" : "";
  number.parameter = parameter;
  number.filed = filed;
  number.origin = filed.value;
  number.believed = believed;
  number.step = kModulusStep * filed.value;
  number.least_sd = kExactly * number.step;
  return number;
}

/// Bars of which nothing is filed are of one material: one gauge on each would not tell two apart.
bool each_bar_has_moduli(const Bench& bench, const CalibrationOptions& options) {
  return options.bars && bench.output && !bench.input.youngs_modulus_Pa &&
         !bench.output->youngs_modulus_Pa;
}

const Material& material_of(const CalibrationPart& part, const CalibrationOptions& options) {
  return options.bars ? options.bars->material : part.bars.material;
}

/// Of its three elements; what the material has more is held.
void add_moduli(const std::string& effect, const std::string& prefix, const Material& material,
                bool believed, std::vector<ModelNumber>& list) {
  constexpr std::array kOf{CalibratedNumber::Of::E1, CalibratedNumber::Of::E2,
                           CalibratedNumber::Of::eta2};
  const auto places = three_element_places(material.solid);
  const Material three = three_elements_of(material);
  for (std::size_t i = 0; i < places.size(); ++i) {
    list.push_back(of_material(kOf.at(i), i, effect,
                               prefix + parameters_of(material.solid)[places.at(i)].name,
                               three.parameters[i], believed));
  }
}

ModelNumber of_elastic_bars(CalibratedNumber::Of of, const std::string& id,
                            const std::string& effect, const std::string& bar,
                            const Measured& filed) {
  ModelNumber number;
  number.of = of;
  number.id = id;
  number.effect = effect;
  number.bar = bar;
  number.filed = filed;
  number.relative = true;
  number.step = kModulusStep;
  number.least_sd = kExactly * kModulusStep;
  return number;
}

/// Bars that are filed alike may be of one stock, off together, and each may be off by itself.
bool filed_alike(const Bench& bench) {
  constexpr double kAlike = 1e-6;
  return std::abs(*bench.input.youngs_modulus_Pa / *bench.output->youngs_modulus_Pa - 1.0) < kAlike;
}

/// What makes waves of one bar faster also passes and returns them otherwise at the joint, and
/// modulus and density do that in opposite senses: each bar's own are told apart from a gauge that
/// is filed elsewhere, and from a diameter, which the joint alone shows.
void add_elastic_bars(const Bench& bench, std::vector<ModelNumber>& list) {
  using Of = CalibratedNumber::Of;
  constexpr const char* kBoth = "bar-modulus";
  if (!bench.output) {
    list.push_back(
        of_elastic_bars(Of::elastic_modulus, kBoth, kBoth, "", *bench.input.youngs_modulus_Pa));
    return;
  }
  if (filed_alike(bench)) {
    list.push_back(
        of_elastic_bars(Of::elastic_modulus, kBoth, kBoth, "", *bench.input.youngs_modulus_Pa));
    list.back().of_both = true;
  }
  list.push_back(of_elastic_bars(Of::elastic_modulus, "input:bar-modulus", "input-bar-modulus",
                                 "input", *bench.input.youngs_modulus_Pa));
  list.push_back(of_elastic_bars(Of::elastic_modulus, "output:bar-modulus", "output-bar-modulus",
                                 "output", *bench.output->youngs_modulus_Pa));
  list.push_back(of_elastic_bars(Of::density, "input:bar-density", "bar-density", "input",
                                 bench.input.density_kg_m3));
  list.push_back(of_elastic_bars(Of::density, "output:bar-density", "output-bar-density", "output",
                                 bench.output->density_kg_m3));
  list.push_back(of_elastic_bars(Of::diameter, "input:bar-diameter", "bar-diameter", "input",
                                 bench.input.diameter_m));
  list.push_back(of_elastic_bars(Of::diameter, "output:bar-diameter", "output-bar-diameter",
                                 "output", bench.output->diameter_m));
}

void hold(EffectUse& use) {
  for (ModelValue& value : use.values) {
    value.free = false;
  }
}

/// The bars, held.
void add_bars(const Bench& bench, const CalibrationOptions& options, const Material& material,
              Model& model) {
  model.effects.push_back(use_named(kBars));
  hold(model.effects.back());
  if (each_bar_has_moduli(bench, options)) {
    model.effects.push_back(use_named(kOutputBar));
    hold(model.effects.back());
  }
  if (const auto further = further_effect(material, "")) {
    require_for_all_bars(*further, material, bench);
    model.effects.push_back(*further);
  }
}

/// A slice of the bar, or nothing between the bars; held.
void add_specimen(const Bench& bench, const Material& material, Model& model) {
  EffectUse use = use_named("three-element-specimen");
  hold(use);
  const bool slice = specimen_is_slice_of_bar(bench);
  const double E = bench.input.youngs_modulus_Pa ? bench.input.youngs_modulus_Pa->value : 0.0;
  const Material three = three_elements_of(material);
  use.values[0].value = !slice ? kRigid_Pa : E > 0.0 ? E : three.E1_Pa().value;
  use.values[1].value = !slice || E > 0.0 ? kRigid_Pa : three.E2_Pa().value;
  use.values[2].value = !slice || E > 0.0 ? 1.0 : three.eta2_Pa_s().value;
  model.effects.push_back(use);
  if (!slice) {
    return;
  }
  if (const auto further = further_effect(material, "specimen-"); further && E == 0.0) {
    model.effects.push_back(*further);
  }
  EffectUse inertia = use_named("specimen-inertia");
  inertia.values[0].value = 1.0;
  hold(inertia);
  model.effects.push_back(inertia);
}

}  // namespace

bool trusted(const CalibrationOptions& options, const std::string& gauge) {
  return std::find(options.trusted.begin(), options.trusted.end(), gauge) != options.trusted.end();
}

double ModelNumber::filed_sd() const {
  return (relative ? relative_sd(filed) : filed.sd) / per_value;
}

std::vector<ModelNumber> numbers_of(const CalibrationPart& part, const Bench& bench,
                                    const CalibrationOptions& options, const PartVariant& variant) {
  using Of = CalibratedNumber::Of;
  std::vector<ModelNumber> list;
  for (const Gauge& gauge : bench.gauges) {
    if (part.two_passes || trusted(options, gauge.name)) {
      continue;
    }
    list.push_back(of_gauge(Of::gain, "gauge-factor", gauge, {1.0, gain_sd(gauge)}, kGainStep));
    list.push_back(of_gauge(Of::position, "gauge-position", gauge, gauge.position_m, kPlaceStep_m));
    list.push_back(of_gauge(Of::delay, "channel-delay", gauge, gauge.delay_s, kDelayStep_s));
  }
  if (part.two_passes && !trusted(options, bench.gauges.front().name)) {
    list.push_back(way_to_end(bench));
  }
  if (bench.kind == BenchKind::bar && variant.far_end_seen) {
    ModelNumber number;
    number.of = Of::bar_length;
    number.id = number.effect = "bar-length";
    number.filed = bench.input.length_m;
    number.step = kPlaceStep_m;
    number.least_sd = kExactly * kPlaceStep_m;
    list.push_back(number);
  }
  if (all_elastic(bench)) {
    add_elastic_bars(bench, list);
  } else {
    const bool believed = options.bars.has_value();
    const Material& material = material_of(part, options);
    add_moduli(kBars, "", material, believed, list);
    if (each_bar_has_moduli(bench, options)) {
      add_moduli(kOutputBar, "output:", material, believed, list);
    }
  }
  return list;
}

Model part_model(const CalibrationPart& part, const Bench& bench, const CalibrationOptions& options,
                 const PartVariant& variant, const std::vector<ModelNumber>& numbers,
                 const std::set<std::string>& released, double loosen) {
  Model model;
  model.kind = bench.kind;
  if (!all_elastic(bench)) {
    add_bars(bench, options, material_of(part, options), model);
  }
  if (all_elastic(bench) && bench.output && !filed_alike(bench)) {
    // Each bar has its own number: none is off with the other.
    model.effects.push_back(use_named("bar-modulus"));
    hold(model.effects.back());
  }
  model.effects.push_back(use_named("elementary-waves"));
  if (variant.exact_waves) {
    EffectUse use = use_named("geometric-dispersion");
    use.values[0].value = 1.0;
    hold(use);
    model.effects.push_back(use);
  }
  if (variant.far_end_seen) {
    EffectUse use = use_named("end-reflection");
    hold(use);
    model.effects.push_back(use);
  }
  if (bench.kind == BenchKind::shpb) {
    add_specimen(bench, part.bars.material, model);
  }
  if (part.two_passes) {
    // Both passes are one gauge's: only the way between them is open.
    EffectUse use = use_named("gauge-position:" + bench.gauges[1].name);
    use.values[0].prior_sd = std::max(bench.gauges[1].position_m.sd, kExactly * kPlaceStep_m);
    model.effects.push_back(use);
    for (const Gauge& gauge : bench.gauges) {
      for (const char* const effect : {"gauge-factor:", "channel-delay:"}) {
        EffectUse same = use_named(effect + gauge.name);
        hold(same);
        model.effects.push_back(same);
      }
    }
  }
  for (const Gauge& gauge : bench.gauges) {
    for (const char* const effect : {"gauge-factor:", "gauge-position:", "channel-delay:"}) {
      if (trusted(options, gauge.name) && model.find(effect + gauge.name) == nullptr) {
        EffectUse use = use_named(effect + gauge.name);
        hold(use);
        model.effects.push_back(use);
      }
    }
  }
  for (const ModelNumber& number : numbers) {
    EffectUse* use = model.find(number.effect);
    if (use == nullptr) {
      model.effects.push_back(use_named(number.effect));
      use = &model.effects.back();
    }
    ModelValue& value = use->values[number.parameter];
    value.free = true;
    value.value = value.prior_mean = number.origin;
    const bool held = number.believed && released.count(number.id) == 0;
    value.prior_sd =
        held ? std::max({number.filed_sd(), number.least_sd, loosen * number.step}) : 0.0;
  }
  return model;
}

}  // namespace kolsky
