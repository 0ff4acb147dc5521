#include "drivers/files/settings/bench_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/refusal.hpp"

namespace kolsky {
namespace {

using testing::refusal_of;
using testing::ScratchFolder;

// Line numbers below count in this text.
constexpr const char* kShpb = R"(kind = "shpb"
sampling_frequency_Hz = 1000000
positive = "tension"
temperature_K = 293.15
[bars.input]
length_m = 0.7
diameter_m = 0.015
density_kg_m3 = 1180
poisson_ratio = 0.36
[bars.output]
length_m = 0.8
diameter_m = 0.016
density_kg_m3 = 7800
poisson_ratio = 0.29
youngs_modulus_Pa = 210e9
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.4
position_m_sd = 0.001
unit = "V"
length_m = 0.002
bridge = "quarter"
gauge_factor = 2.1
gauge_factor_sd = 0.02
excitation_V = 5
gain = 500
[[gauges]]
name = "g2"
bar = "output"
position_m = 0.05
unit = "V"
strain_per_V = 5.01e-4
[specimen]
length_m = 0.004
diameter_m = 0.012
density_kg_m3 = 1140
poisson_ratio = 0.376
[striker]
length_m = 0.04
diameter_m = 0.01
density_kg_m3 = 1180
speed_m_per_s = 12
)";

constexpr const char* kImpact = R"(kind = "impact"
sampling_frequency_Hz = 1.0e6
[bars.input]
length_m = 2.0
diameter_m = 0.02
density_kg_m3 = 1180
poisson_ratio = 0.36
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.1
unit = "strain"
[ball]
outer_diameter_m = 0.0427
core_diameter_m = 0.037
mass_kg = 0.0456
scale_density = true
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST(BenchFile, ReadsEveryKeyOfASplitBar) {
  const Bench bench = parse_bench(kShpb, "b.toml");
  EXPECT_EQ(bench.kind, BenchKind::shpb);
  EXPECT_EQ(bench.sampling_frequency_Hz, 1e6);
  EXPECT_EQ(bench.positive, PositiveSense::tension);
  EXPECT_EQ(bench.temperature_K->value, 293.15);
  EXPECT_EQ(bench.input.length_m, 0.7);
  EXPECT_EQ(bench.input.diameter_m, 0.015);
  EXPECT_EQ(bench.input.density_kg_m3, 1180.0);
  EXPECT_EQ(bench.input.poisson_ratio, 0.36);
  EXPECT_FALSE(bench.input.youngs_modulus_Pa.has_value());
  EXPECT_EQ(bench.output->length_m, 0.8);
  EXPECT_EQ(bench.output->youngs_modulus_Pa->value, 210e9);
  ASSERT_EQ(bench.gauges.size(), 2U);
  const Gauge& first = bench.gauges[0];
  EXPECT_EQ(first.name, "g1");
  EXPECT_EQ(first.bar, "input");
  EXPECT_EQ(first.position_m.value, 0.4);
  EXPECT_EQ(first.position_m.sd, 0.001);
  EXPECT_EQ(first.unit, "V");
  EXPECT_EQ(first.length_m->value, 0.002);
  ASSERT_TRUE(first.bridge.has_value());
  EXPECT_EQ(first.bridge->wiring, BridgeWiring::quarter);
  EXPECT_EQ(first.bridge->gauge_factor.value, 2.1);
  EXPECT_EQ(first.bridge->gauge_factor.sd, 0.02);
  EXPECT_EQ(first.bridge->excitation_V, 5.0);
  EXPECT_EQ(first.bridge->gain, 500.0);
  EXPECT_EQ(first.bridge->lead_wires, 2);
  EXPECT_EQ(first.bridge->gauges_in_series, 1);
  EXPECT_FALSE(bench.gauges[1].bridge.has_value());
  EXPECT_EQ(bench.gauges[1].strain_per_V->value, 5.01e-4);
  EXPECT_EQ(bench.specimen->length_m, 0.004);
  EXPECT_EQ(bench.specimen->diameter_m, 0.012);
  EXPECT_EQ(bench.specimen->density_kg_m3->value, 1140.0);
  EXPECT_EQ(bench.specimen->poisson_ratio->value, 0.376);
  EXPECT_EQ(bench.striker->length_m->value, 0.04);
  EXPECT_EQ(bench.striker->speed_m_per_s->value, 12.0);
}

TEST(BenchFile, ReadsABallOnABar) {
  const Bench bench = parse_bench(kImpact, "b.toml");
  EXPECT_EQ(bench.kind, BenchKind::impact);
  EXPECT_EQ(bench.positive, PositiveSense::compression);
  EXPECT_EQ(bench.ball->outer_diameter_m, 0.0427);
  EXPECT_EQ(bench.ball->core_diameter_m, 0.037);
  EXPECT_EQ(bench.ball->mass_kg->value, 0.0456);
  EXPECT_TRUE(bench.ball->scale_density);
  EXPECT_FALSE(bench.output.has_value());
}

constexpr const char* kBeams =
    "[[photo_sensors]]\nname = \"p1\"\ndistance_m = 0.09\ndistance_m_sd = 1e-4\n"
    "[[photo_sensors]]\nname = \"p2\"\ndistance_m = 0.06\n";

TEST(BenchFile, ReadsPhotoSensorsAsChannelsBehindTheGauges) {
  const Bench bench = parse_bench(std::string(kImpact) + kBeams, "b.toml");
  ASSERT_EQ(bench.photo_sensors.size(), 2U);
  EXPECT_EQ(bench.photo_sensors[0].name, "p1");
  EXPECT_EQ(bench.photo_sensors[0].distance_m.value, 0.09);
  EXPECT_EQ(bench.photo_sensors[0].distance_m.sd, 1e-4);
  const std::vector<BenchChannel> channels = bench.channels();
  ASSERT_EQ(channels.size(), 3U);
  EXPECT_EQ(channels[0].unit, "strain");
  EXPECT_EQ(channels[2].name, "p2");
  EXPECT_EQ(channels[2].unit, "V");
}

TEST(BenchFile, RefusesPhotoSensorsThatMeasureNothing) {
  const auto refusal = [](const std::string& beams) {
    return refusal_of([&] { (void)parse_bench(std::string(kImpact) + beams, "b.toml"); });
  };
  EXPECT_NE(refusal(replaced(kBeams, "0.06", "0.04")).find("still in the beam"), std::string::npos);
  EXPECT_NE(refusal(replaced(kBeams, "0.06", "0.0899")).find("photo_sensors[1].distance_m"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(kBeams, "\"p2\"", "\"g1\"")).find("names another channel"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(kBeams, "distance_m = 0.06", "distance = 0.06")).find("distance"),
            std::string::npos);
  EXPECT_NE(refusal(std::string(kBeams) + "[[photo_sensors]]\nname = \"p3\"\ndistance_m = 0.2\n")
                .find("one too many"),
            std::string::npos);
  EXPECT_NE(refusal_of([] {
              (void)parse_bench(std::string(kShpb) + kBeams, "b.toml");
            }).find("do not belong to kind = \"shpb\""),
            std::string::npos);
}

TEST(BenchFile, ReadsHowAGaugeFactorGrows) {
  const Bench bench = parse_bench(replaced(kShpb, "gauge_factor = 2.1",
                                           "gauge_factor = 2.1\ngauge_factor_per_strain = 30\n"
                                           "gauge_factor_per_strain_sd = 3"),
                                  "b.toml");
  EXPECT_EQ(bench.gauges[0].bridge->gauge_factor_per_strain.value, 30.0);
  EXPECT_EQ(bench.gauges[0].bridge->gauge_factor_per_strain.sd, 3.0);
  EXPECT_NE(refusal_of([] {
              (void)parse_bench(replaced(kShpb, "gauge_factor = 2.1",
                                         "gauge_factor = 2.1\ngauge_factor_per_strain = 4000"),
                                "b.toml");
            }).find("turns the gauge's answer round"),
            std::string::npos);
  EXPECT_NE(refusal_of([] {
              (void)parse_bench(replaced(kImpact, "unit = \"strain\"",
                                         "unit = \"strain\"\ngauge_factor_per_strain = 4000"),
                                "b.toml");
            }).find("in strain already"),
            std::string::npos);
}

TEST(BenchFile, TakesAChannelsDelayOrItsDeviationAlone) {
  const auto with = [](const std::string& lines) {
    return replaced(kShpb, "strain_per_V = 5.01e-4", "strain_per_V = 5.01e-4\n" + lines);
  };
  const auto refusal = [&](const std::string& lines) {
    return refusal_of([&] { (void)parse_bench(with(lines), "b.toml"); });
  };
  const Bench late = parse_bench(with("delay_s = 1.5e-6\ndelay_s_sd = 2e-7"), "b.toml");
  EXPECT_EQ(late.gauges[0].delay_s.value, 0.0);
  EXPECT_EQ(late.gauges[1].delay_s.value, 1.5e-6);
  EXPECT_EQ(late.gauges[1].delay_s.sd, 2e-7);
  const Bench doubtful = parse_bench(with("delay_s_sd = 2e-7"), "b.toml");
  EXPECT_EQ(doubtful.gauges[1].delay_s.value, 0.0);
  EXPECT_EQ(doubtful.gauges[1].delay_s.sd, 2e-7);
  EXPECT_NE(refusal("delay_s = 1.5").find("0.5 us is 0.5e-6"), std::string::npos);
  EXPECT_NE(refusal("delay_s_sd = -1e-6").find("gauges[1].delay_s_sd"), std::string::npos);
  EXPECT_NE(refusal("delay_s_sd = 0.2").find("gauges[1].delay_s_sd"), std::string::npos);
}

TEST(BenchFile, ReadsLeadsSeriesAndShunt) {
  const Bench bench = parse_bench(
      replaced(kShpb, "gain = 500",
               "gauge_resistance_ohm = 350\nlead_resistance_ohm = 0.5\nlead_wires = 3\n"
               "gauges_in_series = 2\nshunt_resistance_ohm = 100e3\nshunt_reading_V = -1.25\n"
               "shunt_resistance_ohm_sd = 3e3\nshunt_reading_V_sd = 0.05"),
      "b.toml");
  const Bridge& bridge = *bench.gauges[0].bridge;
  EXPECT_EQ(bridge.gauge_resistance_ohm, 350.0);
  EXPECT_EQ(bridge.lead_resistance_ohm, 0.5);
  EXPECT_EQ(bridge.lead_wires, 3);
  EXPECT_EQ(bridge.gauges_in_series, 2);
  EXPECT_EQ(*bridge.shunt_resistance_ohm, 100e3);
  EXPECT_EQ(*bridge.shunt_reading_V, -1.25);
  EXPECT_NEAR(bridge.shunt_gain.sd, 0.05, 1e-12);
}

TEST(BenchFile, KnowsTheBridges) {
  const auto wiring = [](const std::string& name) {
    return parse_bench(replaced(kShpb, "\"quarter\"", "\"" + name + "\""), "b.toml")
        .gauges[0]
        .bridge->wiring;
  };
  EXPECT_EQ(wiring("half"), BridgeWiring::half);
  EXPECT_EQ(wiring("half-poisson"), BridgeWiring::half_poisson);
  EXPECT_EQ(wiring("full-poisson"), BridgeWiring::full_poisson);
  EXPECT_EQ(wiring("full"), BridgeWiring::full_poisson);
}

TEST(BenchFile, SquareBarsHaveTheDiameterOfEqualArea) {
  const std::string square = replaced(kShpb, "diameter_m = 0.015",
                                      "section = \"square\"\nside_m = 0.014\nside_m_sd = 1e-5");
  const Bench bench = parse_bench(square, "b.toml");
  EXPECT_EQ(bench.input.section, Section::square);
  EXPECT_NEAR(bench.input.area_m2(), 0.014 * 0.014, 1e-12);
  EXPECT_NEAR(bench.input.diameter_m.sd / bench.input.diameter_m.value, 1e-5 / 0.014, 1e-12);
  EXPECT_NEAR(bench.input.dispersion_radius_m(), 0.007 / std::sqrt(3.0), 1e-12);
  // 14 mm square has the area of 15.797 mm round.
  EXPECT_EQ(parse_bench(replaced(square, "side_m = 0.014", "side_m = 0.014\ndiameter_m = 0.0158"),
                        "b.toml")
                .input.diameter_m.value,
            0.0158);
  EXPECT_TRUE(refusal_of([&] {
                (void)parse_bench(
                    replaced(square, "side_m = 0.014", "side_m = 0.014\ndiameter_m = 0.0160"),
                    "b.toml");
              }).starts_with("b.toml:9: bars.input.diameter_m: "));
}

TEST(BenchFile, EveryNumberMayHaveADeviation) {
  std::string text;
  for (const std::string source : {kShpb, kImpact}) {
    text = replaced(source, "sampling_frequency_Hz = ",
                    "sampling_frequency_Hz_sd = 1.0\nsampling_frequency_Hz = ");
    for (const char* const key :
         {"temperature_K", "length_m", "diameter_m", "density_kg_m3", "poisson_ratio",
          "youngs_modulus_Pa", "excitation_V", "gain", "strain_per_V", "speed_m_per_s",
          "outer_diameter_m", "core_diameter_m", "mass_kg"}) {
      const std::string line = std::string("\n") + key + " = ";
      if (text.find(line) != std::string::npos) {
        text = replaced(text, line, std::string("\n") + key + "_sd = 1e-9" + line);
      }
    }
    EXPECT_NO_THROW((void)parse_bench(text, "b.toml")) << text;
  }
}

/// The bench with a viscoelastic output bar of its own material.
std::string with_own_material(const std::string& table) {
  std::string text = kShpb;
  const std::string modulus = "youngs_modulus_Pa = 210e9\n";
  text.replace(text.find("7800"), 4, "1180");
  text.replace(text.find(modulus), modulus.size(), table);
  return text;
}

const std::string kOwnMaterial =
    "[bars.output.material]\ndensity_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.2e9\n"
    "E2_Pa = 30e9\neta2_Pa_s = 2e6\n";

TEST(BenchFile, AnOutputBarMayHaveAMaterialOfItsOwn) {
  const Bench bench = parse_bench(
      with_own_material(kOwnMaterial +
                        "covariance = [1e12, 0, 0, 0, 1e16, 0, 0, 0, 1e6]\n"
                        "[bars.output.material.identified]\nband_limit_Hz = 20e3\nshots = 4\n"),
      "b.toml");
  EXPECT_FALSE(bench.input.material);
  EXPECT_TRUE(bench.input.takes_bar_model());
  ASSERT_TRUE(bench.output->material);
  EXPECT_FALSE(bench.output->takes_bar_model());
  EXPECT_EQ(bench.output->material->E1_Pa().value, 5.2e9);
  EXPECT_EQ(bench.output->material->covariance->at(4), 1e16);
  EXPECT_EQ(bench.output->material->identified->band_limit_Hz, 20e3);
}

TEST(BenchFile, RefusesAMaterialThatIsNotThatBars) {
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { (void)parse_bench(text, "b.toml"); });
  };
  const auto holds = [](const std::string& said, const std::string& words) {
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  holds(refusal(with_own_material("youngs_modulus_Pa = 5e9\n" + kOwnMaterial)),
        "bars.output.material: is filed beside youngs_modulus_Pa");
  std::string other = kOwnMaterial;
  other.replace(other.find("1180"), 4, "1240");
  holds(refusal(with_own_material(other)),
        "bars.output.material.density_kg_m3: is of bars of 1240");
  holds(refusal(with_own_material(kOwnMaterial +
                                  "[bars.output.material.identified]\npassive = false\n")),
        "identified.passive: is false");
  std::string unknown = kOwnMaterial;
  unknown.replace(unknown.find("eta2"), 4, "eta4");
  holds(refusal(with_own_material(unknown)), "bars.output.material.eta4_Pa_s");
  std::string on_input = kShpb;
  std::string table = kOwnMaterial;
  table.replace(table.find("output"), 6, "input");
  on_input.insert(on_input.find("[bars.output]"), table);
  holds(refusal(on_input), "bars.input.material: is for an output bar");
}

