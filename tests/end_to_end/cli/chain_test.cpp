// From bar to specimens to ball, on records that other methods made: rods in the time domain for
// bar and specimens, and for the ball another code of finite elements (triangles of constant
// strain, Jaumann's rate) that shares nothing with processing/impact.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/generators/ball_impact.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/linear_shpb.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::kolsky;
using scene::refused;

constexpr RodMaterial kPmma{1180.0, 5.66e9, 37.0e9, 1.81e6};
constexpr RodMaterial kCore{1140.0, 121e6, 143e6, 2860.0};
constexpr RodMaterial kCover{960.0, 987e6, 452e6, 6020.0};
constexpr double kSpeed_m_per_s = 40.3;
constexpr double kNoise = 4e-6;
constexpr double kBarArea_m2 = 0.25 * std::numbers::pi * 0.027 * 0.027;

std::string bar_lines(const char* bar, double length_m, double diameter_m) {
  return fmt::format(
      "[bars.{}]\nlength_m = {}\ndiameter_m = {}\ndensity_kg_m3 = 1180.0\npoisson_ratio = 0.36\n",
      bar, length_m, diameter_m);
}

std::string gauge_lines(const std::string& name, const char* bar, double position_m) {
  return fmt::format(
      "[[gauges]]\nname = \"{}\"\nbar = \"{}\"\nposition_m = {}\nunit = \"strain\"\n", name, bar,
      position_m);
}

testing::BallSolid solid_of(const RodMaterial& rod, double poisson_ratio) {
  return {rod.density_kg_m3, poisson_ratio, rod.E1_Pa, rod.E2_Pa, rod.eta2_Pa_s};
}

