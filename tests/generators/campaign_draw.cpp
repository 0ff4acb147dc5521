#include "tests/generators/campaign_draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace kolsky::testing {

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

double normal(Random& random, double sd) {
  return std::normal_distribution<double>(0.0, 1.0)(random) * sd;
}

template <typename T, std::size_t N>
T one_of(Random& random, const std::array<T, N>& choices) {
  return choices[std::uniform_int_distribution<std::size_t>(0, N - 1)(random)];
}

// The last digit that a person would file.
double filed(double value, double unit) {
  return std::round(value / unit) * unit;
}

struct Row {
  double E1, E2, eta2, nu, density;
};

// Published three-element PMMA and its surroundings.
TrueMaterial draw_material(Random& random, bool elastic) {
  if (elastic) {
    constexpr std::array<Row, 3> kMetals{Row{206e9, 0, 0, 0.29, 7850}, Row{109e9, 0, 0, 0.33, 4416},
                                         Row{71.7e9, 0, 0, 0.333, 2810}};
    const Row metal = one_of(random, kMetals);
    TrueMaterial made;
    made.E1_Pa = metal.E1;
    made.elastic = true;
    made.density_kg_m3 = metal.density;
    made.poisson_ratio = metal.nu;
    return made;
  }
  constexpr std::array<Row, 4> kRows{
      Row{5.66e9, 37.0e9, 1.81e6, 0.36, 1180}, Row{5.25e9, 16.9e9, 2.13e6, 0.365, 1183},
      Row{5.78e9, 72.3e9, 4.75e6, 0.35, 1183}, Row{5.99e9, 28.5e9, 0.68e6, 0.38, 1190}};
  const Row row = one_of(random, kRows);
  TrueMaterial made;
  made.E1_Pa = row.E1 * uniform(random, 0.95, 1.05);
  made.E2_Pa = row.E2 * uniform(random, 0.8, 1.25);
  made.eta2_Pa_s = row.eta2 * uniform(random, 0.8, 1.25);
  made.poisson_ratio = filed(row.nu + uniform(random, -0.01, 0.01), 1e-3);
  made.density_kg_m3 = filed(row.density + uniform(random, -8.0, 8.0), 1.0);
  return made;
}

Timing draw_timing(Random& random, const CampaignWishes& wishes) {
  Timing timing;
  timing.rate_Hz =
      wishes.rate_Hz.value_or(one_of(random, std::array{0.5e6, 1e6, 1e6, 1.25e6, 2e6}));
  timing.samples =
      wishes.samples.value_or(one_of(random, std::array<std::size_t, 4>{1500, 2000, 2048, 4096}));
  const double most = std::min(500.0, 0.25 * static_cast<double>(timing.samples));
  timing.pretrigger = static_cast<std::size_t>(uniform(random, 100.0, most));
  timing.periods_per_knot = static_cast<std::size_t>(std::ceil(3.5e-6 * timing.rate_Hz - 1e-9));
  return timing;
}

std::vector<TrueGauge> draw_gauges(Random& random, int count, double longest_m, double radius_m) {
  std::vector<TrueGauge> gauges;
  double x = filed(std::max(10.0 * radius_m, uniform(random, 0.08, 0.25)), 1e-3);
  // Later gauges need room.
  const double most = std::min(0.45, (longest_m - x) / std::max(1, count - 1));
  for (int g = 0; g < count; ++g) {
    TrueGauge gauge;
    gauge.name = "g" + std::to_string(g + 1);
    gauge.position_m = x;
    gauges.push_back(gauge);
    x = filed(x + uniform(random, 0.4 * most, most), 1e-3);
  }
  return gauges;
}

double glassy_speed(const TrueMaterial& material) {
  return std::sqrt(material.E1_Pa / material.density_kg_m3);
}