TEST(BenchFile, KeepsTheTextItWasReadFrom) {
  const ScratchFolder folder;
  const std::string text = std::string("# a remark\n") + kShpb;
  const BenchFile file = read_bench(folder.write("b.toml", text));
  EXPECT_EQ(file.text, text);
  EXPECT_EQ(file.bench.gauges.size(), 2U);
}

struct BenchRefusal {
  const char* what;
  const char* with;
  const char* place;  ///< line and key
  const char* mend;   ///< words that must be there
};

class ShpbRefusals : public ::testing::TestWithParam<BenchRefusal> {};
class ImpactRefusals : public ::testing::TestWithParam<BenchRefusal> {};

void expect_refusal(const std::string& text, const BenchRefusal& expected) {
  const std::string changed = replaced(text, expected.what, expected.with);
  const std::string line = refusal_of([&] { (void)parse_bench(changed, "b.toml"); });
  EXPECT_TRUE(line.starts_with("b.toml:" + std::string(expected.place) + ": ")) << line;
  EXPECT_NE(line.find(expected.mend), std::string::npos) << line;
}

TEST_P(ShpbRefusals, NamesTheLineTheKeyAndTheMend) {
  expect_refusal(kShpb, GetParam());
}

TEST_P(ImpactRefusals, NamesTheLineTheKeyAndTheMend) {
  expect_refusal(kImpact, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    UnitMistakes, ShpbRefusals,
    ::testing::Values(
        BenchRefusal{"= 1000000", "= 1", "2: sampling_frequency_Hz", "give hertz"},
        BenchRefusal{"= 1000000", "= 1000", "2: sampling_frequency_Hz", "give hertz"},
        BenchRefusal{"293.15", "20", "4: temperature_K", "kelvin"},
        BenchRefusal{"length_m = 0.7", "length_m = 15", "6: bars.input.length_m", "give metres"},
        BenchRefusal{"length_m = 0.7", "length_m = 700", "6: bars.input.length_m", "give metres"},
        BenchRefusal{"length_m = 0.7", "length_m = -0.7", "6: bars.input.length_m", "metres"},
        BenchRefusal{"length_m = 0.7", "length_m = 0", "6: bars.input.length_m", "metres"},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 15", "7: bars.input.diameter_m",
                     "15 mm is 0.015"},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 1.5", "7: bars.input.diameter_m",
                     "give metres"},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 0.2", "7: bars.input.diameter_m",
                     "five diameters"},
        BenchRefusal{"= 1180\n", "= 1.18\n", "8: bars.input.density_kg_m3", "kg/m3"},
        BenchRefusal{"= 1180\n", "= 1180000\n", "8: bars.input.density_kg_m3", "kg/m3"},
        BenchRefusal{"= 0.36\n", "= 36\n", "9: bars.input.poisson_ratio", "0.36"},
        BenchRefusal{"= 0.36\n", "= 0.5001\n", "9: bars.input.poisson_ratio", "ratio"},
        BenchRefusal{"210e9", "210", "15: bars.output.youngs_modulus_Pa", "pascals"},
        BenchRefusal{"210e9", "210e3", "15: bars.output.youngs_modulus_Pa", "pascals"},
        BenchRefusal{"= 7800", "= 78", "15: bars.output.youngs_modulus_Pa", "density_kg_m3"},
        BenchRefusal{"position_m = 0.4", "position_m = 300", "19: gauges[0].position_m",
                     "300 mm is 0.3"},
        BenchRefusal{"position_m = 0.4", "position_m = 0.71", "19: gauges[0].position_m",
                     "impacted end"},
        BenchRefusal{"position_m = 0.4", "position_m = -0.1", "19: gauges[0].position_m", "end"},
        BenchRefusal{"position_m = 0.05", "position_m = 50", "31: gauges[1].position_m",
                     "specimen's end"},
        BenchRefusal{"position_m_sd = 0.001", "position_m_sd = 1", "20: gauges[0].position_m_sd",
                     "same unit"},
        BenchRefusal{"length_m = 0.002", "length_m = 2", "22: gauges[0].length_m", "give metres"},
        BenchRefusal{"gauge_factor = 2.1", "gauge_factor = 0", "24: gauges[0].gauge_factor",
                     "about 2"},
        BenchRefusal{"gauge_factor_sd = 0.02", "gauge_factor_sd = 2",
                     "25: gauges[0].gauge_factor_sd", "same unit"},
        BenchRefusal{"excitation_V = 5", "excitation_V = 10000", "26: gauges[0].excitation_V",
                     "give volts"},
        BenchRefusal{"gain = 500", "gain = 0", "27: gauges[0].gain", "factor"},
        BenchRefusal{"gain = 500", "gain = -500", "27: gauges[0].gain", "inverted = true"},
        BenchRefusal{"gauge_factor = 2.1", "gauge_factor = -2.1", "24: gauges[0].gauge_factor",
                     "inverted = true"},
        BenchRefusal{"gain = 500", "gain = 500\ninverted = 1", "28: gauges[0].inverted", ""},
        BenchRefusal{"5.01e-4", "501", "33: gauges[1].strain_per_V", "strain per volt"},
        BenchRefusal{"5.01e-4", "0", "33: gauges[1].strain_per_V", "strain per volt"},
        BenchRefusal{"length_m = 0.004", "length_m = 4", "35: specimen.length_m", "0.004"},
        BenchRefusal{"diameter_m = 0.012", "diameter_m = 12", "36: specimen.diameter_m", "0.012"},
        BenchRefusal{"diameter_m = 0.012", "diameter_m = 0.12", "36: specimen.diameter_m",
                     "overhang"},
        BenchRefusal{"= 1140", "= 1.14", "37: specimen.density_kg_m3", "kg/m3"},
        BenchRefusal{"0.376", "37.6", "38: specimen.poisson_ratio", "ratio"},
        BenchRefusal{"length_m = 0.04\n", "length_m = 40\n", "40: striker.length_m", "metres"},
        BenchRefusal{"speed_m_per_s = 12", "speed_m_per_s = 12000", "43: striker.speed_m_per_s",
                     "metres per second"}));