class Chain : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    files_ = new Files;
    files_->make();
  }
  static void TearDownTestSuite() { delete files_; }

  struct Files {
    testing::ScratchFolder folder;
    std::vector<std::string> bar, core, cover, ball;
    std::string warm, near;  ///< a core's, 5 K and 1.5 K above the bar's shots
    testing::BallForce truth;

    void make() {
      bar = make_bar("bar", kPmma);
      core = make_specimens("core", kCore, 0.376);
      cover = make_specimens("cover", kCover, 0.319);
      make_balls();
    }

    std::string import(const std::string& name, const std::string& table, const std::string& bench,
                       const std::vector<std::string>& more = {}) {
      folder.write(name + ".csv", table);
      std::vector<std::string> words = {"import",       "csv", folder / (name + ".csv"), "--bench",
                                        folder / bench, "-o",  folder / (name + ".h5")};
      words.insert(words.end(), more.begin(), more.end());
      const scene::Answer answer = kolsky(words);
      EXPECT_EQ(answer.code, 0) << answer.err;
      return folder / (name + ".h5");
    }

    std::vector<std::string> make_bar(const std::string& name, const RodMaterial& material) {
      std::string bench = "kind = \"bar\"\nsampling_frequency_Hz = 1e6\ntemperature_K = 296.0\n" +
                          bar_lines("input", 2.0, 0.02);
      for (int j = 0; j < 4; ++j) {
        bench += gauge_lines(fmt::format("g{}", j + 1), "input", 0.1 + 0.2 * j);
      }
      folder.write("bar.toml", bench);
      testing::BarShots::Setup setup;
      setup.material = material;
      std::mt19937_64 random(5);
      std::vector<std::string> captures;
      for (const Shot& shot : testing::BarShots(setup).draw(2, {}, random)) {
        std::string table = "time_s,g1,g2,g3,g4\n";
        for (std::size_t n = 0; n < shot.samples(); ++n) {
          table += fmt::format("{:.7f}", static_cast<double>(n) * 1e-6);
          for (std::size_t j = 0; j < 4; ++j) {
            const ChannelRecord& channel = shot.channels[j];
            const Gauge& gauge = shot.bench.gauges[j];
            const double strain_per_unit = gauge.strain_per_V ? gauge.strain_per_V->value : 1.0;
            table += fmt::format(",{:.7e}", channel.value(channel.codes[n]) * strain_per_unit);
          }
          table += "\n";
        }
        captures.push_back(import(fmt::format("{}{}", name, captures.size()), table, "bar.toml"));
      }
      return captures;
    }

    std::vector<std::string> make_specimens(const std::string& name, const RodMaterial& material,
                                            double poisson_ratio) {
      testing::LinearShpb model;
      model.specimen = material;
      folder.write(name + ".toml",
                   "kind = \"shpb\"\nsampling_frequency_Hz = 1e6\n" +
                       bar_lines("input", 0.7, 0.015) + bar_lines("output", 0.7, 0.015) +
                       gauge_lines("g1", "input", 0.4) + gauge_lines("g2", "output", 0.05) +
                       fmt::format("[specimen]\nlength_m = 0.004\ndiameter_m = 0.012\n"
                                   "density_kg_m3 = {}\npoisson_ratio = {}\n",
                                   material.density_kg_m3, poisson_ratio));
      const auto records = model.solve();
      std::mt19937 random(static_cast<unsigned>(name.size()));
      std::normal_distribution<double> noise(0.0, kNoise);
      std::vector<std::string> captures;
      for (int i = 0; i < 3; ++i) {
        std::string table = "time_s,g1,g2\n";
        for (std::size_t n = 0; n < records[0].size(); ++n) {
          table += fmt::format("{:.7f},{:.7e},{:.7e}\n", 1e-6 * static_cast<double>(n),
                               records[0][n] + noise(random), records[1][n] + noise(random));
        }
        captures.push_back(import(fmt::format("{}{}", name, i), table, name + ".toml"));
        if (i == 0 && name == "core") {
          warm = import("warm", table, name + ".toml", {"--meta", "temperature_K=301.0"});
          near = import("near", table, name + ".toml", {"--meta", "temperature_K=297.5"});
        }
      }
      return captures;
    }

    void make_balls() {
      const std::string text =
          "kind = \"impact\"\nsampling_frequency_Hz = 1e6\n[bars.input]\nlength_m = 3.0\n"
          "diameter_m = 0.027\ndensity_kg_m3 = 4420.0\npoisson_ratio = 0.33\n"
          "youngs_modulus_Pa = 113e9\n" +
          gauge_lines("g1", "input", 0.25) +
          "[ball]\nouter_diameter_m = 0.0427\ncore_diameter_m = 0.03565\nmass_kg = 0.0434\n";
      folder.write("impact.toml", text);
      const double impedance_kg_per_s = std::sqrt(113e9 * 4420.0) * kBarArea_m2;
      testing::BallImpact ball_of_another_code;
      ball_of_another_code.core_diameter_m = 0.03565;
      ball_of_another_code.outer_diameter_m = 0.0427;
      ball_of_another_code.core = solid_of(kCore, 0.376);
      ball_of_another_code.cover = solid_of(kCover, 0.319);
      ball_of_another_code.speed_m_per_s = kSpeed_m_per_s;
      ball_of_another_code.impedance_kg_per_s = impedance_kg_per_s;
      ball_of_another_code.target_radius_m = 0.0135;
      ball_of_another_code.across = 20;
      truth = testing::strike(ball_of_another_code);
      const double c = std::sqrt(113e9 / 4420.0);
      std::mt19937 random(8);
      std::normal_distribution<double> noise(0.0, 1e-6);
      const auto push = [&](double time_s) {
        // A sample is the mean over its interval: it stands for its middle.
        const double place = time_s / truth.period_s - 0.5;
        const auto n = static_cast<std::size_t>(std::max(0.0, place));
        return place < 0.0 || n + 1 >= truth.force_N.size()
                   ? 0.0
                   : truth.force_N[n] + (place - static_cast<double>(n)) *
                                            (truth.force_N[n + 1] - truth.force_N[n]);
      };
      for (int i = 0; i < 2; ++i) {
        std::string table = "time_s,g1\n";
        for (int n = 0; n < 2600; ++n) {
          const double time_s = 1e-6 * n - 1.0e-3;
          const double force_N = push(time_s - 0.25 / c) - push(time_s - 5.75 / c);
          table += fmt::format("{:.7f},{:.7e}\n", 1e-6 * n,
                               force_N / (113e9 * kBarArea_m2) + noise(random));
        }
        ball.push_back(
            import(fmt::format("ball{}", i), table, "impact.toml",
                   {"--meta", fmt::format("incident_speed_m_per_s={}", kSpeed_m_per_s), "--meta",
                    fmt::format("rebound_speed_m_per_s={}", truth.rebound_m_per_s)}));
      }
    }
  };

  static std::vector<std::string> with(std::vector<std::string> words, const char* option,
                                       const std::vector<std::string>& captures) {
    words.emplace_back(option);
    words.insert(words.end(), captures.begin(), captures.end());
    return words;
  }

  static Files* files_;
};

Chain::Files* Chain::files_ = nullptr;