void draw_shots(Random& random, BarWorld& world, int count, bool thermostat,
                double least_length_s = 50e-6) {
  const Timing& timing = world.timing;
  double nearest_m = world.length_m;
  for (const TrueGauge& gauge : world.gauges) {
    nearest_m = gauge.bar == "input" ? std::min(nearest_m, gauge.position_m) : nearest_m;
  }
  const double travel_s = nearest_m / glassy_speed(world.material);
  const double start_s =
      timing.lead_s + static_cast<double>(timing.pretrigger) * timing.period_s() - travel_s;
  const auto knots = static_cast<std::size_t>(timing.window_s() / timing.knot_s()) + 1;
  for (int i = 0; i < count; ++i) {
    TrueShot shot;
    shot.source = draw_pulse(random, start_s, timing.knot_s(), knots, least_length_s);
    shot.peak_strain = uniform(random, 1e-3, 3e-3);
    shot.striker_speed_m_per_s = filed(2.0 * shot.peak_strain * glassy_speed(world.material), 0.01);
    shot.temperature_K = world.reference_K + normal(random, thermostat ? 0.1 : 4.0);
    shot.temperature_K = filed(shot.temperature_K, 0.01);
    for (std::size_t g = 0; g < world.gauges.size(); ++g) {
      shot.offset.push_back(normal(random, 20e-6));
    }
    shot.hum_phase = uniform(random, 0.0, 2.0 * std::numbers::pi);
    world.shots.push_back(shot);
  }
}

Bench file_bench(const BarWorld& world) {
  Bench bench;
  bench.kind = BenchKind::bar;
  bench.sampling_frequency_Hz = {world.timing.rate_Hz, 0.0};
  bench.input.length_m = {world.length_m, 0.0};
  bench.input.diameter_m = {2.0 * world.radius_m, 0.0};
  bench.input.density_kg_m3 = {world.material.density_kg_m3, 0.0};
  bench.input.poisson_ratio = {world.material.poisson_ratio, 0.0};
  if (world.material.elastic) {
    bench.input.youngs_modulus_Pa = Measured{world.material.E1_Pa, 0.0};
  }
  bench.temperature_K = Measured{world.reference_K, 0.0};
  for (const TrueGauge& gauge : world.gauges) {
    Gauge as_filed;
    as_filed.name = gauge.name;
    as_filed.bar = "input";
    as_filed.position_m = {gauge.position_m, 0.0};
    as_filed.unit = "strain";
    bench.gauges.push_back(as_filed);
  }
  return bench;
}

// The filed numbers stay; what is true moves within the deviations.
void loosen(Random& random, BarWorld& world, Bench& bench) {
  const double position_sd = one_of(random, std::array{0.1e-3, 0.2e-3, 0.5e-3});
  const double gain_sd = one_of(random, std::array{0.002, 0.005, 0.01});
  for (std::size_t g = 0; g < world.gauges.size(); ++g) {
    bench.gauges[g].position_m.sd = position_sd;
    world.gauges[g].position_m += normal(random, position_sd);
    bench.gauges[g].unit = "V";
    bench.gauges[g].strain_per_V = Measured{5e-4, gain_sd * 5e-4};
    // Filed strain per volt against the true one: the reading is large where the truth is small.
    world.gauges[g].gain = 1.0 / (1.0 + normal(random, gain_sd));
  }
  bench.input.density_kg_m3.sd = 0.002 * bench.input.density_kg_m3;
  world.material.density_kg_m3 += normal(random, bench.input.density_kg_m3.sd);
  if (world.material.elastic) {
    bench.input.youngs_modulus_Pa->sd = 0.002 * world.material.E1_Pa;
    world.material.E1_Pa *= 1.0 + normal(random, 0.002);
  }
}

// Core or cover, more or less; something stiffer between metal bars.
TrueSpecimen draw_specimen(Random& random, double bar_radius_m, bool stiff) {
  TrueSpecimen specimen;
  if (uniform(random, 0.0, 1.0) < 0.4) {
    specimen.density_kg_m3 = 960.0;
    specimen.poisson_ratio = 0.319;
    specimen.E1_Pa = 987e6;
    specimen.E2_Pa = 452e6;
    specimen.eta2_Pa_s = 6020.0;
  }
  if (stiff) {
    // Between metal bars: a glassy polymer.
    specimen.density_kg_m3 = 1190.0;
    specimen.poisson_ratio = 0.37;
    specimen.E1_Pa = 4.5e9;
    specimen.E2_Pa = 8e9;
    specimen.eta2_Pa_s = 2e5;
  }
  specimen.E1_Pa *= uniform(random, 0.8, 1.25);
  specimen.E2_Pa *= uniform(random, 0.8, 1.25);
  specimen.eta2_Pa_s *= uniform(random, 0.8, 1.25);
  specimen.length_m = filed(uniform(random, 3e-3, 6e-3), 1e-4);
  specimen.diameter_m = filed(uniform(random, 0.55, 0.85) * 2.0 * bar_radius_m, 1e-4);
  return specimen;
}

