#include "drivers/simulated/scenario.hpp"

#include <cmath>
#include <numbers>
#include <ostream>

#include "drivers/simulated/ball_shot.hpp"
#include "drivers/simulated/number_text.hpp"
#include "processing/base/error.hpp"
#include "processing/base/material.hpp"

namespace kolsky {

namespace {

double circle_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

RodMaterial solid(const Material& material) {
  return {material.density_kg_m3, material.E1_Pa(), material.E2_Pa(), material.eta2_Pa_s()};
}

// The paper's specimens (Table 4).
constexpr RodMaterial kCore{1140.0, 121e6, 143e6, 2.86e3};
constexpr double kCorePoisson = 0.376;
constexpr RodMaterial kCover{960.0, 987e6, 452e6, 6.02e3};
constexpr double kCoverPoisson = 0.319;

constexpr RodMaterial kSteel{7800.0, 210e9, 0.0, 0.0};
constexpr RodMaterial kSoftMetal{2700.0, 10e9, 0.0, 0.0};

Bar bar(double length_m, double diameter_m, double density_kg_m3, double poisson_ratio) {
  Bar made;
  made.length_m = {length_m};
  made.diameter_m = {diameter_m};
  made.density_kg_m3 = {density_kg_m3};
  made.poisson_ratio = {poisson_ratio};
  return made;
}

Bar pmma_bar(double length_m, double diameter_m) {
  const Material pmma = paper_pmma();
  return bar(length_m, diameter_m, pmma.density_kg_m3, pmma.poisson_ratio);
}

Gauge gauge(const char* name, const char* on, double position_m) {
  Gauge made;
  made.name = name;
  made.bar = on;
  made.position_m = {position_m};
  made.unit = "V";
  return made;
}

/// Completes the time-domain side from the nominal bench.
void build_model(Scenario& scenario, const RodMaterial& bars, const RodMaterial& specimen) {
  const Bench& bench = scenario.bench;
  scenario.model.input = {bench.input.length_m, bench.input.area_m2(), bars};
  if (bench.specimen) {
    scenario.model.specimen = {bench.specimen->length_m, bench.specimen->area_m2(), specimen};
  }
  if (bench.output) {
    scenario.model.output = {bench.output->length_m, bench.output->area_m2(), bars};
  }
  for (const Gauge& g : bench.gauges) {
    scenario.model.gauges.push_back(
        {g.bar == "output" ? RodId::output : RodId::input, g.position_m});
  }
}

/// The paper's bench: two PMMA bars of 15 x 700 mm, gauges 300 mm before and 50 mm behind the
/// specimen.
Scenario paper_bench(const char* name, const char* text, const Specimen& nominal,
                     const RodMaterial& specimen) {
  Scenario scenario;
  scenario.name = name;
  scenario.text = text;
  scenario.bench.kind = BenchKind::shpb;
  scenario.bench.sampling_frequency_Hz = {1e6, 0.0};
  scenario.bench.input = pmma_bar(0.700, 0.015);
  scenario.bench.output = scenario.bench.input;
  scenario.bench.gauges = {gauge("g1", "input", 0.400), gauge("g2", "output", 0.050)};
  scenario.bench.specimen = nominal;
  scenario.model.pulse.peak_force_N = 914.0;  // 1000 microstrain at g1
  build_model(scenario, solid(paper_pmma()), specimen);
  return scenario;
}

Specimen disc(double length_m, double diameter_m, double density_kg_m3, double poisson_ratio) {
  Specimen made;
  made.length_m = {length_m};
  made.diameter_m = {diameter_m};
  made.density_kg_m3 = {density_kg_m3};
  made.poisson_ratio = {poisson_ratio};
  return made;
}

Scenario core(const char* name, const char* text, double length_m) {
  return paper_bench(name, text, disc(length_m, 0.012, kCore.density_kg_m3, kCorePoisson), kCore);
}

Scenario cover() {
  return paper_bench("cover", "the paper's bench, cover specimen (ionomer) of 12 x 4 mm",
                     disc(0.004, 0.012, kCover.density_kg_m3, kCoverPoisson), kCover);
}

Scenario bars_together() {
  const Material pmma = paper_pmma();
  return paper_bench(
      "bars-together",
      "the paper's bench with a 4 mm slice of its own PMMA for a specimen: all passes",
      disc(0.004, 0.015, pmma.density_kg_m3, pmma.poisson_ratio), solid(pmma));
}

Scenario long_bar() {
  Scenario scenario;
  scenario.name = "bar";
  scenario.text = "a PMMA bar of 20 mm x 2 m to characterise, four gauges from 100 mm every 200 mm";
  scenario.bench.kind = BenchKind::bar;
  scenario.bench.sampling_frequency_Hz = {1e6, 0.0};
  scenario.bench.input = pmma_bar(2.0, 0.020);
  scenario.bench.gauges = {gauge("g1", "input", 0.1), gauge("g2", "input", 0.3),
                           gauge("g3", "input", 0.5), gauge("g4", "input", 0.7)};
  scenario.model.pulse.peak_force_N = 1578.0;  // 1000 microstrain at g1
  build_model(scenario, solid(paper_pmma()), {});
  return scenario;
}

Scenario steel() {
  Scenario scenario;
  scenario.name = "steel";
  scenario.text = "elastic steel bars of 20 mm, an elastic specimen of 8 x 4 mm, 500 microstrain";
  scenario.bench.kind = BenchKind::shpb;
  scenario.bench.sampling_frequency_Hz = {1e6, 0.0};
  scenario.bench.input = bar(2.1, 0.020, kSteel.density_kg_m3, 0.29);
  scenario.bench.input.youngs_modulus_Pa = Measured{kSteel.E1_Pa};
  scenario.bench.output = scenario.bench.input;
  scenario.bench.output->length_m = {1.8};
  scenario.bench.gauges = {gauge("g1", "input", 1.08), gauge("g2", "output", 0.77)};
  scenario.bench.specimen = disc(0.004, 0.008, kSoftMetal.density_kg_m3, 0.33);
  scenario.front_end.range_microstrain = 1000.0;
  scenario.model.pulse.peak_force_N = 500e-6 * kSteel.E1_Pa * circle_m2(0.020);
  build_model(scenario, kSteel, kSoftMetal);
  return scenario;
}

constexpr RodMaterial kTitanium{4420.0, 113e9, 0.0, 0.0};

Material rubber(const RodMaterial& solid, double poisson_ratio) {
  return three_element_material({solid.density_kg_m3}, {poisson_ratio}, {solid.E1_Pa},
                                {solid.E2_Pa}, {solid.eta2_Pa_s}, "the paper");
}

/// The paper's ball on its titanium bar, a gauge 250 mm from the face, two beams on the ball's way.
Scenario impact(const char* name, const char* text, double speed_m_per_s) {
  Scenario scenario;
  scenario.name = name;
  scenario.text = text;
  scenario.bench.kind = BenchKind::impact;
  scenario.bench.sampling_frequency_Hz = {1e6, 0.0};
  scenario.bench.input = bar(3.0, 0.027, kTitanium.density_kg_m3, 0.33);
  scenario.bench.input.youngs_modulus_Pa = Measured{kTitanium.E1_Pa};
  scenario.bench.gauges = {gauge("g1", "input", 0.250)};
  scenario.bench.ball = Ball{{0.0427}, {0.03565}, Measured{0.0434}, false};
  scenario.bench.photo_sensors = {{"p1", {0.090}}, {"p2", {0.060}}};
  scenario.ball =
      ThrownBall{speed_m_per_s, rubber(kCore, kCorePoisson), rubber(kCover, kCoverPoisson)};
  scenario.front_end.range_microstrain = 500.0;
  scenario.front_end.noise_microstrain = 0.5;  // semiconductors answer sixty times a foil's strain
  scenario.front_end.hum_microstrain = 0.1;
  scenario.front_end.offset_microstrain = 5.0;
  scenario.record_s = 10e-3;
  build_model(scenario, kTitanium, {});
  return scenario;
}

Scenario quiet() {
  Scenario scenario = core("quiet", "the paper's bench, noise only: a shot brings no pulse", 0.004);
  scenario.model.pulse.peak_force_N = 0.0;
  return scenario;
}

void add_bar(std::string& toml, const char* table, const Bar& bar) {
  const auto line = [&toml](const char* key, double value) {
    toml += std::string(key) + " = " + number_text(value) + "\n";
  };
  toml += std::string("\n[") + table + "]\n";
  line("length_m", bar.length_m);
  line("diameter_m", bar.diameter_m);
  line("density_kg_m3", bar.density_kg_m3);
  line("poisson_ratio", bar.poisson_ratio);
  if (bar.youngs_modulus_Pa) {
    line("youngs_modulus_Pa", *bar.youngs_modulus_Pa);
  }
}

}  // namespace

std::vector<Scenario> scenarios() {
  return {core("core", "the paper's bench, core specimen (polybutadiene) of 12 x 4 mm", 0.004),
          cover(),
          core("core-6mm", "the paper's bench, core specimen of 12 x 6 mm: no equilibrium", 0.006),
          bars_together(),
          long_bar(),
          steel(),
          impact("impact",
                 "the paper's golf ball on a titanium bar at 31.1 m/s, photo-sensors p1 p2", 31.1),
          impact("impact-40", "the same at 40.3 m/s", 40.3),
          impact("impact-51", "the same at 51.0 m/s", 51.0),
          quiet()};
}

Scenario find_scenario(const std::string& name) {
  std::string names;
  for (Scenario& scenario : scenarios()) {
    if (scenario.name == name) {
      return std::move(scenario);
    }
    if (!names.empty()) {
      names += ", ";
    }
    names += scenario.name;
  }
  throw InputError("scenario", "'" + name + "' is not one", "give one of " + names);
}

std::string bench_toml(const Scenario& scenario) {
  const Bench& bench = scenario.bench;
  const char* const kind = bench.kind == BenchKind::bar    ? "bar"
                           : bench.kind == BenchKind::shpb ? "shpb"
                                                           : "impact";
  std::string toml = std::string("kind = \"") + kind +
                     "\"\nsampling_frequency_Hz = " + number_text(bench.sampling_frequency_Hz) +
                     "\npositive = \"compression\"\n";
  add_bar(toml, "bars.input", bench.input);
  if (bench.output) {
    add_bar(toml, "bars.output", *bench.output);
  }
  for (const Gauge& gauge : bench.gauges) {
    toml += "\n[[gauges]]\nname = \"" + gauge.name + "\"\nbar = \"" + gauge.bar +
            "\"\nposition_m = " + number_text(gauge.position_m) +
            "\nunit = \"V\"\nstrain_per_V = " + number_text(scenario.front_end.strain_per_V()) +
            "\n";
  }
  if (bench.specimen) {
    toml += "\n[specimen]\nlength_m = " + number_text(bench.specimen->length_m) +
            "\ndiameter_m = " + number_text(bench.specimen->diameter_m) +
            "\ndensity_kg_m3 = " + number_text(*bench.specimen->density_kg_m3) +
            "\npoisson_ratio = " + number_text(*bench.specimen->poisson_ratio) + "\n";
  }
  for (const PhotoSensor& sensor : bench.photo_sensors) {
    toml += "\n[[photo_sensors]]\nname = \"" + sensor.name +
            "\"\ndistance_m = " + number_text(sensor.distance_m) + "\n";
  }
  if (bench.ball) {
    toml += "\n[ball]\nouter_diameter_m = " + number_text(bench.ball->outer_diameter_m) +
            "\ncore_diameter_m = " + number_text(bench.ball->core_diameter_m) +
            "\nmass_kg = " + number_text(*bench.ball->mass_kg) + "\n";
  }
  return toml;
}

BenchHistory run_shot(const Scenario& scenario) {
  const auto whole = static_cast<std::size_t>(std::llround(scenario.record_s * kStepsPerSecond));
  const auto fading = static_cast<std::size_t>(std::llround(scenario.fade_s * kStepsPerSecond));
  const double step_s = 1.0 / kStepsPerSecond;
  BenchHistory shot = scenario.ball ? run_ball(scenario, step_s, whole + fading)
                                    : run_bench(scenario.model, step_s, whole + fading);
  for (std::vector<double>& strain : shot.gauge_strain) {
    for (std::size_t i = 0; i < fading; ++i) {
      const double c =
          std::cos(std::numbers::pi / 2.0 * static_cast<double>(i) / static_cast<double>(fading));
      strain[whole + i] *= c * c;
    }
  }
  return shot;
}

void write_truth(const Scenario& scenario, const BenchHistory& shot, std::ostream& out) {
  if (shot.ball) {
    out << "time_s,force_N\n";
    for (std::size_t i = 0; i < shot.ball->time_s.size(); ++i) {
      out << number_text(shot.ball->time_s[i]) << ',' << number_text(shot.ball->force_N[i]) << '\n';
    }
    return;
  }
  if (!shot.specimen) {
    throw InputError("truth", "scenario '" + scenario.name + "' has no specimen",
                     "choose one that has");
  }
  const SpecimenHistory& s = *shot.specimen;
  out << "time_s,stress_Pa,strain,strain_rate_per_s,force_front_N,force_back_N\n";
  const auto every = static_cast<std::size_t>(
      std::llround(kStepsPerSecond / scenario.bench.sampling_frequency_Hz));
  const auto rows = static_cast<std::size_t>(std::llround(scenario.record_s * kStepsPerSecond));
  for (std::size_t i = 0; i < rows; i += every) {
    out << number_text(s.time_s[i]) << ',' << number_text(s.stress_Pa[i]) << ','
        << number_text(s.strain[i]) << ',' << number_text(s.strain_rate_per_s[i]) << ','
        << number_text(s.force_front_N[i]) << ',' << number_text(s.force_back_N[i]) << '\n';
  }
}

}  // namespace kolsky