TEST_F(Chain, ForetellsTheBallFromTheSpecimensWithinItsDeviations) {
  std::vector<std::string> words = with({"chain"}, "--bar-shots", files_->bar);
  words = with(with(with(words, "--core-shots", files_->core), "--cover-shots", files_->cover),
               "--ball-shots", files_->ball);
  const std::string svg = files_->folder / "chain.svg";
  words.insert(words.end(), {"--draws", "12", "--law", "cauchy", "--svg", svg, "--json"});
  const json told = json_of(kolsky(words));
  const std::pair<const char*, const RodMaterial*> parts[] = {{"core", &kCore}, {"cover", &kCover}};
  for (const auto& [part, truth] : parts) {
    const json& E1 = told[part]["parameters"]["E1_Pa"];
    EXPECT_NEAR(E1["value"].get<double>(), truth->E1_Pa, 4.0 * E1["sd"].get<double>()) << part;
  }
  EXPECT_FALSE(told["bar"].is_null());
  ASSERT_EQ(told["speeds"].size(), 1U);
  const json& speed = told["speeds"][0];
  EXPECT_EQ(speed["shots"], 2);
  const json& peak = speed["peak_force_N"];
  const double measured_N = peak["measured"]["value"].get<double>();
  EXPECT_NEAR(peak["predicted"]["value"].get<double>(), measured_N, 0.01 * measured_N);
  EXPECT_GT(peak["predicted"]["sd"].get<double>(), 1e-5 * measured_N);
  EXPECT_LT(peak["predicted"]["sd"].get<double>(), 0.02 * measured_N);
  for (const json* pair :
       {&peak, &speed["contact_time_s"], &speed["impulse_N_s"], &speed["restitution"]["by_speed"],
        &speed["restitution"]["by_impulse"]}) {
    EXPECT_LT(std::abs((*pair)["z"].get<double>()), 4.0) << *pair;
  }
  EXPECT_NEAR(speed["restitution"]["by_speed"]["predicted"]["value"].get<double>(),
              files_->truth.rebound_m_per_s / kSpeed_m_per_s, 0.004);
  EXPECT_TRUE(speed["agrees"].get<bool>());
  EXPECT_TRUE(told["agrees"].get<bool>());
  for (const char* open :
       {"% of the core is beyond a strain of 0.1", "does not validate the law at small strains",
        "holds some two of a material's three numbers"}) {
    EXPECT_NE(told["remarks"].dump().find(open), std::string::npos) << open;
  }
  EXPECT_EQ(told["core_cover_covariance"].size(), 3U);
  EXPECT_LT(speed["force_rms_share"].get<double>(), 0.01);
  EXPECT_EQ(speed["time_s"].size(), speed["force_measured_N"].size());
  EXPECT_EQ(speed["time_s"].size(), speed["force_predicted_sd_N"].size());
  EXPECT_TRUE(std::filesystem::exists(svg));
}

// The same captures, and a law in three dimensions that the ball does not have; without friction
// where it has some.
TEST_F(Chain, AWrongModelIsFoundOut) {
  std::vector<std::string> words = with({"chain"}, "--bar-shots", files_->bar);
  words = with(with(with(words, "--core-shots", files_->core), "--cover-shots", files_->cover),
               "--ball-shots", files_->ball);
  words.insert(words.end(), {"--draws", "12", "--law", "cauchy", "--reading", "bulk-Einf"});
  const scene::Answer text = kolsky(words);
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("does not agree: "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("kolsky diagnose"), std::string::npos);
  words.back() = "full";
  words.insert(words.end(), {"--friction", "0", "--json"});
  const json frictionless = json_of(kolsky(words));
  EXPECT_FALSE(frictionless["agrees"].get<bool>())
      << frictionless["speeds"][0]["restitution"].dump();
}

TEST_F(Chain, ABallThatWeighsSomethingElseIsRefused) {
  // Core specimens are passed for the cover: such a ball is heavier than the filed one.
  std::vector<std::string> words = with({"chain"}, "--bar-shots", files_->bar);
  words = with(with(with(words, "--core-shots", files_->core), "--cover-shots", files_->core),
               "--ball-shots", files_->ball);
  words.emplace_back("--json");
  EXPECT_TRUE(refused(kolsky(words), {"ball.mass_kg", "scale_density"}));
}

TEST_F(Chain, ForetellsWithoutAMeasurementAndInText) {
  std::vector<std::string> words = with({"chain"}, "--core-shots", files_->core);
  words = with(words, "--cover-shots", files_->cover);
  words.insert(words.end(),
               {"--bench", files_->folder / "impact.toml", "--speed", "31.1", "--draws", "8"});
  const scene::Answer answer = kolsky(words);
  EXPECT_EQ(answer.code, 0) << answer.err;
  for (const std::string wanted :
       {"31.10 m/s, 0 shots", "restitution, speed", "peak force", "foretold"}) {
    EXPECT_NE(answer.out.find(wanted), std::string::npos) << wanted << "\n" << answer.out;
  }
  EXPECT_EQ(answer.out.find("agree"), std::string::npos) << "nothing was measured";
}