/// A rubber in its place, of the same size.
void soften(Random& random, TrueSpecimen& specimen) {
  specimen.density_kg_m3 = filed(uniform(random, 900.0, 1150.0), 1.0);
  specimen.poisson_ratio = filed(uniform(random, 0.45, 0.49), 1e-3);
  specimen.E1_Pa = 10e6 * std::pow(6.0, uniform(random, 0.0, 1.0));
  specimen.E2_Pa = specimen.E1_Pa * uniform(random, 0.5, 2.0);
  const double relaxation_s = uniform(random, 10e-6, 60e-6);
  specimen.eta2_Pa_s = relaxation_s * (specimen.E1_Pa + specimen.E2_Pa);
}

/// A solid that relaxes little, of the same spring.
void stiffen_branch(Random& random, TrueSpecimen& specimen) {
  specimen.E2_Pa = specimen.E1_Pa * 30.0 * std::pow(10.0, uniform(random, 0.0, 1.0));
  specimen.eta2_Pa_s = uniform(random, 20e-6, 150e-6) * specimen.E2_Pa;
}

std::vector<TrueGauge> draw_split_gauges(Random& random, int count, double in_m, double out_m) {
  std::vector<TrueGauge> gauges;
  for (int g = 0; g < count; ++g) {
    TrueGauge gauge;
    gauge.name = "g" + std::to_string(g + 1);
    gauge.bar = g % 2 == 0 ? "input" : "output";
    const double share = uniform(random, 0.0, 1.0);
    // A second gauge on a bar stands apart from the first.
    const double low = g < 2 ? 0.45 : 0.15;
    gauge.position_m = g % 2 == 0 ? filed(in_m * (low + 0.2 * share), 1e-3)
                                  : filed(out_m * (0.6 - low + 0.15 * share), 1e-3);
    gauges.push_back(gauge);
  }
  return gauges;
}

Material filed_material(const TrueMaterial& material) {
  Material filed_as;
  filed_as.density_kg_m3 = {material.density_kg_m3, 0.0};
  filed_as.poisson_ratio = {material.poisson_ratio, 0.0};
  filed_as.E1_Pa() = {material.E1_Pa, 0.0};
  filed_as.E2_Pa() = {material.E2_Pa, 0.0};
  filed_as.eta2_Pa_s() = {material.eta2_Pa_s, 0.0};
  return filed_as;
}

void loosen_bars(Random& random, Campaign& campaign) {
  const auto loosen_one = [&](Measured& number, double& truth, double share) {
    number.sd = share * number.value;
    truth += normal(random, number.sd);
  };
  TrueMaterial& material = campaign.world.material;
  if (campaign.filed_bars) {
    loosen_one(campaign.filed_bars->E1_Pa(), material.E1_Pa, 1e-4);
    loosen_one(campaign.filed_bars->E2_Pa(), material.E2_Pa, 2e-3);
    loosen_one(campaign.filed_bars->eta2_Pa_s(), material.eta2_Pa_s, 2e-3);
  }
  TrueSpecimen& specimen = campaign.split->specimen;
  loosen_one(campaign.bench.specimen->length_m, specimen.length_m, 0.002);
  loosen_one(campaign.bench.specimen->diameter_m, specimen.diameter_m, 0.001);
}

void file_split(Campaign& campaign) {
  const SplitParts& split = *campaign.split;
  campaign.bench = file_bench(campaign.world);
  Bench& bench = campaign.bench;
  bench.kind = BenchKind::shpb;
  bench.output = bench.input;
  bench.output->length_m = {split.output_length_m, 0.0};
  for (std::size_t g = 0; g < bench.gauges.size(); ++g) {
    bench.gauges[g].bar = campaign.world.gauges[g].bar;
  }
  bench.specimen = Specimen{{split.specimen.length_m, 0.0},
                            {split.specimen.diameter_m, 0.0},
                            Measured{split.specimen.density_kg_m3, 0.0},
                            Measured{split.specimen.poisson_ratio, 0.0}};
  if (!campaign.world.material.elastic) {
    campaign.filed_bars = filed_material(campaign.world.material);
  }
}

