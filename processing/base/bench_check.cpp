#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/bench.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

constexpr Range kSamplingFrequency{20e3, 10e9, "Hz", "give hertz: 1 MHz is 1.0e6"};
constexpr Range kBarLength{0.02, 12.0, "m", "give metres: 700 mm is 0.7"};
constexpr Range kDiameter{0.5e-3, 0.3, "m", "give metres: 15 mm is 0.015"};
constexpr Range kYoungsModulus{1e8, 1.5e12, "Pa", "give pascals: 113 GPa is 113e9"};
constexpr Range kWaveSpeed{300.0, 20e3, "m/s", "check youngs_modulus_Pa against density_kg_m3"};
constexpr Range kGaugeLength{0.1e-3, 0.1, "m", "give metres: 5 mm is 0.005"};
constexpr Range kDelay{-20e-6, 20e-6, "s", "give seconds, late positive: 0.5 us is 0.5e-6"};
constexpr double kMostDelaySd_s = 10e-6;
constexpr Range kStrainPerVolt{1e-9, 1.0, "", "give strain per volt: 500 microstrain/V is 500e-6"};
constexpr Range kGaugeFactor{0.5, 300.0, "", "metal gauges have about 2, semiconductors about 150"};
constexpr Range kBeamDistance{1e-3, 20.0, "m", "give metres from the bar's face: 60 mm is 0.06"};
constexpr Range kExcitation{0.05, 100.0, "V", "give volts: 10000 mV is 10"};
constexpr Range kGain{1e-3, 1e6, "", "give the factor, not decibels: 40 dB is 100"};
constexpr Range kGaugeResistance{10.0, 20e3, "ohm", "give ohms: 0.35 kohm is 350"};
constexpr Range kLeadResistance{0.0, 100.0, "ohm", "give ohms of one wire"};
constexpr Range kShuntResistance{1e3, 1e8, "ohm", "give ohms: 100 kohm is 100e3"};
constexpr Range kShuntReading{1e-7, 100.0, "V", "give the step in volts: 500 mV is 0.5"};
constexpr Range kSpecimenLength{0.1e-3, 0.2, "m", "give metres: 4 mm is 0.004"};
constexpr Range kSpecimenDiameter{0.1e-3, 0.3, "m", "give metres: 12 mm is 0.012"};
constexpr Range kSpecimenPoisson{-1.0, 0.5, "", "give a ratio: 37.6 % is 0.376"};
constexpr Range kBallDiameter{1e-3, 0.3, "m", "give metres: 42.7 mm is 0.0427"};
constexpr Range kMass{1e-5, 5.0, "kg", "give kilograms: 45.6 g is 0.0456"};
constexpr Range kStrikerLength{1e-3, 5.0, "m", "give metres: 40 mm is 0.040"};
constexpr Range kSpeed{0.01, 500.0, "m/s", "give metres per second"};
constexpr Range kTemperature{60.0, 3000.0, "K", "give kelvin: 20 C is 293.15"};

// A deviation near the size of what it belongs to is no tolerance but a slip of unit.
void require_tolerance(const std::string& place, const Measured& number, double most) {
  if (number.sd > most) {
    throw InputError(
        place + "_sd",
        in_words(number.sd, "") + " is too large for a tolerance of " + in_words(number.value, ""),
        "give the standard deviation in the same unit as the number");
  }
}

void check_number(const std::string& place, const Measured& number, const Range& range) {
  require_in_range(place, number, range);
  require_tolerance(place, number, 0.5 * std::abs(number.value));
}

void check_number(const std::string& place, const std::optional<Measured>& number,
                  const Range& range) {
  if (number) {
    check_number(place, *number, range);
  }
}

void check_factor(const std::string& place, const Measured& number, const Range& range) {
  require_magnitude_in_range(place, number, range);
  require_tolerance(place, number, 0.5 * std::abs(number.value));
}

void check_section(const std::string& place, const Bar& bar) {
  if (bar.section == Section::round) {
    if (bar.side_m) {
      throw InputError(place + ".side_m", "is the side of a square bar, and this one is round",
                       "add section = \"square\" or remove it");
    }
    return;
  }
  if (!bar.side_m) {
    throw InputError(place + ".side_m", "is missing for a square bar", "give the side in metres");
  }
  check_number(place + ".side_m", *bar.side_m, kDiameter);
  const double equal_area_m = 2.0 * *bar.side_m / std::sqrt(std::numbers::pi);
  if (std::abs(bar.diameter_m - equal_area_m) > 0.005 * equal_area_m) {
    throw InputError(place + ".diameter_m",
                     in_words(bar.diameter_m, "m") + " is not the diameter of equal area, " +
                         in_words(equal_area_m, "m"),
                     "remove it: it follows from side_m");
  }
}

