// Identifying specimens, their uncertainty, corrected benches and plans, as a person runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <set>
#include <sstream>

#include "drivers/files/settings/material_file.hpp"
#include "processing/waves/compliance.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/generators/linear_shpb.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::kolsky;
using scene::refused;

constexpr const char* kBench = R"(kind = "shpb"
sampling_frequency_Hz = 1.0e6
positive = "compression"
temperature_K = 296.0
temperature_K_sd = 0.3
[bars.input]
length_m = 0.700
diameter_m = 0.015
diameter_m_sd = 0.00002
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[bars.output]
length_m = 0.700
diameter_m = 0.015
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.400
unit = "strain"
[[gauges]]
name = "g2"
bar = "output"
position_m = 0.050
position_m_sd = 0.0001
unit = "strain"
[specimen]
length_m = 0.004
diameter_m = 0.012
density_kg_m3 = 1140.0
poisson_ratio = 0.376
)";

constexpr const char* kPmma = R"(density_kg_m3 = 1180.0
poisson_ratio = 0.36
E1_Pa = 5.66e9
E1_Pa_sd = 3e5
E2_Pa = 37.0e9
E2_Pa_sd = 4e7
eta2_Pa_s = 1.81e6
eta2_Pa_s_sd = 2e3
covariance = [9e10, -6e12, 0, -6e12, 1.6e15, 0, 0, 0, 4e6]
[identified]
shots = 10
band_limit_Hz = 40e3
temperature_K = 296.5
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Shots on the paper's core between PMMA bars, as tables and captures.
class SpecimenFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("bench.toml", kBench);
    folder_.write("pmma.toml", kPmma);
    const auto records = model_.solve();
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, 5e-6);
    for (int i = 0; i < 3; ++i) {
      const std::string name = "shot" + std::to_string(i);
      std::ofstream table(folder_ / (name + ".csv"));
      table.precision(10);
      table << "time_s,g1,g2\n";
      for (std::size_t n = 0; n < records[0].size(); ++n) {
        table << 1e-6 * static_cast<double>(n) << ',' << records[0][n] + noise(random) << ','
              << records[1][n] + noise(random) << '\n';
      }
      table.close();
      captures_.push_back(folder_ / (name + ".h5"));
      ASSERT_EQ(kolsky({"import", "csv", folder_ / (name + ".csv"), "--bench",
                        folder_ / "bench.toml", "-o", captures_.back()})
                    .code,
                0);
    }
  }

  std::vector<std::string> identify(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"identify", "specimen"};
    words.insert(words.end(), captures_.begin(), captures_.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  testing::ScratchFolder folder_;
  testing::LinearShpb model_;
  std::vector<std::string> captures_;
};

TEST_F(SpecimenFiles, AreDrawnThroughBothEstimators) {
  const json told =
      json_of(kolsky(identify({"--bar-model", folder_ / "pmma.toml", "--draws", "20", "--json"})));
  EXPECT_EQ(told["draws"]["draws"], 20);
  EXPECT_EQ(told["draws"]["failed"], 0);
  for (const char* name : {"E1_Pa", "E2_Pa", "eta2_Pa_s"}) {
    const json& drawn = told["draws"]["parameters"][name];
    EXPECT_EQ(drawn["value"], told["parameters"][name]["value"]) << name;
    EXPECT_LT(drawn["low"].get<double>(), drawn["high"].get<double>()) << name;
    EXPECT_GT(told["draws"]["spectral"]["parameters"][name]["sd"].get<double>(), 0.0) << name;
  }
  EXPECT_TRUE(json_of(kolsky(identify({"--bar-model", folder_ / "pmma.toml", "--json"})))["draws"]
                  .is_null());
}