// Stress at the impacted end for a peak of about that strain, less where the specimen would be
// crushed: rigid bars would shorten it by twice the pulse's displacement.
void scale_sources(Random& random, BarWorld& world, const TrueSpecimen& specimen) {
  const double most_strain = specimen.solid ? 0.05 : 0.35;
  for (TrueShot& shot : world.shots) {
    const double most = *std::ranges::max_element(shot.source);
    double lasting_s = 0.0;
    for (const double bell : shot.source) {
      lasting_s += std::max(bell, 0.0) / most * world.timing.knot_s();
    }
    const double crushing =
        most_strain * specimen.length_m / (2.0 * glassy_speed(world.material) * lasting_s);
    shot.peak_strain = std::min(shot.peak_strain, crushing * uniform(random, 0.6, 1.0));
    for (double& bell : shot.source) {
      bell *= shot.peak_strain * world.material.E1_Pa / most;
    }
  }
}

void draw_split(Random& random, Campaign& campaign) {
  const CampaignWishes& wishes = campaign.wishes;
  BarWorld& world = campaign.world;
  // The paper's bars half of the time.
  if (wishes.elastic || uniform(random, 0.0, 1.0) < 0.5) {
    world.material = draw_material(random, wishes.elastic);
  }
  world.timing = draw_timing(random, wishes);
  // Split bars are recorded for a few milliseconds at most.
  world.timing.samples = std::min(
      world.timing.samples, static_cast<std::size_t>(std::lround(2.5e-3 * world.timing.rate_Hz)));
  world.timing.pretrigger = std::min(world.timing.pretrigger, world.timing.samples / 5);
  if (!wishes.samples) {
    const double least =
        1.3e-3 * world.timing.rate_Hz + static_cast<double>(world.timing.pretrigger);
    world.timing.samples = std::max(world.timing.samples, static_cast<std::size_t>(least));
  }
  world.radius_m = wishes.radius_m.value_or(filed(uniform(random, 6e-3, 10e-3), 0.5e-3));
  world.length_m = filed(uniform(random, 0.6, 1.5), 1e-2);
  SplitParts split;
  split.output_length_m = uniform(random, 0.0, 1.0) < 0.6
                              ? world.length_m
                              : filed(world.length_m * uniform(random, 0.7, 1.0), 1e-2);
  split.specimen = draw_specimen(random, world.radius_m, world.material.elastic);
  split.specimen.solid = wishes.solid_specimen;
  if (wishes.soft_specimen) {
    soften(random, split.specimen);
  }
  if (wishes.low_loss_specimen) {
    stiffen_branch(random, split.specimen);
  }
  world.gauges = draw_split_gauges(random, wishes.gauges, world.length_m, split.output_length_m);
  campaign.split = split;
  draw_shots(random, world, wishes.shots, uniform(random, 0.0, 1.0) < 0.5, 110e-6);
  scale_sources(random, world, split.specimen);
  file_split(campaign);
  if (wishes.tolerances == Tolerances::filed) {
    loosen(random, world, campaign.bench);
    // Both bars are of one stock: one density is filed, and exactly.
    world.material.density_kg_m3 = campaign.bench.input.density_kg_m3;
    campaign.bench.input.density_kg_m3.sd = 0.0;
    loosen_bars(random, campaign);
  }
}

}  // namespace