/// A material file's numbers, of this very bar.
void check_material(const std::string& place, const Bar& bar) {
  const Material& material = *bar.material;
  if (bar.youngs_modulus_Pa) {
    throw InputError(place, "is filed beside youngs_modulus_Pa: a bar is elastic or viscoelastic",
                     "remove one of the two");
  }
  try {
    check(material);
    require_density(material, bar, "density_kg_m3");
  } catch (const InputError& error) {
    throw InputError(place + "." + error.place(), error.problem(), error.mend());
  }
  require_passive(material, place);
}

void check_bar(const std::string& place, const Bar& bar) {
  check_number(place + ".length_m", bar.length_m, kBarLength);
  check_section(place, bar);
  check_number(place + ".diameter_m", bar.diameter_m, kDiameter);
  if (bar.length_m < 5.0 * bar.diameter_m) {
    throw InputError(
        place + ".diameter_m",
        in_words(bar.diameter_m, "m") + " is too thick for a bar of " + in_words(bar.length_m, "m"),
        "give both in metres; a bar is at least five diameters long");
  }
  check_number(place + ".density_kg_m3", bar.density_kg_m3, ranges::kDensity);
  require_in_range(place + ".poisson_ratio", bar.poisson_ratio, ranges::kPoissonRatio);
  if (bar.youngs_modulus_Pa) {
    const std::string modulus = place + ".youngs_modulus_Pa";
    check_number(modulus, *bar.youngs_modulus_Pa, kYoungsModulus);
    const double speed_m_per_s = std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
    if (speed_m_per_s < kWaveSpeed.least || speed_m_per_s > kWaveSpeed.most) {
      throw InputError(modulus, "makes waves of " + in_words(speed_m_per_s, "m/s"),
                       kWaveSpeed.mend);
    }
  }
  if (bar.material) {
    check_material(place + ".material", bar);
  }
}

void refuse_material_of_input(const Bar& input) {
  if (input.material) {
    throw InputError(
        "bars.input.material",
        "is for an output bar that is of another material than the bar model",
        "give the input bar's as the bar model (--bar-model, or bar_model of kolskyd)");
  }
}

void check_leads_and_shunt(const std::string& place, const Bridge& bridge) {
  require_in_range(place + ".lead_resistance_ohm", {bridge.lead_resistance_ohm, 0.0},
                   kLeadResistance);
  const bool has_shunt = bridge.shunt_resistance_ohm || bridge.shunt_reading_V;
  if (bridge.gauge_resistance_ohm == 0.0 && (has_shunt || bridge.lead_resistance_ohm > 0.0)) {
    throw InputError(place + ".gauge_resistance_ohm",
                     "is missing, and leads and shunts are reckoned against it",
                     "give the resistance of one gauge");
  }
  if (bridge.gauge_resistance_ohm != 0.0) {
    require_in_range(place + ".gauge_resistance_ohm", {bridge.gauge_resistance_ohm, 0.0},
                     kGaugeResistance);
  }
  if (!has_shunt) {
    return;
  }
  if (!bridge.shunt_resistance_ohm || !bridge.shunt_reading_V) {
    throw InputError(
        place + (bridge.shunt_resistance_ohm ? ".shunt_reading_V" : ".shunt_resistance_ohm"),
        "is missing from the shunt calibration", "give the resistance and the step it gave");
  }
  require_in_range(place + ".shunt_resistance_ohm", {*bridge.shunt_resistance_ohm, 0.0},
                   kShuntResistance);
  require_magnitude_in_range(place + ".shunt_reading_V", {*bridge.shunt_reading_V, 0.0},
                             kShuntReading);
}

// The gauge must go on answering to strain as far as a bar is strained.
void check_gauge_factor_growth(const std::string& place, const Bridge& bridge) {
  constexpr double kFurthestStrain = 3e-3;
  const Measured& growth = bridge.gauge_factor_per_strain;
  if (2.0 * std::abs(growth) * kFurthestStrain > std::abs(bridge.gauge_factor)) {
    throw InputError(place,
                     in_words(growth, "per strain") + " turns the gauge's answer round below " +
                         in_words(kFurthestStrain, "strain"),
                     "give dR/R = (gauge_factor + gauge_factor_per_strain e) e, strain as a ratio");
  }
  require_tolerance(place, growth, std::abs(bridge.gauge_factor) / kFurthestStrain);
}

