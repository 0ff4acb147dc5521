#include "drivers/files/settings/bench_file.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/settings/toml_table.hpp"

namespace kolsky {

namespace {

Measured equal_area_diameter(const Measured& side_m) {
  const double factor = 2.0 / std::sqrt(std::numbers::pi);
  return {factor * side_m.value, factor * side_m.sd};
}

Bar read_bar(const TomlTable& table) {
  table.expect({"length_m", "diameter_m", "density_kg_m3", "poisson_ratio", "youngs_modulus_Pa",
                "material", "section", "side_m", "far_end"});
  Bar bar;
  if (table.has("section")) {
    constexpr std::array kSections{Section::round, Section::square};
    bar.section = kSections.at(table.choice("section", {"round", "square"}));
  }
  if (table.has("far_end")) {
    constexpr std::array kFarEnds{FarEnd::free, FarEnd::matched};
    bar.far_end = kFarEnds.at(table.choice("far_end", {"free", "matched"}));
  }
  bar.length_m = table.measured("length_m");
  bar.side_m = table.optional_measured("side_m");
  const bool derived = bar.section == Section::square && bar.side_m && !table.has("diameter_m");
  bar.diameter_m = derived ? equal_area_diameter(*bar.side_m) : table.measured("diameter_m");
  bar.density_kg_m3 = table.measured("density_kg_m3");
  bar.poisson_ratio = table.measured("poisson_ratio");
  bar.youngs_modulus_Pa = table.optional_measured("youngs_modulus_Pa");
  if (const auto material = table.optional_table("material")) {
    bar.material = read_material(*material);
  }
  return bar;
}

// The struck end is the input bar's far end: what is beyond it is the striker's business.
void refuse_far_end(const TomlTable& input) {
  if (input.has("far_end")) {
    throw input.error("far_end",
                      "is what the output bar ends in; the input bar ends where it is struck",
                      "remove it, or move it to [bars.output]");
  }
}

// Numbers that are used without their deviation may still have one: it travels with the text.
std::optional<double> read_plain(const TomlTable& table, const std::string& key) {
  const std::optional<Measured> number = table.optional_measured(key);
  return number ? std::optional(number->value) : std::nullopt;
}

// A whole number small enough for what it counts; check() judges it.
int read_count(const TomlTable& table, const std::string& key, int otherwise) {
  const std::int64_t count = table.optional_integer(key).value_or(otherwise);
  if (count < 0 || count > 1000) {
    throw table.error(key, "is out of range", "give a small whole number");
  }
  return static_cast<int>(count);
}

/// Of the gain that a shunt's step gives: its two resistances make the step, and it was read.
double relative_sd_of_shunt(const TomlTable& table) {
  double variance = 0.0;
  for (const std::string key :
       {"shunt_resistance_ohm", "shunt_reading_V", "gauge_resistance_ohm"}) {
    const Measured number = table.optional_measured(key).value_or(Measured{});
    variance += std::pow(relative_sd(number), 2);
  }
  return std::sqrt(variance);
}

Bridge read_bridge(const TomlTable& table) {
  constexpr std::array kWirings{BridgeWiring::quarter, BridgeWiring::half,
                                BridgeWiring::half_poisson, BridgeWiring::full_poisson,
                                BridgeWiring::full_poisson};
  Bridge bridge;
  bridge.wiring = kWirings.at(
      table.choice("bridge", {"quarter", "half", "half-poisson", "full-poisson", "full"}));
  bridge.gauge_factor = table.measured("gauge_factor");
  bridge.gauge_factor_per_strain =
      table.optional_measured("gauge_factor_per_strain").value_or(Measured{});
  bridge.excitation_V = table.measured("excitation_V");
  bridge.gauge_resistance_ohm = read_plain(table, "gauge_resistance_ohm").value_or(0.0);
  bridge.lead_resistance_ohm = read_plain(table, "lead_resistance_ohm").value_or(0.0);
  bridge.lead_wires = read_count(table, "lead_wires", bridge.lead_wires);
  bridge.gauges_in_series = read_count(table, "gauges_in_series", bridge.gauges_in_series);
  bridge.shunt_resistance_ohm = read_plain(table, "shunt_resistance_ohm");
  bridge.shunt_reading_V = read_plain(table, "shunt_reading_V");
  const bool has_shunt = bridge.shunt_resistance_ohm || bridge.shunt_reading_V;
  if (has_shunt && table.has("gain")) {
    throw table.error("gain", "is given beside a shunt calibration, which takes its place",
                      "keep one of them");
  }
  if (has_shunt) {
    bridge.shunt_gain.sd = relative_sd_of_shunt(table);
  } else {
    bridge.gain = table.measured("gain");
  }
  return bridge;
}

/// What is filed beside samples that are strain already takes no part in converting them; its
/// deviations say how well they are known. A deviation alone is relative: of a factor 1.
double read_gain_sd(const TomlTable& table) {
  double variance = 0.0;
  for (const std::string key : {"gauge_factor", "excitation_V", "gain"}) {
    Measured factor{1.0, 0.0};
    if (table.has(key)) {
      factor = table.measured(key);
    } else if (table.has(key + "_sd")) {
      factor.sd = table.number(key + "_sd");
    }
    if (factor.value == 0.0 || factor.sd < 0.0) {
      throw table.error(key, "cannot be a factor with that deviation",
                        "give a number above 0 and its standard deviation");
    }
    variance += factor.sd * factor.sd / (factor.value * factor.value);
  }
  return std::sqrt(variance);
}

void refuse_bridge_keys_alone(const TomlTable& table, bool strain) {
  if (strain) {
    return;
  }
  for (const std::string key : {"gauge_factor", "gauge_factor_per_strain", "excitation_V", "gain",
                                "gauge_resistance_ohm", "lead_resistance_ohm", "lead_wires",
                                "gauges_in_series", "shunt_resistance_ohm", "shunt_reading_V"}) {
    for (const std::string& own : {key, key + "_sd"}) {
      if (table.has(own)) {
        throw table.error(
            own, "is given, and no bridge",
            "add bridge = \"quarter\", \"half\", \"half-poisson\" or \"full-poisson\"");
      }
    }
  }
}

/// None where nothing is filed; a deviation alone is of a delay that should be none.
Measured read_delay(const TomlTable& table) {
  if (table.has("delay_s")) {
    return table.measured("delay_s");
  }
  Measured delay;
  if (table.has("delay_s_sd")) {
    delay.sd = table.number("delay_s_sd");
    if (delay.sd < 0.0) {
      throw table.error("delay_s_sd", "is below 0", "give a standard deviation in seconds");
    }
  }
  return delay;
}

Gauge read_gauge(const TomlTable& table) {
  table.expect({"name", "bar", "position_m", "unit", "length_m", "delay_s", "strain_per_V",
                "bridge", "gauge_factor", "gauge_factor_per_strain", "excitation_V", "gain",
                "gauge_resistance_ohm", "lead_resistance_ohm", "lead_wires", "gauges_in_series",
                "shunt_resistance_ohm", "shunt_reading_V", "inverted"});
  Gauge gauge;
  gauge.name = table.text("name");
  gauge.bar = table.text("bar");
  gauge.position_m = table.measured("position_m");
  gauge.unit = table.text("unit");
  if (gauge.unit != "strain" && gauge.unit != "V") {
    // Before the keys beside it, which go by the unit.
    throw table.error("unit", "is \"" + gauge.unit + "\"", "give \"strain\" or \"V\"");
  }
  gauge.length_m = table.optional_measured("length_m");
  gauge.delay_s = read_delay(table);
  gauge.inverted = table.optional_flag("inverted").value_or(false);
  gauge.strain_per_V = table.optional_measured("strain_per_V");
  if (table.has("bridge")) {
    gauge.bridge = read_bridge(table);
  } else {
    refuse_bridge_keys_alone(table, gauge.unit == "strain");
    if (table.has("gauge_factor_per_strain")) {
      throw table.error("gauge_factor_per_strain",
                        "bends volts, and this gauge is in strain already",
                        "give unit = \"V\" and the bridge, or remove it");
    }
    if (gauge.unit == "strain") {
      gauge.strain_gain.sd = read_gain_sd(table);
    }
  }
  return gauge;
}

Specimen read_specimen(const TomlTable& table) {
  table.expect({"length_m", "diameter_m", "density_kg_m3", "poisson_ratio"});
  Specimen specimen;
  specimen.length_m = table.measured("length_m");
  specimen.diameter_m = table.measured("diameter_m");
  specimen.density_kg_m3 = table.optional_measured("density_kg_m3");
  specimen.poisson_ratio = table.optional_measured("poisson_ratio");
  return specimen;
}

Ball read_ball(const TomlTable& table) {
  table.expect({"outer_diameter_m", "core_diameter_m", "mass_kg", "scale_density"});
  Ball ball;
  ball.outer_diameter_m = table.measured("outer_diameter_m");
  ball.core_diameter_m = table.measured("core_diameter_m");
  ball.mass_kg = table.optional_measured("mass_kg");
  ball.scale_density = table.optional_flag("scale_density").value_or(false);
  return ball;
}

PhotoSensor read_photo_sensor(const TomlTable& table) {
  table.expect({"name", "distance_m"});
  return {table.text("name"), table.measured("distance_m")};
}

Striker read_striker(const TomlTable& table) {
  table.expect({"length_m", "diameter_m", "density_kg_m3", "youngs_modulus_Pa", "speed_m_per_s"});
  Striker striker;
  striker.length_m = table.optional_measured("length_m");
  striker.diameter_m = table.optional_measured("diameter_m");
  striker.density_kg_m3 = table.optional_measured("density_kg_m3");
  striker.youngs_modulus_Pa = table.optional_measured("youngs_modulus_Pa");
  striker.speed_m_per_s = table.optional_measured("speed_m_per_s");
  return striker;
}

template <typename Part>
std::optional<Part> read_part(const TomlTable& table, const std::string& key,
                              Part (*read)(const TomlTable&)) {
  const std::optional<TomlTable> part = table.optional_table(key);
  return part ? std::optional(read(*part)) : std::nullopt;
}

Bench read_all(const TomlTable& table) {
  constexpr std::array kKinds{BenchKind::bar, BenchKind::shpb, BenchKind::impact};
  constexpr std::array kSenses{PositiveSense::compression, PositiveSense::tension};
  table.expect({"kind", "sampling_frequency_Hz", "positive", "bars", "gauges", "specimen", "ball",
                "photo_sensors", "striker", "temperature_K", "loading"});
  Bench bench;
  bench.kind = kKinds.at(table.choice("kind", {"bar", "shpb", "impact"}));
  bench.sampling_frequency_Hz = table.measured("sampling_frequency_Hz");
  if (table.has("positive")) {
    bench.positive = kSenses.at(table.choice("positive", {"compression", "tension"}));
  }
  if (table.has("loading")) {
    bench.loading = kSenses.at(table.choice("loading", {"compression", "tension"}));
  }
  const TomlTable bars = table.table("bars");
  bars.expect({"input", "output"});
  refuse_far_end(bars.table("input"));
  bench.input = read_bar(bars.table("input"));
  bench.output = read_part(bars, "output", read_bar);
  for (const TomlTable& gauge : table.tables("gauges")) {
    bench.gauges.push_back(read_gauge(gauge));
  }
  bench.specimen = read_part(table, "specimen", read_specimen);
  bench.ball = read_part(table, "ball", read_ball);
  if (table.has("photo_sensors")) {
    for (const TomlTable& sensor : table.tables("photo_sensors")) {
      bench.photo_sensors.push_back(read_photo_sensor(sensor));
    }
  }
  bench.striker = read_part(table, "striker", read_striker);
  bench.temperature_K = table.optional_measured("temperature_K");
  return bench;
}

Bench read_checked(const TomlTable& table) {
  if (table.has("kolsky_model")) {
    throw table.error("kolsky_model", "makes this a model file, and a bench file is asked for",
                      "give the bench file that the captures were imported with");
  }
  Bench bench = read_all(table);
  table.finish();
  try {
    check(bench);
  } catch (const InputError& error) {
    throw table.located(error);
  }
  return bench;
}

}  // namespace

BenchFile read_bench(const std::filesystem::path& path) {
  const TomlTable table = TomlTable::open(path);
  return {read_checked(table), table.file_text()};
}

Bench parse_bench(const std::string& text, const std::string& name) {
  return read_checked(TomlTable::parse(text, name));
}

}  // namespace kolsky