TEST_F(SpecimenFiles, AreIdentifiedWithBothEstimatorsAndAFileToGoOnWith) {
  const std::string file = folder_ / "core.toml";
  const json told = json_of(
      kolsky(identify({"--bar-model", folder_ / "pmma.toml", "--model-out", file, "--json"})));
  const std::pair<const char*, double> truths[] = {
      {"E1_Pa", 121e6}, {"E2_Pa", 143e6}, {"eta2_Pa_s", 2860.0}};
  for (const auto& [name, truth] : truths) {
    const double value = told["parameters"][name]["value"];
    const double sd = told["parameters"][name]["sd"];
    EXPECT_NEAR(value, truth, 4.0 * sd) << name;
    EXPECT_LT(sd, 0.1 * truth);
    EXPECT_NEAR(told["spectral"]["parameters"][name]["value"].get<double>(), truth, 0.2 * truth);
  }
  const std::size_t count = told["spectrum"]["frequency_Hz"].size();
  EXPECT_GT(count, 10U);
  for (const char* name :
       {"J1_per_Pa", "J1_sd", "J2_per_Pa", "J2_sd", "alpha_per_m", "wavenumber_per_m"}) {
    ASSERT_EQ(told["spectrum"][name].size(), count) << name;
  }
  // Paper, (9).
  const auto at = [&](const char* name) { return told["spectrum"][name][4].get<double>(); };
  const double inertia =
      1140.0 *
      std::pow(2.0 * std::numbers::pi * told["spectrum"]["frequency_Hz"][4].get<double>(), 2);
  EXPECT_NEAR((std::pow(at("wavenumber_per_m"), 2) - std::pow(at("alpha_per_m"), 2)) /
                  (inertia * at("J1_per_Pa")),
              1.0, 1e-9);
  EXPECT_NEAR(2.0 * at("alpha_per_m") * at("wavenumber_per_m") / (inertia * at("J2_per_Pa")), 1.0,
              1e-9);
  EXPECT_LE(told["band_limit_Hz"].get<double>(), 40e3) << "the bars are not known beyond";
  EXPECT_EQ(told["bar_model_assumed"], false);
  ASSERT_EQ(told["shots"].size(), 3U);
  EXPECT_EQ(told["shots"][0]["capture"], captures_.front());
  EXPECT_EQ(told["spectral"]["separation"], "never");
  EXPECT_TRUE(told["spectral"]["warnings"].empty());

  // For people: mean and scatter at some frequencies, by both estimators.
  const std::string text = kolsky(identify({"--bar-model", folder_ / "pmma.toml"})).out;
  const std::string head = "J1 [1/GPa]        J2 [1/GPa]\n";
  const std::size_t direct = text.find(head);
  ASSERT_NE(direct, std::string::npos) << text;
  EXPECT_NE(text.find(head, direct + 1), std::string::npos) << text;
  const std::string row = text.substr(direct + head.size(),
                                      text.find('\n', direct + head.size()) - direct - head.size());
  EXPECT_NE(row.find("±"), row.rfind("±")) << row;

  const std::vector<double> first = model_.solve().front();
  const double pulse_strain = *std::max_element(first.begin(), first.end());
  const json plan = json_of(kolsky({"plan", "--bench", folder_ / "bench.toml", "--specimen", file,
                                    "--pulse-strain", std::to_string(pulse_strain),
                                    "--pulse-duration", "170e-6", "--rise", "40e-6", "--json"}));
  const json reduced = json_of(kolsky({"reduce", captures_.front(), "--json"}));
  EXPECT_NEAR(plan["peak_strain"].get<double>(), reduced["summary"]["peak_strain"].get<double>(),
              0.03 * plan["peak_strain"].get<double>());
  EXPECT_TRUE(refused(kolsky(identify({"--model-out", file})), {"core.toml", "exists"}));
}