// A bridge's factors have no sign: what its leads make of it belongs to the gauge.
void check_unsigned_factor(const std::string& place, const std::string& gauge,
                           const Measured& number, const Range& range) {
  if (number.value < 0.0) {
    throw InputError(place, in_words(number, "") + " is negative, of gauge " + gauge,
                     "give it without the sign, and inverted = true where the channel reads with "
                     "the other sign");
  }
  check_number(place, number, range);
}

void check_bridge(const std::string& place, const std::string& gauge, const Bridge& bridge) {
  check_unsigned_factor(place + ".gauge_factor", gauge, bridge.gauge_factor, kGaugeFactor);
  check_gauge_factor_growth(place + ".gauge_factor_per_strain", bridge);
  check_number(place + ".excitation_V", bridge.excitation_V, kExcitation);
  check_unsigned_factor(place + ".gain", gauge, bridge.gain, kGain);
  check_leads_and_shunt(place, bridge);
  if (bridge.lead_wires != 2 && bridge.lead_wires != 3) {
    throw InputError(place + ".lead_wires", std::to_string(bridge.lead_wires) + " is not known",
                     "give 2 (both wires in the arm) or 3 (one in each of two arms)");
  }
  if (bridge.gauges_in_series < 1 || bridge.gauges_in_series > 8) {
    throw InputError(place + ".gauges_in_series",
                     std::to_string(bridge.gauges_in_series) + " is outside 1 to 8",
                     "give 1, or 2 for a pair across the bar");
  }
}

void check_unit(const std::string& place, const Gauge& gauge) {
  if (gauge.unit != "strain" && gauge.unit != "V") {
    throw InputError(place + ".unit", "is \"" + gauge.unit + "\"", "give \"strain\" or \"V\"");
  }
  const bool converts = gauge.bridge || gauge.strain_per_V;
  if (gauge.unit == "strain" && converts) {
    throw InputError(place + (gauge.bridge ? ".bridge" : ".strain_per_V"),
                     "converts volts, and this gauge's unit is strain",
                     "give unit = \"V\" or remove it");
  }
  if (gauge.unit == "V" && !converts) {
    throw InputError(place + ".unit", "is \"V\", and nothing says what a volt means",
                     "give strain_per_V, or bridge with gauge_factor, excitation_V and gain");
  }
  if (gauge.bridge && gauge.strain_per_V) {
    throw InputError(place + ".strain_per_V", "is given beside a bridge", "keep one of them");
  }
}

void check_gauge_name(const std::string& place, const std::string& name) {
  // The names become columns of tables, objects of HDF5 files and parts of effect ids.
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F &&
           std::string_view("/,;:\"").find(c) == std::string_view::npos;
  });
  if (name.empty() || name.size() > 64 || !plain || name == "time_s" || name == ".") {
    throw InputError(place + ".name", "\"" + name + "\" cannot name a gauge",
                     "give 1 to 64 letters, digits, - or _");
  }
}

/// A free end has no strain at any time, and the struck one none but while it is pushed: a gauge
/// filed there is filed in a wrong place. How the end of a bar by itself is held no file says, and
/// of a ball the struck face has the whole push.
void refuse_at_free_end(const std::string& place, const Gauge& gauge, const Bar& bar,
                        BenchKind kind, const std::string& mend) {
  const bool at_far_end = gauge.position_m == bar.length_m.value;
  if (kind == BenchKind::impact && at_far_end) {
    throw InputError(place, "is at the bar's far end, which is free: there is no strain", mend);
  }
  if (kind != BenchKind::shpb) {
    return;
  }
  if (gauge.bar == "output" && at_far_end && bar.far_end == FarEnd::free) {
    throw InputError(place, "is at the bar's far end, which is free: there is no strain",
                     mend + ", or far_end = \"matched\" where another bar goes on");
  }
  if (gauge.bar == "input" && gauge.position_m == 0.0) {
    throw InputError(place, "is at the struck end, which is free but for the striker's push", mend);
  }
}

