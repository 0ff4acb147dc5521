// The commands that work on files, as a person runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "clients/terminal/terminal.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/end_to_end/process.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::Answer;
using scene::json_of;
using scene::lines_of;

class Files : public ::testing::Test {
 protected:
  scene::Bench bench_;
};

std::string first_bytes(const std::string& path, std::size_t count) {
  std::string bytes(count, '\0');
  std::ifstream(path, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(count));
  return bytes;
}

TEST_F(Files, ImportTellsWhatItStored) {
  const json told =
      json_of(scene::kolsky({"import", "csv", bench_.file("shot.csv"), "--bench",
                             bench_.file("bench.toml"), "-o", bench_.file("shot.h5"), "--meta",
                             "striker_speed_m_per_s=12.5", "operator=me=you", "--json"}));
  EXPECT_EQ(told["capture"], std::filesystem::canonical(bench_.file("shot.h5")).string());
  EXPECT_EQ(told["samples"], 1500);
  EXPECT_EQ(told["channels"], (json{"g1", "g2"}));
  EXPECT_EQ(told["sampling_frequency_Hz"], 1e6);

  const json reduced = json_of(scene::kolsky({"reduce", bench_.file("shot.h5"), "--json"}));
  EXPECT_EQ(reduced["meta"]["striker_speed_m_per_s"], "12.5");
  EXPECT_EQ(reduced["meta"]["operator"], "me=you");
}

TEST_F(Files, ReduceGivesTheHistoriesOfTheSpecimen) {
  const json result = json_of(scene::kolsky({"reduce", bench_.capture(), "--json"}));
  EXPECT_EQ(result["quality"]["reducible"], true);
  EXPECT_EQ(result["quality"]["reason"], "");
  const auto time = result["time_s"].get<std::vector<double>>();
  ASSERT_GT(time.size(), 100U);
  for (const char* name : {"stress_Pa", "strain", "strain_rate_per_s", "force_front_N",
                           "force_back_N", "incident", "reflected", "transmitted"}) {
    EXPECT_EQ(result[name].get<std::vector<double>>().size(), time.size()) << name;
  }
  // Against the time-domain solution: a spring of 2 GPa, of which these are the model's own
  // histories.
  const auto& truth = bench_.records().truth;
  const auto force = result["force_back_N"].get<std::vector<double>>();
  const auto strain = result["strain"].get<std::vector<double>>();
  for (std::size_t i = 20; i < 120; i += 10) {
    const double t = time[i] + result["arrival_s"].get<double>() - truth.arrival_s;
    EXPECT_NEAR(force[i], truth.at(truth.force_N, t), 100.0) << i;
    EXPECT_NEAR(strain[i], truth.at(truth.strain, t), 1e-3) << i;
  }
}

TEST_F(Files, ReduceJudgesEachCheckWithItsNumbers) {
  const json quality = json_of(scene::kolsky({"reduce", bench_.capture(), "--json"}))["quality"];
  EXPECT_TRUE(quality["verdict"] == "pass" || quality["verdict"] == "warn" ||
              quality["verdict"] == "fail");
  for (const char* name :
       {"equilibrium", "signal_to_noise", "window_overlap", "clipping", "loop_closure"}) {
    ASSERT_TRUE(quality["checks"].contains(name)) << name;
    const json& check = quality["checks"][name];
    EXPECT_TRUE(check["value"].is_number()) << name;
    EXPECT_TRUE(check["limit"].is_number()) << name;
    EXPECT_FALSE(check["unit"].get<std::string>().empty()) << name;
    EXPECT_FALSE(check["text"].get<std::string>().empty()) << name;
  }
}