TEST_F(SpecimenFiles, HaveNoScatterWhereThereIsOneShot) {
  const json told = json_of(kolsky(
      {"identify", "specimen", captures_.front(), "--bar-model", folder_ / "pmma.toml", "--json"}));
  const json& spectrum = told["spectral"]["spectrum"];
  for (const char* name : {"J1_sd", "J1_sd_of_mean", "J2_sd", "J2_sd_of_mean"}) {
    ASSERT_FALSE(spectrum[name].empty()) << name;
    for (const json& sd : spectrum[name]) {
      EXPECT_TRUE(sd.is_null()) << name << " " << sd;
    }
  }
  EXPECT_TRUE(spectrum["J1_per_Pa"][0].is_number());
  EXPECT_NE(kolsky(identify({"--bar-model", folder_ / "pmma.toml"})).out.find("noise and scatter"),
            std::string::npos);
}

TEST_F(SpecimenFiles, WhoseGaugesAreNotAsFiledAreNoSpecimen) {
  folder_.write("turned.toml", replaced(kBench, "position_m_sd = 0.0001",
                                        "position_m_sd = 0.0001\ninverted = true"));
  const std::string turned = folder_ / "turned.h5";
  (void)kolsky({"reduce", captures_.front(), "--bench", folder_ / "turned.toml", "--save", turned});
  EXPECT_TRUE(
      refused(kolsky({"identify", "specimen", turned, "--bar-model", folder_ / "pmma.toml"}),
              {"g2 seems to read with the other sign", "inverted"}));
}

TEST_F(SpecimenFiles, GiveANewResultWithACorrectedBenchBesideTheOldOne) {
  folder_.write("corrected.toml", replaced(kBench, "length_m = 0.004", "length_m = 0.005"));
  const std::string& capture = captures_.front();
  const std::string before = bytes_of(capture);
  const std::string saved = folder_ / "corrected.h5";
  const json both = json_of(kolsky(
      {"reduce", capture, "--bench", folder_ / "corrected.toml", "--save", saved, "--json"}));
  const json old = json_of(kolsky({"reduce", capture, "--json"}));
  EXPECT_EQ(bytes_of(capture), before);
  EXPECT_EQ(both["as_filed"]["summary"], old["summary"]);
  EXPECT_EQ(both["as_filed"]["strain"], old["strain"]);
  EXPECT_NEAR(both["summary"]["peak_strain"].get<double>(),
              0.8 * old["summary"]["peak_strain"].get<double>(), 1e-9);
  const json again = json_of(kolsky({"reduce", saved, "--json"}));
  EXPECT_EQ(again["strain"], both["strain"]);
  EXPECT_EQ(again["meta"]["corrected_from"], both["capture"]);
}

TEST_F(SpecimenFiles, GiveTrueValuesInTheirTableToo) {
  const std::string& capture = captures_.front();
  const auto header_and_rows = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{"reduce", capture, "--csv", folder_ / name};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(kolsky(words).code, 0);
    std::ifstream table(folder_ / name);
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(table, line);) {
      std::istringstream cells(line);
      rows.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) {
        rows.back().push_back(cell);
      }
    }
    return rows;
  };
  const auto plain = header_and_rows("plain.csv", {});
  const auto rows = header_and_rows("true.csv", {"--true"});
  ASSERT_EQ(rows.front().size(), plain.front().size() + 2);
  const auto column = [&](const std::string& name) {
    const auto at = std::find(rows.front().begin(), rows.front().end(), name);
    EXPECT_NE(at, rows.front().end()) << name;
    return static_cast<std::size_t>(at - rows.front().begin());
  };
  const std::size_t n = rows.size() / 2;
  const auto number = [&](const std::string& name) { return std::stod(rows[n][column(name)]); };
  EXPECT_NEAR(number("strain_true"), -std::log(1.0 - number("strain")), 1e-12);
  EXPECT_NEAR(number("stress_true_Pa"), number("stress_Pa") * (1.0 - number("strain")), 1e-3);
}