TEST_F(Chain, SaysThatABarIsMoreThanThreeElementsAndGoesByItsFile) {
  RodMaterial branches = kPmma;
  branches.relaxations = {{6e-12, 3e-4}};
  const std::vector<std::string> bar = files_->make_bar("branches", branches);
  const auto chain = [&](const char* option, const std::vector<std::string>& bars,
                         const std::vector<std::string>& solid = {}) {
    std::vector<std::string> words = with({"chain"}, option, bars);
    words.insert(words.end(), solid.begin(), solid.end());
    words = with(with(words, "--core-shots", files_->core), "--cover-shots", files_->cover);
    words.insert(words.end(), {"--bench", files_->folder / "impact.toml", "--speed", "31.1",
                               "--draws", "8", "--json"});
    return json_of(kolsky(words));
  };
  const std::string ahead = "a two-kelvin solid is ahead of the three-element one";
  const std::string remarks = chain("--bar-shots", bar)["remarks"].dump();
  EXPECT_NE(remarks.find(ahead), std::string::npos) << remarks;
  EXPECT_NE(remarks.find("--bar-solid two-kelvin goes by it"), std::string::npos) << remarks;
  const std::string filed = files_->folder / "branches.toml";
  std::vector<std::string> words = {"identify", "bar", "--solid", "auto", "--model-out", filed};
  words.insert(words.end(), bar.begin(), bar.end());
  ASSERT_EQ(kolsky(words).code, 0);
  const json by_file = chain("--bar-model", {filed});
  EXPECT_EQ(by_file["remarks"].dump().find(ahead), std::string::npos);
  EXPECT_EQ(by_file["speeds"].size(), 1U);
  // At once, without a file between: the same but for the digits that a file has.
  const json at_once = chain("--bar-shots", bar, {"--bar-solid", "auto"});
  EXPECT_EQ(at_once["remarks"].dump().find(ahead), std::string::npos);
  EXPECT_EQ(at_once["bar"]["parameters"].size(), 5U);
  for (const char* number : {"E1_Pa", "E2_Pa", "eta2_Pa_s"}) {
    const double filed_by = by_file["core"]["parameters"][number]["value"];
    EXPECT_NEAR(at_once["core"]["parameters"][number]["value"], filed_by, 1e-4 * filed_by);
  }
}

// PMMA's moduli change by some 0.3 % per kelvin: bars count as alike within 2 K.
TEST_F(Chain, BarsIdentifiedAtAnotherTemperatureAreRefused) {
  const auto chain = [&](const std::string& core) {
    std::vector<std::string> words = with({"chain"}, "--bar-shots", files_->bar);
    words = with(with(words, "--core-shots", {core}), "--cover-shots", files_->cover);
    words.insert(words.end(),
                 {"--bench", files_->folder / "impact.toml", "--speed", "31.1", "--draws", "8"});
    return kolsky(words);
  };
  EXPECT_TRUE(refused(chain(files_->warm), {"warm", "301.0 K", "296.0 K"}));
  const scene::Answer near = chain(files_->near);
  EXPECT_EQ(near.code, 0) << near.err;
}

TEST_F(Chain, RefusesWhatIsNoChain) {
  std::vector<std::string> specimens =
      with(with({"chain"}, "--core-shots", files_->core), "--cover-shots", files_->cover);
  EXPECT_TRUE(refused(kolsky(specimens), {"--bench"}));
  EXPECT_TRUE(
      refused(kolsky(with(with(specimens, "--ball-shots", files_->ball), "--bar-solid", {"auto"})),
              {"--bar-solid", "--bar-shots"}));
  EXPECT_TRUE(
      refused(kolsky(with(specimens, "--ball-shots", files_->bar)), {"impact", "--ball-shots"}));
  EXPECT_TRUE(refused(
      kolsky(with(with(specimens, "--bar-shots", files_->core), "--ball-shots", files_->ball)),
      {"--bar-shots", "bar"}));
  files_->folder.write("others.toml",
                       "density_kg_m3 = 1400\npoisson_ratio = 0.36\nE1_Pa = 5.7e9\nE2_Pa = 37e9\n"
                       "eta2_Pa_s = 1.8e6\n");
  EXPECT_TRUE(refused(kolsky(with(with(specimens, "--bar-model", {files_->folder / "others.toml"}),
                                  "--ball-shots", files_->ball)),
                      {"others.toml", "1400 kg/m3"}));
  std::vector<std::string> few = with(specimens, "--ball-shots", files_->ball);
  few.insert(few.end(), {"--draws", "2"});
  EXPECT_TRUE(refused(kolsky(few), {"--draws"}));
  std::vector<std::string> read = with(specimens, "--ball-shots", files_->ball);
  read.insert(read.end(), {"--reading", "odd"});
  EXPECT_TRUE(refused(kolsky(read), {"--reading"}));
  EXPECT_TRUE(refused(kolsky({"chain"}), {"--core-shots", "missing"}));
}

}  // namespace
}  // namespace kolsky