TEST_F(Files, TrueValuesFollowFromTheEngineeringOnes) {
  const std::string capture = bench_.capture();
  const json result = json_of(scene::kolsky({"reduce", capture, "--json", "--true"}));
  const auto strain = result["strain"].get<std::vector<double>>();
  const auto stress = result["stress_Pa"].get<std::vector<double>>();
  const auto strain_true = result["strain_true"].get<std::vector<double>>();
  const auto stress_true = result["stress_true_Pa"].get<std::vector<double>>();
  ASSERT_EQ(strain_true.size(), strain.size());
  ASSERT_EQ(stress_true.size(), strain.size());
  for (std::size_t i = 0; i < strain.size(); ++i) {
    // A cylinder that keeps its volume: as much longer as it is thinner.
    EXPECT_NEAR(std::exp(-strain_true[i]), 1.0 - strain[i], 1e-12);
    EXPECT_NEAR(stress_true[i] / (1.0 - strain[i]), stress[i], 1e-12 * std::abs(stress[i]));
  }
  EXPECT_FALSE(json_of(scene::kolsky({"reduce", capture, "--json"})).contains("strain_true"));
}

TEST_F(Files, ReduceSaysWhichBarModelItUsed) {
  const std::string capture = bench_.capture();
  const json elastic = json_of(scene::kolsky({"reduce", capture, "--json"}));
  EXPECT_EQ(elastic["bar_model_assumed"], false);
  EXPECT_NE(elastic["bar_model"].get<std::string>().find("elastic"), std::string::npos);
}

TEST_F(Files, ReduceObeysItsOptions) {
  const std::string capture = bench_.capture();
  const json result = json_of(scene::kolsky({"reduce", capture, "--json", "--band-limit", "50e3",
                                             "--duration", "2e-4", "--arrival", "3e-4"}));
  EXPECT_EQ(result["band_limit_Hz"], 50e3);
  EXPECT_NEAR(result["time_s"].get<std::vector<double>>().back(), 2e-4, 2e-6);
}

TEST_F(Files, ReduceTakesAWaveTheoryAndRefusesWhatIsNone) {
  const std::string capture = bench_.capture();
  const auto strain = [&](const std::string& theory) {
    return json_of(scene::kolsky({"reduce", capture, "--json", "--dispersion", theory}))["strain"];
  };
  EXPECT_EQ(strain("elementary"), json_of(scene::kolsky({"reduce", capture, "--json"}))["strain"]);
  EXPECT_NE(strain("exact"), strain("elementary"));
  EXPECT_TRUE(scene::refused(scene::kolsky({"reduce", capture, "--dispersion", "Rayleigh"}),
                             {"--dispersion", "Rayleigh", "{elementary,love,exact}"}));
}

TEST_F(Files, ReduceTellsWavesApartByTwoGaugesWhereThePulseOutlastsTheWindow) {
  testing::ElasticShpb model;
  model.pulse_s = 500e-6;  // the specimen answers at g1 after 195 us
  model.rise_s = 40e-6;
  model.duration_s = 2e-3;
  model.second_to_A_m = 0.8;
  const scene::Bench bench(model);
  const std::string capture = bench.capture();
  const auto off = [&](const json& result) {
    const auto& truth = bench.records().truth;
    const auto time = result["time_s"].get<std::vector<double>>();
    const auto strain = result["strain"].get<std::vector<double>>();
    double worst = 0.0;
    double largest = 0.0;
    for (std::size_t n = 0; n < time.size(); ++n) {
      const double t = time[n] + result["arrival_s"].get<double>() - truth.arrival_s;
      const double exact = truth.at(truth.strain, std::max(0.0, t));
      worst = std::max(worst, std::abs(strain[n] - exact));
      largest = std::max(largest, exact);
    }
    return worst / largest;
  };
  const json separated = json_of(scene::kolsky({"reduce", capture, "--json"}));
  EXPECT_EQ(separated["separation"], "gauges");
  const json& checks = separated["quality"]["checks"];
  EXPECT_EQ(checks["window_overlap"]["verdict"], "pass");
  EXPECT_NE(checks["window_overlap"]["text"].get<std::string>().find("told apart by g1 and g3"),
            std::string::npos);
  EXPECT_NE(checks["separated_noise"]["text"].get<std::string>().find("blind at"),
            std::string::npos);
  EXPECT_LT(off(separated), 5e-3);
  const json by_time = json_of(scene::kolsky({"reduce", capture, "--json", "--separate", "never"}));
  EXPECT_EQ(by_time["separation"], "never");
  EXPECT_EQ(by_time["quality"]["checks"]["window_overlap"]["verdict"], "fail");
  EXPECT_GT(off(by_time), 0.1);
  EXPECT_FALSE(by_time["quality"]["checks"].contains("separated_noise"));
  EXPECT_EQ(json_of(scene::kolsky({"reduce", capture, "--json", "--separate", "gauges"}))["strain"],
            separated["strain"]);
}