TEST_F(SpecimenFiles, SayHowFarTheyCanBeTrusted) {
  const json told = json_of(kolsky({"reduce", captures_.front(), "--bar-model",
                                    folder_ / "pmma.toml", "--draws", "60", "--json"}));
  const std::size_t count = told["time_s"].size();
  for (const char* name : {"stress_sd_Pa", "stress_low_Pa", "stress_high_Pa", "strain_sd",
                           "strain_rate_sd_per_s", "force_front_sd_N", "force_back_sd_N"}) {
    ASSERT_EQ(told[name].size(), count) << name;
  }
  EXPECT_EQ(told["uncertainty"]["draws"], 60);
  // What bench and bar model file with a deviation, and the 40 kHz of that file, where the band
  // ends though the noise allows more.
  std::set<std::string> sources;
  for (const json& source : told["uncertainty"]["sources"]) {
    sources.insert(source["name"].get<std::string>());
  }
  EXPECT_EQ(sources,
            (std::set<std::string>{"bars.input.diameter_m", "gauges.g2.position_m", "temperature_K",
                                   "bar model, direction 1", "bar model, direction 2",
                                   "bar model, direction 3", "band_limit_Hz"}));
  double share = 0.0;
  for (const json& line : told["budget"]) {
    share += line["peak_stress_Pa"]["share"].get<double>();
  }
  EXPECT_NEAR(share, 1.0, 1e-9);
  EXPECT_EQ(told["quality"]["equilibrium"].size(), count);
  EXPECT_EQ(told["quality"]["quotable"]["any"], true);
  EXPECT_GT(told["quality"]["useful_band_Hz"].get<double>(), 5e3);
}

TEST_F(SpecimenFiles, StressFromOneTwoOrThreeWavesAndCorrected) {
  const auto peak = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"reduce", captures_.front(), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json_of(kolsky(words))["summary"]["peak_stress_Pa"].get<double>();
  };
  const double both = peak({});
  EXPECT_NE(peak({"--stress", "one-wave"}), both);
  EXPECT_NE(peak({"--stress", "two-wave"}), both);
  EXPECT_NE(peak({"--inertia", "both"}), both);
  // Least as engineering figures at little strain: 1 + mu d / 3h is 1.1, and grows with the strain.
  EXPECT_LT(peak({"--friction", "0.1"}), both / 1.1);
  const scene::Answer text = kolsky({"reduce", captures_.front(), "--friction", "0.1"});
  EXPECT_NE(text.out.find("0.1, up to the strain's top"), std::string::npos) << text.out;
}

TEST_F(SpecimenFiles, RefuseABarModelOutsideWhereItWasIdentified) {
  folder_.write("cold.toml", replaced(kPmma, "temperature_K = 296.5", "temperature_K = 285.0"));
  const std::string& capture = captures_.front();
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--bar-model", folder_ / "cold.toml"}),
                      {"cold.toml", "285.0 K", "296.0 K"}));
  EXPECT_TRUE(refused(kolsky(identify({"--bar-model", folder_ / "cold.toml"})), {"285.0 K"}));
  EXPECT_TRUE(refused(kolsky({"model", "new", "--kind", "shpb", "--bench", folder_ / "bench.toml",
                              "--bar-model", folder_ / "cold.toml", "-o", folder_ / "model.toml"}),
                      {"cold.toml", "285.0 K", "296.0 K"}));
  EXPECT_TRUE(refused(
      kolsky({"reduce", capture, "--bar-model", folder_ / "pmma.toml", "--band-limit", "60000"}),
      {"pmma.toml", "40000 Hz", "60000 Hz"}));
  folder_.write("odd.toml", replaced(kPmma, "covariance = [9e10", "covariance = [9e8"));
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--bar-model", folder_ / "odd.toml"}),
                      {"odd.toml", "covariance"}));
}