INSTANTIATE_TEST_SUITE_P(
    Form, ShpbRefusals,
    ::testing::Values(
        BenchRefusal{"kind = \"shpb\"", "kind = \"kolsky\"", "1: kind",
                     R"(one of "bar", "shpb", "impact")"},
        BenchRefusal{"\"tension\"", "\"compressive\"", "3: positive",
                     R"(one of "compression", "tension")"},
        BenchRefusal{"positive", "postive", "3: postive", "did you mean \"positive\"?"},
        BenchRefusal{"length_m = 0.7", "lenght_m = 0.7", "6: bars.input.lenght_m",
                     "did you mean \"length_m\"?"},
        BenchRefusal{"length_m = 0.7", "length_mm = 700", "6: bars.input.length_mm",
                     "did you mean \"length_m\"?"},
        BenchRefusal{"length_m = 0.7\n", "", "5: bars.input.length_m", "add it"},
        BenchRefusal{"length_m = 0.7", "length_m = \"0.7\"", "6: bars.input.length_m",
                     "give a number"},
        BenchRefusal{"[bars.output]", "[bars.ouput]", "10: bars.ouput", "did you mean \"output\"?"},
        BenchRefusal{"position_m_sd", "positon_m_sd", "20: gauges[0].positon_m_sd",
                     "did you mean \"position_m\"?"},
        BenchRefusal{"name = \"g1\"", "name = \"\"", "17: gauges[0].name", "letters"},
        BenchRefusal{"name = \"g1\"", "name = \"a/b\"", "17: gauges[0].name", "letters"},
        BenchRefusal{"name = \"g1\"", "name = \"time_s\"", "17: gauges[0].name", "letters"},
        BenchRefusal{"name = \"g2\"", "name = \"g1\"", "29: gauges[1].name", "its own name"},
        BenchRefusal{"bar = \"input\"", "bar = \"incident\"", "18: gauges[0].bar",
                     "\"input\" or \"output\""},
        BenchRefusal{"unit = \"V\"", "unit = \"mV\"", "21: gauges[0].unit", "\"strain\" or \"V\""},
        BenchRefusal{"unit = \"V\"\nstrain_per_V = 5.01e-4",
                     "unit = \"mV\"\ngauge_factor_sd = 0.01", "32: gauges[1].unit",
                     "\"strain\" or \"V\""},
        BenchRefusal{"unit = \"V\"\nstrain_per_V = 5.01e-4", "unit = \"V\"\ngauge_factor_sd = 0.01",
                     "33: gauges[1].gauge_factor_sd", "add bridge = \"quarter\""},
        BenchRefusal{"unit = \"V\"", "unit = \"strain\"", "23: gauges[0].bridge", "unit = \"V\""},
        BenchRefusal{"unit = \"V\"\nstrain_per_V = 5.01e-4", "unit = \"V\"", "32: gauges[1].unit",
                     "strain_per_V, or bridge"},
        BenchRefusal{"unit = \"V\"\nstrain_per_V", "unit = \"strain\"\nstrain_per_V",
                     "33: gauges[1].strain_per_V", "unit = \"V\""},
        BenchRefusal{"gain = 500", "gain = 500\nstrain_per_V = 1e-3", "28: gauges[0].strain_per_V",
                     "keep one"},
        BenchRefusal{"bridge = \"quarter\"\n", "", "23: gauges[0].gauge_factor",
                     "add bridge = \"quarter\""},
        BenchRefusal{"bridge = \"quarter\"", "bridge = \"fully\"", "23: gauges[0].bridge",
                     "one of \"quarter\", \"half\""},
        BenchRefusal{"gain = 500\n", "", "16: gauges[0].gain", "add it"},
        BenchRefusal{"gain = 500", "gain = 500\nlead_wires = 4", "28: gauges[0].lead_wires",
                     "give 2"},
        BenchRefusal{"gain = 500", "gain = 500\nlead_wires = 2.0", "28: gauges[0].lead_wires",
                     "give an integer"},
        BenchRefusal{"gain = 500", "gain = 500\nlead_wires = -2147483649",
                     "28: gauges[0].lead_wires", "small whole number"},
        BenchRefusal{"gain = 500", "gain = 500\ngauges_in_series = 0",
                     "28: gauges[0].gauges_in_series", "give 1"},
        BenchRefusal{"gain = 500", "gain = 500\nlead_resistance_ohm = 0.5",
                     "16: gauges[0].gauge_resistance_ohm", "resistance of one gauge"},
        BenchRefusal{"gain = 500", "gain = 500\ngauge_resistance_ohm = 0.35",
                     "28: gauges[0].gauge_resistance_ohm", "give ohms"},
        BenchRefusal{"gain = 500", "gain = 500\nshunt_reading_V = 1", "27: gauges[0].gain",
                     "keep one"},
        BenchRefusal{"gain = 500", "gauge_resistance_ohm = 350\nshunt_reading_V = 1",
                     "16: gauges[0].shunt_resistance_ohm", "the step it gave"},
        BenchRefusal{"gain = 500",
                     "gauge_resistance_ohm = 350\nshunt_resistance_ohm = 1e5\nshunt_reading_V = 0",
                     "29: gauges[0].shunt_reading_V", "volts"},
        BenchRefusal{"kind = \"shpb\"", "kind = \"bar\"", "10: bars.output", "remove it"},
        BenchRefusal{"bar = \"output\"", "bar = \"input\"", "16: gauges", "bar = \"output\""},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 0.015\nfar_end = \"matched\"",
                     "8: bars.input.far_end", "[bars.output]"},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 0.015\nfar_end = \"free\"",
                     "8: bars.input.far_end", "[bars.output]"},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 0.015\nside_m = 0.014",
                     "8: bars.input.side_m", "section = \"square\""},
        BenchRefusal{"diameter_m = 0.015", "diameter_m = 0.015\nsection = \"square\"",
                     "5: bars.input.side_m", "side in metres"},
        BenchRefusal{"diameter_m = 0.015", "section = \"oval\"", "7: bars.input.section",
                     R"(one of "round", "square")"}));