TEST_F(Files, ReduceRefusesToTellWavesApartByOneGauge) {
  const std::string capture = bench_.capture();
  EXPECT_TRUE(scene::refused(scene::kolsky({"reduce", capture, "--separate", "gauges"}),
                             {"shot.h5", "gauges", "one place", "equilibrium"}));
  EXPECT_TRUE(scene::refused(scene::kolsky({"reduce", capture, "--separate", "hope"}),
                             {"\"hope\"", "auto, never, gauges or equilibrium"}));
  const json assumed =
      json_of(scene::kolsky({"reduce", capture, "--json", "--separate", "equilibrium"}));
  EXPECT_EQ(assumed["force_front_N"], assumed["force_back_N"]);
  EXPECT_EQ(assumed["quality"]["checks"]["equilibrium"]["verdict"], "warn");
}

TEST_F(Files, TheSameCaptureGivesTheSameBytes) {
  const std::string capture = bench_.capture();
  EXPECT_EQ(scene::kolsky({"reduce", capture, "--json"}).out,
            scene::kolsky({"reduce", capture, "--json"}).out);
}

TEST_F(Files, ReduceDrawsForPeopleInEightyPlainColumns) {
  const Answer answer = scene::kolsky({"reduce", bench_.capture()});
  EXPECT_EQ(answer.code, 0) << answer.err;
  for (const char* wanted : {"peak stress", "MPa", "verdict", "equilibrium", "stress [MPa]",
                             "strain [%]", "force [kN]", "time [µs]", "front", "back"}) {
    EXPECT_NE(answer.out.find(wanted), std::string::npos) << wanted;
  }
  EXPECT_EQ(answer.out.find('\x1b'), std::string::npos) << "colour in a pipe";
  bool plotting = false;
  std::size_t widest = 0;
  for (const std::string& line : lines_of(answer.out)) {
    plotting = plotting || line.starts_with("stress [");
    widest = plotting ? std::max(widest, columns_of(line)) : widest;
  }
  EXPECT_EQ(widest, 80U);
}