// Moduli may look like any others: what they were identified from does not.
TEST_F(SpecimenFiles, RefuseOrDoubtABarModelThatWasIdentifiedBadly) {
  const std::string& capture = captures_.front();
  const auto model = [&](const std::string& name, const std::string& line) {
    folder_.write(name, kPmma + line);
    return folder_ / name;
  };
  const std::string growing = model("growing.toml", "passive = false\n");
  const std::vector<std::string> said{"growing.toml", "identified.passive", "grow on their way",
                                      "gauge factors"};
  folder_.write("core.toml",
                "density_kg_m3 = 1140\npoisson_ratio = 0.376\nE1_Pa = 121e6\nE2_Pa = 143e6\n"
                "eta2_Pa_s = 2860\n");
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--bar-model", growing}), said));
  EXPECT_TRUE(refused(kolsky(identify({"--bar-model", growing})), said));
  EXPECT_TRUE(refused(
      kolsky({"plan", "--bench", folder_ / "bench.toml", "--specimen", folder_ / "core.toml",
              "--bar-model", growing, "--pulse-strain", "0.001", "--pulse-duration", "170e-6"}),
      said));
  EXPECT_TRUE(refused(kolsky({"model", "new", "--kind", "shpb", "--bar-model", growing, "-o",
                              folder_ / "model.toml"}),
                      said));

  const std::string poor = model("poor.toml", "chi2_reduced = 872.7\n");
  EXPECT_NE(kolsky({"reduce", capture, "--bar-model", poor}).out.find("873 times what noise does"),
            std::string::npos);
  const json told = json_of(kolsky(identify({"--bar-model", poor, "--json"})));
  EXPECT_NE(told["warnings"].dump().find("873 times what noise does"), std::string::npos)
      << told["warnings"];
  const std::string good = model("good.toml", "chi2_reduced = 1.2\npassive = true\n");
  EXPECT_EQ(kolsky({"reduce", capture, "--bar-model", good}).out.find("times what noise"),
            std::string::npos);
}

// Bars with so much loss leave no specimen that would make these records.
TEST_F(SpecimenFiles, NameTheBarModelWhereTheFitFindsNothing) {
  folder_.write("lossy.toml",
                "density_kg_m3 = 1180.0\npoisson_ratio = 0.36\nE1_Pa = 5.66e9\nE2_Pa = 12e9\n"
                "eta2_Pa_s = 0.3e6\n");
  std::string bench = kBench;
  for (const char* sd :
       {"temperature_K_sd = 0.3\n", "diameter_m_sd = 0.00002\n", "position_m_sd = 0.0001\n"}) {
    bench = replaced(bench, sd, "");
  }
  folder_.write("exact.toml", bench);
  const std::string exact = folder_ / "exact.h5";
  ASSERT_EQ(kolsky({"import", "csv", folder_ / "shot0.csv", "--bench", folder_ / "exact.toml", "-o",
                    exact})
                .code,
            0);
  EXPECT_TRUE(
      refused(kolsky({"identify", "specimen", exact, "--bar-model", folder_ / "lossy.toml"}),
              {"exact.h5", "says nothing of", "check the bar model"}));
}