std::vector<double> draw_pulse(std::mt19937_64& random, double start_s, double knot_s,
                               std::size_t knots, double least_length_s) {
  const double length_s = uniform(random, least_length_s, 220e-6);
  const double rise_s = std::min(uniform(random, 15e-6, 45e-6), 0.5 * length_s);
  const double fall_s = std::min(uniform(random, 15e-6, 80e-6), length_s - rise_s);
  const double ripple = uniform(random, 0.0, 0.12);
  const double ripple_Hz = uniform(random, 8e3, 30e3);
  const double droop = uniform(random, -0.25, 0.4);
  const double tail = uniform(random, 0.0, 0.15);
  std::vector<double> c(knots, 0.0);
  for (std::size_t k = 0; k < knots; ++k) {
    const double t = (static_cast<double>(k) + 3.0) * knot_s - start_s;
    if (t <= 0.0) {
      continue;
    }
    const auto edge = [](double u) {
      return u <= 0.0 ? 0.0 : u >= 1.0 ? 1.0 : 0.5 - 0.5 * std::cos(std::numbers::pi * u);
    };
    const double body = edge(t / rise_s) * edge((length_s - t) / fall_s);
    const double wave =
        1.0 - droop * t / length_s + ripple * std::sin(2.0 * std::numbers::pi * ripple_Hz * t);
    // The striker lets go slowly.
    const double rest = tail * edge(t / length_s) * std::exp(-t / (2.0 * length_s));
    c[k] = body * wave + rest;
  }
  return c;
}

void draw_truth_anew(std::mt19937_64& random, Campaign& campaign) {
  const auto draw = [&](const Measured& filed_as, double& truth) {
    if (filed_as.sd > 0.0) {
      truth = filed_as.value + normal(random, filed_as.sd);
    }
  };
  BarWorld& world = campaign.world;
  const Bench& bench = campaign.bench;
  for (std::size_t g = 0; g < world.gauges.size(); ++g) {
    draw(bench.gauges[g].position_m, world.gauges[g].position_m);
    if (const auto& factor = bench.gauges[g].strain_per_V; factor && factor->sd > 0.0) {
      world.gauges[g].gain = 1.0 / (1.0 + normal(random, factor->sd / factor->value));
    }
  }
  draw(bench.input.density_kg_m3, world.material.density_kg_m3);
  if (bench.input.youngs_modulus_Pa) {
    draw(*bench.input.youngs_modulus_Pa, world.material.E1_Pa);
  }
  if (campaign.filed_bars) {
    draw(campaign.filed_bars->E1_Pa(), world.material.E1_Pa);
    draw(campaign.filed_bars->E2_Pa(), world.material.E2_Pa);
    draw(campaign.filed_bars->eta2_Pa_s(), world.material.eta2_Pa_s);
  }
  if (campaign.split) {
    draw(bench.specimen->length_m, campaign.split->specimen.length_m);
    draw(bench.specimen->diameter_m, campaign.split->specimen.diameter_m);
  }
}

ShpbWorld split_world(const Campaign& campaign) {
  return {campaign.world, campaign.split->output_length_m, campaign.split->specimen};
}

Campaign draw_campaign(const CampaignWishes& wishes) {
  Random random(wishes.seed);
  Campaign campaign;
  campaign.wishes = wishes;
  BarWorld& world = campaign.world;
  campaign.bits = wishes.bits.value_or(one_of(random, std::array{12, 14, 16, 16}));
  campaign.full_scale_strain = uniform(random, 4e-3, 6e-3);
  const bool tension = uniform(random, 0.0, 1.0) < 0.1;
  if (wishes.split) {
    draw_split(random, campaign);
    campaign.bench.positive = tension ? PositiveSense::tension : PositiveSense::compression;
    return campaign;
  }
  world.material = draw_material(random, wishes.elastic);
  world.timing = draw_timing(random, wishes);
  world.radius_m = wishes.radius_m.value_or(filed(uniform(random, 6e-3, 12e-3), 0.5e-3));
  world.length_m = filed(uniform(random, 0.7, 3.0), 1e-3);
  // Every gauge sees most of the pulse before the record ends.
  const double after_s =
      static_cast<double>(world.timing.samples - world.timing.pretrigger) * world.timing.period_s();
  const double longest_m = std::min(
      {world.length_m - 0.1, 1.6, 0.2 + glassy_speed(world.material) * (after_s - 250e-6)});
  world.gauges = draw_gauges(random, wishes.gauges, longest_m, world.radius_m);
  const bool thermostat = uniform(random, 0.0, 1.0) < 0.5;
  draw_shots(random, world, wishes.shots, thermostat);
  campaign.bench = file_bench(world);
  campaign.bench.positive = tension ? PositiveSense::tension : PositiveSense::compression;
  if (wishes.tolerances == Tolerances::filed) {
    loosen(random, world, campaign.bench);
  }
  return campaign;
}

}  // namespace kolsky::testing