void check_position(const std::string& place, const Gauge& gauge, const Bench& bench) {
  const Bar& bar = bench.bar_of(gauge);
  const std::string where = gauge.bar == "output" ? "the specimen's end" : "the impacted end";
  const std::string mend = "give metres from " + where + ": 300 mm is 0.3";
  const Range on_the_bar{0.0, bar.length_m, "m", "give metres from the end of the bar"};
  if (!(gauge.position_m >= on_the_bar.least && gauge.position_m <= on_the_bar.most)) {
    throw InputError(
        place + ".position_m",
        in_words(gauge.position_m, "m") + " is not on the " + in_words(bar.length_m, "m") + " bar",
        mend);
  }
  require_in_range(place + ".position_m", gauge.position_m, on_the_bar);
  const double face_m = gauge.bar == "output" ? 0.0 : bar.length_m.value;
  if (bench.output && gauge.position_m == face_m) {
    throw InputError(place + ".position_m",
                     "is at the specimen's face, where waves to and fro are one", mend);
  }
  refuse_at_free_end(place + ".position_m", gauge, bar, bench.kind, mend);
  require_tolerance(place + ".position_m", gauge.position_m, 0.1 * bar.length_m);
}

void check_gauge(const std::string& place, const Gauge& gauge, const Bench& bench) {
  check_gauge_name(place, gauge.name);
  if (gauge.bar != "input" && gauge.bar != "output") {
    throw InputError(place + ".bar", "is \"" + gauge.bar + "\"", "give \"input\" or \"output\"");
  }
  if (gauge.bar == "output" && !bench.output) {
    throw InputError(place + ".bar", "is \"output\", and this bench has no output bar",
                     "give \"input\"");
  }
  check_position(place, gauge, bench);
  check_number(place + ".length_m", gauge.length_m, kGaugeLength);
  require_in_range(place + ".delay_s", gauge.delay_s, kDelay);
  require_tolerance(place + ".delay_s", gauge.delay_s, kMostDelaySd_s);
  check_unit(place, gauge);
  if (gauge.strain_gain.sd > 0.1) {
    throw InputError(place + ".gauge_factor_sd",
                     "makes a strain uncertain by " + in_words(100.0 * gauge.strain_gain.sd, "%"),
                     "give the standard deviation in the same unit as the number");
  }
  if (gauge.bridge) {
    check_bridge(place, gauge.name, *gauge.bridge);
  }
  if (gauge.strain_per_V) {
    check_factor(place + ".strain_per_V", *gauge.strain_per_V, kStrainPerVolt);
  }
}

void check_gauges(const Bench& bench) {
  std::set<std::string> names;
  std::set<std::string> bars;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    const std::string place = "gauges[" + std::to_string(i) + "]";
    check_gauge(place, gauge, bench);
    if (!names.insert(gauge.name).second) {
      throw InputError(place + ".name", "\"" + gauge.name + "\" names an earlier gauge too",
                       "give each gauge its own name");
    }
    bars.insert(gauge.bar);
  }
  for (const char* const bar : {"input", "output"}) {
    const bool needed = bar == std::string("input") || bench.output;
    if (needed && !bars.contains(bar)) {
      throw InputError("gauges", std::string("has none on the ") + bar + " bar",
                       std::string("add [[gauges]] with bar = \"") + bar + "\"");
    }
  }
}

void check_specimen(const Specimen& specimen, const Bench& bench) {
  check_number("specimen.length_m", specimen.length_m, kSpecimenLength);
  check_number("specimen.diameter_m", specimen.diameter_m, kSpecimenDiameter);
  const double thinner_m = std::min<double>(bench.input.diameter_m, bench.output->diameter_m);
  if (specimen.diameter_m > 1.1 * thinner_m) {
    throw InputError("specimen.diameter_m",
                     in_words(specimen.diameter_m, "m") + " is wider than the bars",
                     "give metres; a specimen does not overhang");
  }
  check_number("specimen.density_kg_m3", specimen.density_kg_m3, ranges::kDensity);
  if (specimen.poisson_ratio) {
    require_in_range("specimen.poisson_ratio", *specimen.poisson_ratio, kSpecimenPoisson);
  }
}

void check_ball(const Ball& ball) {
  check_number("ball.outer_diameter_m", ball.outer_diameter_m, kBallDiameter);
  check_number("ball.core_diameter_m", ball.core_diameter_m, kBallDiameter);
  if (ball.core_diameter_m >= ball.outer_diameter_m) {
    throw InputError("ball.core_diameter_m",
                     in_words(ball.core_diameter_m, "m") + " does not fit inside the ball of " +
                         in_words(ball.outer_diameter_m, "m"),
                     "give the diameter of what the cover surrounds");
  }
  check_number("ball.mass_kg", ball.mass_kg, kMass);
}