// Nylon, say: moduli of PMMA would only look like a result.
TEST_F(SpecimenFiles, RefuseBarsOfWhichNoModuliAreKnown) {
  const auto bench_of = [](const char* density) {
    std::string bench = kBench;
    for (const char* bar : {"[bars.input]", "[bars.output]"}) {
      const std::size_t filed = bench.find("density_kg_m3 = 1180.0", bench.find(bar));
      bench.replace(filed, 22, "density_kg_m3 = " + std::string(density));
    }
    return bench;
  };
  const auto import = [&](const std::string& name, const std::string& bench) {
    folder_.write(name + ".toml", bench);
    EXPECT_EQ(kolsky({"import", "csv", folder_ / "shot0.csv", "--bench", folder_ / (name + ".toml"),
                      "-o", folder_ / (name + ".h5")})
                  .code,
              0);
    return folder_ / (name + ".h5");
  };
  const std::string dense = import("dense", bench_of("1290.0"));
  folder_.write("core.toml",
                "density_kg_m3 = 1140\npoisson_ratio = 0.376\nE1_Pa = 121e6\nE2_Pa = 143e6\n"
                "eta2_Pa_s = 2860\n");
  folder_.write("nylon.toml", replaced(kPmma, "1180.0", "1290.0"));
  const auto plan = [&](const std::string& bench, std::vector<std::string> more) {
    std::vector<std::string> words{"plan",
                                   "--bench",
                                   folder_ / (bench + ".toml"),
                                   "--specimen",
                                   folder_ / "core.toml",
                                   "--pulse-strain",
                                   "0.002",
                                   "--pulse-duration",
                                   "170e-6"};
    words.insert(words.end(), more.begin(), more.end());
    return kolsky(words);
  };
  const std::vector<std::string> said{"bars.input.youngs_modulus_Pa", "1290 kg/m3", "9 % denser",
                                      "bar model"};
  EXPECT_TRUE(refused(kolsky({"reduce", dense}), said));
  EXPECT_TRUE(
      refused(kolsky({"reduce", captures_.front(), "--bench", folder_ / "dense.toml"}), said));
  std::vector<std::string> said_of_capture = said;
  said_of_capture.push_back("dense.h5");
  EXPECT_TRUE(refused(kolsky({"identify", "specimen", dense}), said_of_capture));
  EXPECT_TRUE(refused(plan("dense", {}), said));
  const std::string model = folder_ / "model.toml";
  const std::vector<std::string> new_model{
      "model", "new", "--kind", "shpb", "--bench", folder_ / "dense.toml", "-o", model};
  std::vector<std::string> said_of_bench = said;
  said_of_bench.push_back("dense.toml");
  EXPECT_TRUE(refused(kolsky(new_model), said_of_bench));
  EXPECT_TRUE(refused(kolsky({"dispersion", "--bench", folder_ / "dense.toml"}), said_of_bench));
  // With their moduli they are bars like others.
  const std::vector<std::string> known{"--bar-model", folder_ / "nylon.toml"};
  EXPECT_EQ(kolsky({"reduce", dense, known[0], known[1]}).code, 0);
  EXPECT_EQ(kolsky({"identify", "specimen", dense, known[0], known[1]}).code, 0);
  EXPECT_EQ(plan("dense", known).code, 0);
  std::vector<std::string> known_model = new_model;
  known_model.insert(known_model.end(), known.begin(), known.end());
  EXPECT_EQ(kolsky(known_model).code, 0);
  // PMMA is cast at densities some percent apart.
  const std::string near = import("near", bench_of("1220.0"));
  EXPECT_EQ(kolsky({"reduce", near}).code, 0);
  EXPECT_EQ(kolsky({"identify", "specimen", near}).code, 0);
  EXPECT_EQ(plan("near", {}).code, 0);
}

/// An output rod that has aged: its own material stands in the bench, which captures hold.
class UnlikeRodFiles : public SpecimenFiles {
 protected:
  UnlikeRodFiles() { model_.output = {1180.0, 5.0e9, 30.0e9, 2.0e6}; }

  [[nodiscard]] std::string bench_with(const std::string& further = "") const {
    return replaced(kBench, "[[gauges]]",
                    "[bars.output.material]\nsource = \"output rod, shots of May\"\n"
                    "density_kg_m3 = 1180.0\npoisson_ratio = 0.36\nE1_Pa = 5.0e9\n"
                    "E1_Pa_sd = 3e5\nE2_Pa = 30e9\nE2_Pa_sd = 4e7\neta2_Pa_s = 2e6\n" +
                        further + "[[gauges]]");
  }
};