TEST_F(Files, ReduceWritesAWellFormedPageOfPlots) {
  const Answer answer =
      scene::kolsky({"reduce", bench_.capture(), "--svg", bench_.file("shot.svg"), "--json"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  const std::string check =
      "import sys, xml.etree.ElementTree as tree\n"
      "root = tree.parse(sys.argv[1]).getroot()\n"
      "ns = '{http://www.w3.org/2000/svg}'\n"
      "assert root.tag == ns + 'svg'\n"
      "words = [t.text for t in root.iter(ns + 'text')]\n"
      "for word in ('stress [MPa]', 'force [kN]', 'strain rate [1/s]', 'bar strain "
      "[microstrain]'):\n"
      "    assert word in words, word\n"
      "assert len(list(root.iter(ns + 'path'))) == 7\n";  // loop, two forces, rate, three waves
  scene::Process python({"/usr/bin/python3", "-c", check, bench_.file("shot.svg")},
                        bench_.file("python"));
  EXPECT_EQ(python.wait(std::chrono::seconds(30)), 0) << python.output();
}

TEST_F(Files, ReduceAndExportWriteTheSameTable) {
  const std::string capture = bench_.capture();
  EXPECT_EQ(scene::kolsky({"reduce", capture, "--csv", bench_.file("a.csv")}).code, 0);
  const json told = json_of(
      scene::kolsky({"export", capture, "--format", "csv", "-o", bench_.file("b.csv"), "--json"}));
  EXPECT_EQ(told["reducible"], true);
  std::ifstream a(bench_.file("a.csv"));
  std::ifstream b(bench_.file("b.csv"));
  const std::string text_a{std::istreambuf_iterator<char>(a), {}};
  const std::string text_b{std::istreambuf_iterator<char>(b), {}};
  EXPECT_EQ(text_a, text_b);
  EXPECT_TRUE(text_a.starts_with("time_s,stress_Pa,strain,"));
  EXPECT_TRUE(std::filesystem::exists(bench_.file("b-gauges.csv")));
}

TEST_F(Files, ExportsForMatlabAndHdf5) {
  const std::string capture = bench_.capture();
  EXPECT_EQ(scene::kolsky({"export", capture, "--format", "mat", "-o", bench_.file("s.mat")}).code,
            0);
  EXPECT_EQ(first_bytes(bench_.file("s.mat"), 10), "MATLAB 5.0");
  EXPECT_EQ(
      scene::kolsky({"export", capture, "--format", "hdf5", "-o", bench_.file("s.hdf5")}).code, 0);
  EXPECT_EQ(first_bytes(bench_.file("s.hdf5"), 4), "\x89HDF");
}

/// The commands that an overview lists: "  import csv         make a capture ...".
std::vector<std::string> listed(const std::string& overview) {
  std::vector<std::string> names;
  for (const std::string& line : lines_of(overview)) {
    const std::size_t gap = line.find("  ", 2);
    if (line.starts_with("  ") && gap != std::string::npos) {
      names.push_back(line.substr(2, gap - 2));
    }
  }
  return names;
}

std::vector<std::string> words_of(const std::string& name) {
  const std::size_t space = name.find(' ');
  return space == std::string::npos ? std::vector{name}
                                    : std::vector{name.substr(0, space), name.substr(space + 1)};
}

TEST(Help, TeachesEveryCommand) {
  const Answer overview = scene::kolsky({"--help"});
  EXPECT_EQ(overview.code, 0);
  const std::vector<std::string> names = listed(overview.out);
  for (const char* known : {"import csv", "identify specimen", "reduce", "model new", "status"}) {
    EXPECT_NE(std::find(names.begin(), names.end(), known), names.end()) << known;
  }
  for (const std::string& name : names) {
    std::vector<std::string> words = words_of(name);
    words.emplace_back("--help");
    const Answer help = scene::kolsky(words);
    EXPECT_EQ(help.code, 0) << name;
    EXPECT_EQ(help.err, "") << name;
    EXPECT_NE(help.out.find("Examples:\n  kolsky " + name), std::string::npos) << name;
    EXPECT_NE(help.out.find("--json"), std::string::npos) << name;
    for (const std::string& line : lines_of(help.out)) {
      EXPECT_LE(columns_of(line), 110U) << name << ": " << line;
    }
  }
  EXPECT_TRUE(scene::kolsky({"--version"}).out.starts_with("kolsky "));
}

TEST(Help, ListsTheCommandsThatBeginWithAWord) {
  const Answer model = scene::kolsky({"model", "--help"});
  EXPECT_EQ(model.code, 0);
  EXPECT_EQ(listed(model.out),
            (std::vector<std::string>{"model new", "model add", "model remove", "model show",
                                      "model history", "model revert", "model check", "model diff",
                                      "model waterfall"}));
  const Answer unknown = scene::kolsky({"modle", "--help"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(lines_of(unknown.err).size(), 1U);
}

}  // namespace
}  // namespace kolsky