std::string name_of(BenchKind kind) {
  return kind == BenchKind::bar ? "bar" : kind == BenchKind::shpb ? "shpb" : "impact";
}

// Two beams measure a speed by their distance, one by the ball's diameter; a ball must be through
// the nearest before it touches.
void check_photo_sensors(const Bench& bench) {
  const std::vector<PhotoSensor>& sensors = bench.photo_sensors;
  if (bench.kind != BenchKind::impact) {
    throw InputError("photo_sensors", "do not belong to kind = \"" + name_of(bench.kind) + "\"",
                     "remove them, or give kind = \"impact\"");
  }
  if (sensors.size() > 2) {
    throw InputError("photo_sensors[2]", "is one too many", "keep the two that measure the speed");
  }
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const std::string place = "photo_sensors[" + std::to_string(i) + "]";
    check_gauge_name(place, sensors[i].name);
    for (std::size_t earlier = 0; earlier < bench.gauges.size() + i; ++earlier) {
      if (bench.channels()[earlier].name == sensors[i].name) {
        throw InputError(place + ".name", "\"" + sensors[i].name + "\" names another channel too",
                         "give each channel its own name");
      }
    }
    check_number(place + ".distance_m", sensors[i].distance_m, kBeamDistance);
    if (bench.ball && sensors[i].distance_m <= bench.ball->outer_diameter_m) {
      throw InputError(place + ".distance_m",
                       in_words(sensors[i].distance_m, "m") +
                           " from the face: the ball is still in the beam when it touches",
                       "put the beam further off than the ball's diameter");
    }
  }
  if (sensors.size() == 2) {
    const double apart_m = std::abs(sensors[0].distance_m - sensors[1].distance_m);
    const double sd_m = std::hypot(sensors[0].distance_m.sd, sensors[1].distance_m.sd);
    if (apart_m < std::max(1e-3, 5.0 * sd_m)) {
      throw InputError(
          "photo_sensors[1].distance_m",
          "is " + in_words(apart_m, "m") + " from the other beam's: no measure of speed",
          "give both distances from the bar's face, or one photo-sensor alone");
    }
  }
}

void check_striker(const Striker& striker) {
  check_number("striker.length_m", striker.length_m, kStrikerLength);
  check_number("striker.diameter_m", striker.diameter_m, kDiameter);
  check_number("striker.density_kg_m3", striker.density_kg_m3, ranges::kDensity);
  check_number("striker.speed_m_per_s", striker.speed_m_per_s, kSpeed);
  check_number("striker.youngs_modulus_Pa", striker.youngs_modulus_Pa, kYoungsModulus);
  if (striker.youngs_modulus_Pa && !striker.density_kg_m3) {
    throw InputError("striker.youngs_modulus_Pa", "is filed without the striker's density",
                     "file striker.density_kg_m3, too");
  }
}

// A part is there exactly if the kind has one.
void require_part(const Bench& bench, const std::string& part, bool there, BenchKind kind) {
  const bool wanted = bench.kind == kind;
  if (there && !wanted) {
    throw InputError(part, "does not belong to kind = \"" + name_of(bench.kind) + "\"",
                     "remove it, or give kind = \"" + name_of(kind) + "\"");
  }
  if (wanted && !there) {
    throw InputError(part, "is missing for kind = \"" + name_of(bench.kind) + "\"",
                     "add [" + part + "]");
  }
}

}  // namespace

void check(const Bench& bench) {
  check_number("sampling_frequency_Hz", bench.sampling_frequency_Hz, kSamplingFrequency);
  require_part(bench, "bars.output", bench.output.has_value(), BenchKind::shpb);
  require_part(bench, "specimen", bench.specimen.has_value(), BenchKind::shpb);
  require_part(bench, "ball", bench.ball.has_value(), BenchKind::impact);
  refuse_material_of_input(bench.input);
  check_bar("bars.input", bench.input);
  if (bench.output) {
    check_bar("bars.output", *bench.output);
  }
  check_gauges(bench);
  if (bench.specimen) {
    check_specimen(*bench.specimen, bench);
  }
  if (bench.ball) {
    check_ball(*bench.ball);
  }
  if (!bench.photo_sensors.empty()) {
    check_photo_sensors(bench);
  }
  if (bench.striker) {
    check_striker(*bench.striker);
  }
  check_number("temperature_K", bench.temperature_K, kTemperature);
}

}  // namespace kolsky