TEST_F(UnlikeRodFiles, AreReducedPlannedAndIdentifiedByEachRodsOwnMaterial) {
  folder_.write("rods.toml", bench_with());
  const std::string rods = folder_ / "rods.toml";
  const std::string corrected = folder_ / "corrected.h5";
  const json told =
      json_of(kolsky({"reduce", captures_.front(), "--bar-model", folder_ / "pmma.toml", "--bench",
                      rods, "--save", corrected, "--json"}));
  EXPECT_NE(told["bar_model"].dump().find("output bar by itself: output rod, shots of May"),
            std::string::npos)
      << told["bar_model"];
  const double alike_Pa = told["as_filed"]["summary"]["peak_stress_Pa"];
  const double stress_Pa = told["summary"]["peak_stress_Pa"];
  EXPECT_GT(std::abs(alike_Pa / stress_Pa - 1.0), 0.04);
  // The rod stays in the capture.
  const json again = json_of(kolsky({"reduce", corrected, "--bar-model", folder_ / "pmma.toml",
                                     "--uncertainty", "--draws", "100", "--json"}));
  EXPECT_EQ(again["stress_Pa"], told["stress_Pa"]);
  EXPECT_NE(again["uncertainty"]["sources"].dump().find("output bar's material"),
            std::string::npos);
  folder_.write("core.toml",
                "density_kg_m3 = 1140\npoisson_ratio = 0.376\nE1_Pa = 121e6\nE2_Pa = 143e6\n"
                "eta2_Pa_s = 2860\n");
  const auto planned = [&](const std::string& bench) {
    return json_of(kolsky({"plan", "--bench", bench, "--specimen", folder_ / "core.toml",
                           "--bar-model", folder_ / "pmma.toml", "--pulse-strain", "0.001",
                           "--pulse-duration", "170e-6", "--rise", "40e-6", "--json"}));
  };
  EXPECT_NE(planned(rods)["peak_stress_Pa"], planned(folder_ / "bench.toml")["peak_stress_Pa"]);
  const json waves = json_of(kolsky({"waves", corrected, "--bar", "output", "--json"}));
  EXPECT_EQ(waves["bar_model"], "output rod, shots of May");
  std::vector<std::string> words{
      "identify", "specimen", corrected, "--bar-model", folder_ / "pmma.toml", "--json"};
  const json fit = json_of(kolsky(words));
  EXPECT_LT(fit["chi2_reduced"], 1.2);
  for (const auto& [name, truth] :
       {std::pair{"E1_Pa", 121e6}, {"E2_Pa", 143e6}, {"eta2_Pa_s", 2860.0}}) {
    const json& own = fit["parameters"][name];
    EXPECT_NEAR(own["value"].get<double>(), truth, 4.0 * own["sd"].get<double>()) << name;
  }
}

TEST_F(UnlikeRodFiles, AreRefusedOutsideWhatTheRodWasIdentifiedInAndWhereOneMaterialIsMeant) {
  folder_.write("cold.toml", bench_with("[bars.output.material.identified]\ntemperature_K = 285.0\n"
                                        "band_limit_Hz = 20e3\n"));
  const std::string cold = folder_ / "cold.toml";
  EXPECT_TRUE(refused(kolsky({"reduce", captures_.front(), "--bench", cold}),
                      {"bars.output.material", "285.0 K", "296.0 K"}));
  folder_.write("rods.toml", bench_with("[bars.output.material.identified]\n"
                                        "temperature_K = 296.0\nband_limit_Hz = 20e3\n"));
  const std::string rods = folder_ / "rods.toml";
  EXPECT_EQ(
      json_of(kolsky({"reduce", captures_.front(), "--bench", rods, "--json"}))["band_limit_Hz"],
      20e3);
  EXPECT_TRUE(
      refused(kolsky({"reduce", captures_.front(), "--bench", rods, "--band-limit", "30e3"}),
              {"bars.output.material", "20000 Hz", "30000 Hz"}));
  const std::vector<std::string> one{"bars.output.material", "one material", "leave it out"};
  EXPECT_TRUE(refused(
      kolsky({"model", "new", "--kind", "shpb", "--bench", rods, "-o", folder_ / "model.toml"}),
      one));
  EXPECT_TRUE(refused(kolsky({"calibrate", captures_.front(), "--bench", rods}),
                      {"bars.output.material", "leave it out"}));
}