INSTANTIATE_TEST_SUITE_P(
    Ball, ImpactRefusals,
    ::testing::Values(BenchRefusal{"mass_kg = 0.0456", "mass_kg = 45.6", "16: ball.mass_kg",
                                   "kilograms"},
                      BenchRefusal{"0.0427", "42.7", "14: ball.outer_diameter_m", "metres"},
                      BenchRefusal{"= 0.037", "= 0.0427", "15: ball.core_diameter_m", "surrounds"},
                      BenchRefusal{"scale_density = true", "scale_density = 1",
                                   "17: ball.scale_density", "true or false"},
                      BenchRefusal{"kind = \"impact\"", "kind = \"bar\"", "13: ball", "remove it"},
                      BenchRefusal{"bar = \"input\"", "bar = \"output\"", "10: gauges[0].bar",
                                   "give \"input\""}));

TEST(BenchFile, NamesWhatIsMissingAltogether) {
  EXPECT_EQ(refusal_of([] { (void)parse_bench("", "b.toml"); }),
            "b.toml: kind: is missing; add it");
  const std::string text = kShpb;
  const std::string no_specimen =
      text.substr(0, text.find("[specimen]")) + text.substr(text.find("[striker]"));
  EXPECT_EQ(refusal_of([&] { (void)parse_bench(no_specimen, "b.toml"); }),
            "b.toml: specimen: is missing for kind = \"shpb\"; add [specimen]");
  const std::string impact = kImpact;
  EXPECT_EQ(
      refusal_of([&] { (void)parse_bench(impact.substr(0, impact.find("[ball]")), "b.toml"); }),
      "b.toml: ball: is missing for kind = \"impact\"; add [ball]");
  const std::string no_gauges =
      impact.substr(0, impact.find("[[gauges]]")) + impact.substr(impact.find("[ball]"));
  EXPECT_EQ(refusal_of([&] { (void)parse_bench(no_gauges, "b.toml"); }),
            "b.toml: gauges: has none on the input bar; add [[gauges]] with bar = \"input\"");
}

TEST(BenchFile, TheExampleOfTheInterfaceIsTaken) {
  const Bench bench = parse_bench(R"(kind = "bar"
sampling_frequency_Hz = 1.0e6
positive = "compression"

[bars.input]
length_m = 2.0
diameter_m = 0.020
density_kg_m3 = 1180.0
poisson_ratio = 0.36
youngs_modulus_Pa = 113e9

[[gauges]]
name = "g1"
bar = "input"
position_m = 0.100
unit = "strain"
)",
                                  "b.toml");
  EXPECT_EQ(bench.kind, BenchKind::bar);
  EXPECT_EQ(bench.input.youngs_modulus_Pa->value, 113e9);
}

}  // namespace
}  // namespace kolsky
