// kolsky impact as a person or a script runs it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using scene::Answer;
using scene::refused;
using testing::ScratchFolder;

const std::string kBenches = std::string(KOLSKY_SOURCE_DIR) + "/docs/benches/";

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> impact(const std::vector<std::string>& more) {
  std::vector<std::string> words = {"impact",
                                    "--bench",
                                    kBenches + "paper-impact.toml",
                                    "--core",
                                    kBenches + "../materials/golf-core.toml",
                                    "--cover",
                                    kBenches + "../materials/golf-cover.toml"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(Impact, JsonHoldsWhatTheInterfaceSays) {
  const Answer answer = scene::kolsky(impact({"--speed", "40.3", "--elements", "512", "--json"}));
  const nlohmann::json json = scene::json_of(answer);
  ASSERT_EQ(json.at("time_s").size(), json.at("force_N").size());
  EXPECT_GT(json.at("time_s").size(), 300U);
  EXPECT_NEAR(json.at("peak_force_N").get<double>(), 12.7e3, 0.2e3);
  EXPECT_NEAR(json.at("restitution").get<double>(), 0.81, 0.01);
  EXPECT_NEAR(json.at("contact_time_s").get<double>(), 425e-6, 10e-6);
  EXPECT_NEAR(json.at("mass_kg").get<double>(), 0.0434, 1e-5);
  const nlohmann::json& energy = json.at("energy");
  double sum = 0.0;
  for (const char* part : {"kinetic_J", "stored_J", "dissipated_J", "radiated_J", "friction_J",
                           "contact_J", "sabot_J"}) {
    sum += energy.at(part).get<double>();
  }
  EXPECT_NEAR(sum, energy.at("initial_J").get<double>(), 2e-3 * sum);
  EXPECT_NEAR(sum / energy.at("initial_J").get<double>() - 1.0, energy.at("closure").get<double>(),
              1e-9);
  EXPECT_EQ(json.at("probes").size(), 3U);
  EXPECT_EQ(json.at("target"), "dashpot");
  EXPECT_EQ(json.at("reading"), "full");
}

TEST(Impact, MeshedBarGivesTheBenchsGauges) {
  const nlohmann::json json = scene::json_of(
      scene::kolsky(impact({"--speed", "31.1", "--elements", "300", "--target", "bar", "--json"})));
  ASSERT_EQ(json.at("gauges").size(), 1U);
  EXPECT_EQ(json.at("gauges")[0].at("name"), "g1");
  double largest = 0.0;
  for (const double strain : json.at("gauges")[0].at("strain")) {
    largest = std::max(largest, strain);
  }
  // 64.7 N per microstrain.
  EXPECT_NEAR(largest, json.at("peak_force_N").get<double>() / 64.7e6, 0.02 * largest);
}

TEST(Impact, ReportTellsAPerson) {
  const Answer answer =
      scene::kolsky(impact({"--speed", "51", "--elements", "300", "--reading", "bulk-Einf"}));
  EXPECT_EQ(answer.code, 0) << answer.err;
  for (const char* words : {"restitution", "781.2 MPa at once", "filed E1 987 MPa",
                            "of the core is beyond", "closes to", "contact force"}) {
    EXPECT_NE(answer.out.find(words), std::string::npos) << words << "\n" << answer.out;
  }
}

/// The shares of the energy that a person reads sum to all of it, the sabot's among them.
TEST(Impact, SharesOfTheEnergySumToTheWhole) {
  const Answer answer = scene::kolsky(impact(
      {"--speed", "40.3", "--elements", "300", "--sabot-mass", "0.002", "--offset", "0.004"}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  std::string text = answer.out.substr(answer.out.find("  energy"));
  text = text.substr(0, text.find("closes to"));
  double sum = 0.0;
  for (std::size_t at = text.find(" %"); at != std::string::npos; at = text.find(" %", at + 1)) {
    sum += std::stod(text.substr(text.find_last_of(" \n", at - 1)));
  }
  EXPECT_NEAR(sum, 100.0, 0.5) << text;
  EXPECT_NE(text.find("the sabot's"), std::string::npos) << text;
}

TEST(Impact, ListsAreAsTheBenchSamplesAndNumbersAreNot) {
  const ScratchFolder folder;
  std::string bench = text_of(kBenches + "paper-impact.toml");
  const std::size_t at = bench.find("sampling_frequency_Hz");
  bench.replace(at, bench.find('\n', at) - at, "sampling_frequency_Hz = 20e3");
  folder.write("slow.toml", bench);
  std::vector<std::string> words = impact({"--speed", "40.3", "--elements", "300", "--json"});
  const nlohmann::json usual = scene::json_of(scene::kolsky(words));
  words[2] = folder / "slow.toml";
  const nlohmann::json slow = scene::json_of(scene::kolsky(words));
  EXPECT_EQ(slow["peak_force_N"], usual["peak_force_N"]);
  EXPECT_EQ(slow["contact_time_s"], usual["contact_time_s"]);
  EXPECT_NEAR(slow["time_s"][1].get<double>(), 50e-6, 1e-12);
  for (const char* list : {"force_N", "contact_radius_m"}) {
    EXPECT_EQ(slow[list].size(), slow["time_s"].size()) << list;
  }
  double sum = 0.0;
  for (const double force_N : slow["force_N"]) {
    sum += 50e-6 * force_N;
  }
  EXPECT_NEAR(sum, slow["impulse_N_s"].get<double>(), 1e-6);
}

TEST(Impact, JsonHoldsTheFieldsAndPointsAskedFor) {
  const nlohmann::json json =
      scene::json_of(scene::kolsky(impact({"--speed", "40.3", "--elements", "300", "--json",
                                           "--field", "1e-4", "--probe", "0.005,0.010"})));
  ASSERT_EQ(json["fields"].size(), 1U);
  const nlohmann::json& field = json["fields"][0];
  EXPECT_NEAR(field["time_s"].get<double>(), 1e-4, 1e-6);
  for (const char* list : {"r_m", "z_m", "axial_stress_Pa", "layer"}) {
    EXPECT_EQ(field[list].size(), json["mesh"]["elements"].get<std::size_t>()) << list;
  }
  // The quadrilaterals, turned about the axis, are the ball, squeezed by less than a tenth of its
  // volume: the integral of pi r^2 dz round each.
  double volume_m3 = 0.0;
  for (std::size_t n = 0; n < field["r_m"].size(); ++n) {
    double own_m3 = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double r = field["r_m"][n][k];
      const double next_r = field["r_m"][n][(k + 1) % 4];
      const double rise =
          field["z_m"][n][(k + 1) % 4].get<double>() - field["z_m"][n][k].get<double>();
      own_m3 += std::numbers::pi / 3.0 * (r * r + r * next_r + next_r * next_r) * rise;
    }
    volume_m3 += std::abs(own_m3);  // blocks may run round either way
  }
  const double round_m3 = std::numbers::pi / 6.0 * std::pow(0.0427, 3);
  EXPECT_LT(volume_m3, round_m3);
  EXPECT_GT(volume_m3, 0.9 * round_m3);
  ASSERT_EQ(json["probes"].size(), 1U);
  EXPECT_EQ(json["probes"][0]["radial_m"], 0.005);
  EXPECT_EQ(json["probes"][0]["axial_m"], 0.010);
  EXPECT_TRUE(
      refused(scene::kolsky(impact({"--speed", "40.3", "--probe", "0.005,0", "--probe", "0.03,0"})),
              {"--probe: 0.03 m from the axis and 0 m from the centre is outside of the ball",
               "0.02135 m"}));
  EXPECT_TRUE(refused(scene::kolsky(impact({"--speed", "40.3", "--probe", "0.003"})), {"--probe"}));
}

TEST(Impact, ABarsPoissonRatioIsNamedWithItsFileAndLine) {
  const ScratchFolder folder;
  std::string bench = text_of(kBenches + "paper-impact.toml");
  const std::size_t at = bench.find("poisson_ratio");
  bench.replace(at, bench.find('\n', at) - at, "poisson_ratio = 0.5");
  folder.write("rubber.toml", bench);
  std::vector<std::string> words = impact({"--speed", "40.3"});
  words[2] = folder / "rubber.toml";
  const auto line =
      1 + std::count(bench.begin(), bench.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  EXPECT_TRUE(refused(scene::kolsky(words), {"rubber.toml:" + std::to_string(line),
                                             "bars.input.poisson_ratio", "below 0.5"}));
}

TEST(Impact, SvgShowsTheBallAndItsScale) {
  const ScratchFolder folder;
  const std::string file = folder / "ball.svg";
  const Answer answer = scene::kolsky(impact({"--speed", "40.3", "--elements", "300", "--svg", file,
                                              "--field", "1e-4", "--field", "2e-4"}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  const std::string svg = text_of(file);
  EXPECT_EQ(svg.rfind("<?xml", 0), 0U);
  EXPECT_NE(svg.find("axial stress [MPa]"), std::string::npos);
  EXPECT_NE(svg.find("t = 100"), std::string::npos);
  EXPECT_NE(svg.find("t = 200"), std::string::npos);
  std::size_t polygons = 0;
  for (std::size_t at = svg.find("<polygon"); at != std::string::npos;
       at = svg.find("<polygon", at + 1)) {
    ++polygons;
  }
  EXPECT_GT(polygons, 4U * 250U);  // two times, two halves
}

TEST(Impact, DensitiesAreScaledOnlyWhenTheBenchSaysSo) {
  const ScratchFolder folder;
  std::string bench = text_of(kBenches + "paper-impact.toml");
  bench.replace(bench.find("0.03565"), 7, "0.03800");
  folder.write("thin.toml", bench);
  folder.write("scaled.toml", bench + "scale_density = true\n");
  const auto words = [&](const std::string& file) {
    std::vector<std::string> all = impact({"--speed", "40.3", "--elements", "300", "--json"});
    all[2] = folder / file;
    return all;
  };
  EXPECT_TRUE(refused(scene::kolsky(words("thin.toml")),
                      {"thin.toml", "ball.mass_kg", "44.3055 g", "scale_density = true"}));
  const nlohmann::json json = scene::json_of(scene::kolsky(words("scaled.toml")));
  EXPECT_NEAR(json.at("density_scale").get<double>(), 0.9795, 5e-4);
  EXPECT_NEAR(json.at("mass_kg").get<double>(), 0.0434, 1e-5);
}

TEST(Impact, FiguresRefuseWhatTheyDoNotTakeAndLeaveNothingWhereTheyFail) {
  const ScratchFolder folder;
  const std::string figures = folder / "figures";
  for (const auto& [option, value] :
       {std::pair{"--speed", "40"}, std::pair{"--friction", "0.1"}, std::pair{"--reading", "exact"},
        std::pair{"--elements", "512"}, std::pair{"--offset", "0.004"}}) {
    EXPECT_TRUE(refused(scene::kolsky(impact({"--figures", figures, option, value})),
                        {option, "does not go with --figures"}));
  }
  // A core so soft that its elements turn inside out.
  const std::vector<std::string> failing =
      impact({"--figures", figures, "--core-nonlinearity", "-3"});
  EXPECT_TRUE(refused(scene::kolsky(failing), {"inside out"}));
  EXPECT_FALSE(std::filesystem::exists(figures));
  folder.write("other", "");
  EXPECT_TRUE(refused(scene::kolsky(impact({"--figures", folder / "."})), {"is there already"}));
}

TEST(Impact, RefusesWhatCannotBe) {
  const ScratchFolder folder;
  std::string core = text_of(kBenches + "../materials/golf-core.toml");
  folder.write("active.toml", core.replace(core.find("143e6"), 5, "-14e6"));
  const auto with_core = [&](const std::string& file) {
    std::vector<std::string> words = impact({"--speed", "40.3"});
    words[4] = file;
    return words;
  };
  const auto refuses = [](const std::vector<std::string>& words,
                          const std::vector<std::string>& named) {
    EXPECT_TRUE(refused(scene::kolsky(words), named)) << named.front();
  };
  refuses(with_core(folder / "active.toml"), {"active.toml", "E2_Pa"});
  core = text_of(kBenches + "../materials/golf-core.toml");
  const std::size_t ratio = core.find("0.376");
  folder.write("rubber.toml", core.replace(ratio, 5, "0.500"));
  const auto line =
      1 + std::count(core.begin(), core.begin() + static_cast<std::ptrdiff_t>(ratio), '\n');
  refuses(with_core(folder / "rubber.toml"),
          {"rubber.toml:" + std::to_string(line) + ": poisson_ratio: 0.5 has no finite bulk"});
  // So soft that it turns inside out without an option that says so: its file is to blame.
  core = text_of(kBenches + "../materials/golf-core.toml");
  core.replace(core.find("121e6"), 5, "1e5");
  folder.write("jelly.toml", core.replace(core.find("143e6"), 5, "1e5"));
  refuses(with_core(folder / "jelly.toml"), {"jelly.toml: element", "turned inside out"});
  refuses(with_core(folder / "none.toml"), {"none.toml"});
  refuses(impact({}), {"--speed", "is missing"});
  refuses(impact({"--speed", "0"}), {"--speed", "0 m/s"});
  refuses(impact({"--speed", "-40"}), {"--speed"});
  refuses(impact({"--speed", "4e4"}), {"--speed", "at most 500"});
  refuses(impact({"--speed", "40", "--friction", "-0.1"}), {"--friction"});
  refuses(impact({"--speed", "40", "--target", "wall"}), {"--target", "wall", "dashpot"});
  refuses(impact({"--speed", "40", "--reading", "half"}), {"--reading", "half", "bulk-E1"});
  refuses(impact({"--speed", "40", "--law", "green"}), {"--law", "green", "cauchy"});
  refuses(impact({"--speed", "40", "--elements", "10"}),
          {"--elements", "10", "give 170 to 1000000"});
  refuses(impact({"--speed", "40", "--elements", "64"}), {"--elements", "give 170 to 1000000"});
  refuses(impact({"--speed", "nan"}), {"--speed", "give a finite number"});
  refuses(impact({"--speed", "40", "--time-step", "1e-5"}), {"--time-step", "stability"});
  refuses(impact({"--speed", "40", "--core-relaxation", "1e-9"}), {"--core-relaxation", "comma"});
  refuses(impact({"--speed", "40", "--core-relaxation", "-1e-9,1e-4"}),
          {"--core-relaxation: ", "-1e-9,1e-4", "compliance"});
  refuses(impact({"--speed", "40", "--cover-relaxation", "1e-9,0"}),
          {"--cover-relaxation: ", "time"});
  refuses(impact({"--speed", "40", "--core-relaxation", "1e300,1e-4"}), {"--core-relaxation: "});
  refuses(impact({"--speed", "40", "--elements", "4.5"}), {"--elements", "not a whole number"});
  refuses(impact({"--speed", "40", "--offset", "0.02"}), {"--offset", "edge"});
  const std::vector<std::string> softened = impact({"--speed", "51", "--core-nonlinearity", "-2"});
  refuses(softened, {"kolsky impact: --core-nonlinearity: element", "turned inside out",
                     "soften the solid less"});
  std::string bench = text_of(kBenches + "paper-impact.toml");
  const std::size_t core_key = bench.find("core_diameter_m");
  bench.replace(core_key, bench.find('\n', core_key) - core_key, "core_diameter_m = 0.042695");
  folder.write("painted.toml", bench + "scale_density = true\n");
  std::vector<std::string> painted = impact({"--speed", "40.3"});
  painted[2] = folder / "painted.toml";
  refuses(painted, {"painted.toml:", "ball.outer_diameter_m: takes about", "steps",
                    "make that layer thicker"});
  const std::vector<std::string> creeping = impact({"--speed", "1e-9", "--elements", "300"});
  refuses(creeping, {"has not left the target", "raise the speed"});
  EXPECT_EQ(scene::kolsky(creeping).err.find("duration"), std::string::npos)
      << "no option of the command";
  std::vector<std::string> shpb = impact({"--speed", "40"});
  shpb[2] = kBenches + "paper-shpb.toml";
  refuses(shpb, {"paper-shpb.toml", "kind", "impact"});
}

}  // namespace
}  // namespace kolsky