/// A core that creeps over two times.
class TwoBranchSpecimenFiles : public SpecimenFiles {
 protected:
  TwoBranchSpecimenFiles() {
    testing::KelvinChain chain = testing::three_element(121e6, 143e6, 2860.0);
    chain.add_relaxation(4e-9, 2e-4);
    model_.chain = chain;
  }
};

TEST_F(TwoBranchSpecimenFiles, AreFiledAsTheSolidThatWasFitted) {
  const std::string file = folder_ / "core.toml";
  const json told = json_of(kolsky(identify({"--bar-model", folder_ / "pmma.toml", "--solid",
                                             "two-kelvin", "--model-out", file, "--json"})));
  const Material filed = read_material(file);
  ASSERT_EQ(filed.solid, SolidKind::two_kelvin);
  ASSERT_TRUE(filed.identified);
  EXPECT_EQ(filed.identified->chi2_reduced, told["chi2_reduced"].get<double>());
  EXPECT_EQ(filed.identified->band_limit_Hz, told["band_limit_Hz"].get<double>());
  for (std::size_t i = 0; i < filed.parameters.size(); ++i) {
    const json& fitted = told["parameters"][parameters_of(filed.solid)[i].name];
    EXPECT_EQ(filed.parameters[i].value, fitted["value"].get<double>());
    EXPECT_NEAR(std::sqrt(filed.covariance->at(6 * i)), fitted["sd"].get<double>(),
                1e-9 * fitted["sd"].get<double>());
  }
  for (const double frequency_Hz : {1e3, 3e3, 8e3}) {
    const Complex s(0.0, 2.0 * std::numbers::pi * frequency_Hz);
    const Complex truth = 1.0 / 121e6 + 1.0 / (143e6 + 2860.0 * s) + 4e-9 / (1.0 + 2e-4 * s);
    EXPECT_LT(std::abs(compliance_of(filed)->at(s) / truth - 1.0), 0.01) << frequency_Hz;
  }
}

TEST_F(SpecimenFiles, RefuseWhatMakesNoSense) {
  const std::string& capture = captures_.front();
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--stress", "four-wave"}), {"three-wave"}));
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--inertia", "all"}), {"--inertia", "radial"}));
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--friction", "3"}), {"--friction"}));
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--band-limit", "9e5"}),
                      {"band_limit_Hz", "not in the record"}));
  EXPECT_TRUE(refused(kolsky({"identify", "specimen", capture, "--band-limit", "9e5"}),
                      {"band_limit_Hz", "not in the record"}));
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--draws", "1"}), {"--draws"}));
  folder_.write("renamed.toml", replaced(kBench, "\"g2\"", "\"h2\""));
  EXPECT_TRUE(refused(kolsky({"reduce", capture, "--bench", folder_ / "renamed.toml"}),
                      {"renamed.toml", "h2", "g2"}));
  EXPECT_TRUE(refused(kolsky({"identify", "specimen"}), {"CAPTURE is missing"}));
  EXPECT_TRUE(refused(kolsky(identify({"--draws", "1"})), {"--draws", "20"}));
  EXPECT_TRUE(refused(kolsky(identify({"--softening", "2"})), {"--softening", "0.003"}));
  folder_.write("core.toml",
                "density_kg_m3 = 1140.0\npoisson_ratio = 0.376\nE1_Pa = 121e6\n"
                "E2_Pa = 143e6\neta2_Pa_s = 2860.0\n");
  EXPECT_TRUE(refused(
      kolsky({"plan", "--bench", folder_ / "bench.toml", "--specimen", folder_ / "core.toml"}),
      {"--striker-speed"}));
  EXPECT_TRUE(refused(kolsky({"plan", "--bench", folder_ / "bench.toml", "--specimen",
                              folder_ / "core.toml", "--striker-speed", "10"}),
                      {"striker"}));
}

}  // namespace
}  // namespace kolsky
