// A bar identified from tables, as a person does it.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "drivers/files/settings/material_file.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/end_to_end/process.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/campaign_files.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::refused;

class IdentifyBar : public ::testing::Test {
 public:
  static constexpr RodMaterial kTruth{1180.0, 5.66e9, 37.0e9, 1.81e6};

 protected:
  IdentifyBar() {
    std::string bench =
        "kind = \"bar\"\nsampling_frequency_Hz = 1e6\npositive = \"compression\"\n"
        "temperature_K = 296.0\n[bars.input]\nlength_m = 2.0\ndiameter_m = 0.02\n"
        "density_kg_m3 = 1180.0\npoisson_ratio = 0.36\n";
    std::string exact = bench;
    for (int j = 0; j < 4; ++j) {
      const std::string gauge = fmt::format(
          "[[gauges]]\nname = \"g{}\"\nbar = \"input\"\nposition_m = {}\nunit = \"V\"\n"
          "strain_per_V = 0.001\n",
          j + 1, 0.1 + 0.2 * j);
      exact += gauge;
      bench += gauge + "position_m_sd = 0.0002\nstrain_per_V_sd = 0.00001\n";
    }
    folder_.write("bench.toml", bench);
    folder_.write("exact.toml", exact);
    testing::BarShots::Setup setup;
    setup.material = kTruth;
    testing::BarShots::Recording recording;
    recording.gain_sd = 0.01;
    recording.position_sd_m = 0.2e-3;
    std::mt19937_64 random(3);
    shots_ = testing::BarShots(setup).draw(3, recording, random);
    for (std::size_t i = 0; i < shots_.size(); ++i) {
      captures_.push_back(imported(shots_[i], fmt::format("shot{}", i + 1), 1.0, "bench.toml"));
    }
  }

  /// @param growth  of each gauge's readings over those of the one before
  std::string imported(const Shot& shot, const std::string& name, double growth,
                       const std::string& bench) {
    std::string table = "time_s,g1,g2,g3,g4\n";
    for (std::size_t n = 0; n < shot.samples(); ++n) {
      table += fmt::format("{:.7f}", static_cast<double>(n) * 1e-6);
      double gain = 1.0;
      for (const ChannelRecord& channel : shot.channels) {
        table += fmt::format(",{:.7e}", gain * channel.value(channel.codes[n]));
        gain *= growth;
      }
      table += "\n";
    }
    folder_.write(name + ".csv", table);
    std::string capture = folder_ / (name + ".h5");
    (void)json_of(scene::kolsky({"import", "csv", folder_ / (name + ".csv"), "--bench",
                                 folder_ / bench, "-o", capture, "--json"}));
    return capture;
  }

  testing::ScratchFolder folder_;
  std::vector<Shot> shots_;
  std::vector<std::string> captures_;
};

TEST_F(IdentifyBar, IsWhatReducingABarPointsToAndItsGaugesAreExported) {
  EXPECT_TRUE(refused(scene::kolsky({"reduce", captures_.front()}),
                      {"kind", "a bar by itself", "kolsky identify bar"}));
  const std::string table = (folder_ / "bar.csv").string();
  const json told = json_of(
      scene::kolsky({"export", captures_.front(), "--format", "csv", "-o", table, "--json"}));
  EXPECT_EQ(told["reducible"], false);
  EXPECT_NE(told["reason"].get<std::string>().find("identify bar"), std::string::npos);
  std::ifstream gauges((folder_ / "bar-gauges.csv").string());
  std::string header;
  std::getline(gauges, header);
  EXPECT_EQ(header.substr(0, 6), "time_s") << header;
  EXPECT_NE(header.find("g4"), std::string::npos) << header;
}

TEST_F(IdentifyBar, FilesThatTheWavesGrow) {
  const std::string growing = imported(shots_.front(), "growing", 1.25, "exact.toml");
  const std::string model = folder_ / "growing.toml";
  const json told =
      json_of(scene::kolsky({"identify", "bar", growing, "--model-out", model, "--json"}));
  EXPECT_EQ(told["passive"], false);
  const Material filed = read_material(model);
  ASSERT_TRUE(filed.identified);
  EXPECT_FALSE(filed.identified->passive);
  EXPECT_EQ(filed.identified->chi2_reduced, told["chi2_reduced"].get<double>());
}

/// One shot of a bar that loses nothing.
Shot elastic_shot() {
  testing::BarShots::Setup elastic;
  elastic.material = {1180.0, 5.66e9};
  std::mt19937_64 random(4);
  return testing::BarShots(elastic).draw(1, {}, random).front();
}

TEST_F(IdentifyBar, FilesABarWithoutLossAsElastic) {
  const std::string capture = imported(elastic_shot(), "elastic", 1.0, "exact.toml");
  const std::string model = folder_ / "elastic.toml";
  (void)json_of(scene::kolsky({"identify", "bar", capture, "--model-out", model, "--json"}));
  const Material filed = read_material(model);
  EXPECT_NEAR(filed.E1_Pa().value, 5.66e9, 3.0 * filed.E1_Pa().sd);
  EXPECT_EQ(filed.E2_Pa().value, kStiffest);
  EXPECT_EQ(filed.E2_Pa().sd, 0.0);
  EXPECT_EQ(filed.eta2_Pa_s().value, kStiffest);
  EXPECT_EQ(filed.eta2_Pa_s().sd, 0.0);
  EXPECT_TRUE(filed.identified->passive);
}

// Of a bar with a dashpot the records of some shots want more than one: an exponent above 1.
TEST_F(IdentifyBar, ShowsWhatItCannotFile) {
  const auto beta_of = [](const std::string& capture) {
    const json told =
        json_of(scene::kolsky({"identify", "bar", capture, "--solid", "fractional", "--json"}));
    return told["solid"]["parameters"]["beta"]["value"].get<double>();
  };
  const auto above_one = std::find_if(captures_.begin(), captures_.end(),
                                      [&](const auto& capture) { return beta_of(capture) > 1.0; });
  ASSERT_NE(above_one, captures_.end());
  const std::string model = folder_ / "unseen.toml";
  const scene::Answer answer =
      scene::kolsky({"identify", "bar", *above_one, "--solid", "fractional", "--model-out", model});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.out.find("beta"), std::string::npos) << answer.out;
  EXPECT_NE(answer.err.find("cannot file this fit: beta"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("fewer parameters"), std::string::npos) << answer.err;
  EXPECT_FALSE(std::filesystem::exists(model));
  // What can be known beforehand is said before any work.
  const scene::Answer nowhere =
      scene::kolsky({"identify", "bar", *above_one, "--model-out", folder_ / "none/unseen.toml"});
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_EQ(nowhere.out, "");
}

TEST_F(IdentifyBar, ASolidThatIsAskedForIsSaidToBe) {
  const json result = json_of(
      scene::kolsky({"identify", "bar", captures_.front(), "--solid", "three-element", "--json"}));
  EXPECT_EQ(result["choice"]["solid"]["asked"], true);
}

/// Creep over two times, which three elements cannot hold.
TEST_F(IdentifyBar, SaysWhatThreeElementsCostAndFilesWhatIsAheadWhereAsked) {
  testing::Campaign campaign = testing::draw_campaign({.seed = 71, .noise_strain = 1e-6});
  testing::plant(campaign.world, testing::parse_effect("second-relaxation=6e-12,tau=3e-4"));
  const std::string capture =
      testing::write_campaign({folder_ / "two", false}, {testing::shots_of(campaign).front()})
          .front()
          .string();
  const std::string model = folder_ / "two.toml";
  const json told =
      json_of(scene::kolsky({"identify", "bar", capture, "--model-out", model, "--json"}));
  const json& better = told["better_solid"];
  EXPECT_EQ(better["solid"], "two-kelvin");
  const auto evidence_of = [&](const char* solid) {
    for (const json& other : told["alternatives"]) {
      if (other["solid"] == solid && other["dispersion"] == told["dispersion"] &&
          other["far_end"] == told["far_end"]) {
        return other["log_evidence"].get<double>();
      }
    }
    return std::nan("");
  };
  const double ahead = evidence_of("two-kelvin") - evidence_of("three-element");
  EXPECT_NEAR(better["log_evidence_ahead"].get<double>(), ahead, 0.02 * ahead);
  EXPECT_LT(better["chi2_reduced"], told["chi2_reduced"]);
  EXPECT_EQ(read_material(model).solid, SolidKind::three_element);
  std::stringstream file;
  file << std::ifstream(model).rdbuf();
  const std::string sentence = "a two-kelvin solid is ahead of the three-element one";
  EXPECT_NE(file.str().find("better_solid = \"" + sentence), std::string::npos) << file.str();
  EXPECT_NE(told["warnings"].dump().find(sentence), std::string::npos) << told["warnings"];
  EXPECT_NE(told["warnings"].dump().find("--solid two-kelvin files it"), std::string::npos);

  for (const char* solid : {"auto", "two-kelvin"}) {
    const std::string own = folder_ / (std::string(solid) + ".toml");
    const json chosen = json_of(scene::kolsky(
        {"identify", "bar", capture, "--solid", solid, "--model-out", own, "--json"}));
    EXPECT_TRUE(chosen["better_solid"].is_null()) << chosen["better_solid"];
    const Material filed = read_material(own);
    EXPECT_EQ(filed.solid, SolidKind::two_kelvin);
    const json& fitted = chosen["solid"];
    ASSERT_EQ(filed.parameters.size(), 5U);
    for (std::size_t i = 0; i < filed.parameters.size(); ++i) {
      const std::string& name = parameters_of(filed.solid)[i].name;
      EXPECT_EQ(filed.parameters[i].value, fitted["parameters"][name]["value"].get<double>());
      EXPECT_EQ(filed.parameters[i].sd, fitted["parameters"][name]["sd"].get<double>());
      EXPECT_EQ(filed.covariance->at(5 * i + 1), fitted["covariance"][i][1].get<double>());
    }
    ASSERT_TRUE(filed.identified);
    EXPECT_EQ(filed.identified->chi2_reduced, fitted["chi2_reduced"].get<double>());
  }
}

TEST_F(IdentifyBar, IsDrawnThroughItsFit) {
  const scene::Answer text =
      scene::kolsky({"identify", "bar", captures_[0], captures_[1], "--draws", "20"});
  EXPECT_NE(text.out.find("by 20 draws"), std::string::npos) << text.out << text.err;
  const json told = json_of(
      scene::kolsky({"identify", "bar", captures_[0], captures_[1], "--draws", "20", "--json"}));
  const json& drawn = told["draws"]["parameters"]["E1_Pa"];
  const double stated = told["parameters"]["E1_Pa"]["sd"];
  EXPECT_NEAR(drawn["sd"].get<double>(), stated, 0.6 * stated);
  EXPECT_LT(drawn["low"].get<double>(), drawn["value"].get<double>());
  EXPECT_GT(drawn["high"].get<double>(), drawn["value"].get<double>());
}

TEST_F(IdentifyBar, FindsTheBarAndFilesIt) {
  std::vector<std::string> words = {"identify", "bar"};
  words.insert(words.end(), captures_.begin(), captures_.end());
  const std::string model = (folder_ / "pmma.toml").string();
  words.insert(words.end(), {"--model-out", model, "--json", "--waveforms"});
  const json result = json_of(scene::kolsky(words));
  const double truth[3] = {kTruth.E1_Pa, kTruth.E2_Pa, kTruth.eta2_Pa_s};
  const char* const names[3] = {"E1_Pa", "E2_Pa", "eta2_Pa_s"};
  for (std::size_t i = 0; i < 3; ++i) {
    const json& p = result["parameters"][names[i]];
    EXPECT_NEAR(p["value"].get<double>(), truth[i], 4.0 * p["sd"].get<double>()) << names[i];
    EXPECT_LT(p["sd"].get<double>(), 2e-3 * truth[i]);
  }
  EXPECT_EQ(result["dispersion"], "elementary");
  EXPECT_TRUE(result["better_solid"].is_null()) << result["better_solid"];
  EXPECT_EQ(result["far_end"], "free");
  EXPECT_GE(result["alternatives"].size(), 5U);
  const std::size_t bins = result["spectrum"]["frequency_Hz"].size();
  for (const char* name :
       {"J1_per_Pa", "J1_sd", "J2_per_Pa", "J2_sd", "alpha_per_m", "wavenumber_per_m"}) {
    EXPECT_EQ(result["spectrum"][name].size(), bins) << name;
  }
  EXPECT_EQ(result["choice"]["solid"]["asked"], false);
  const json& correlation = result["correlation"];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(correlation[i][i].get<double>(), 1.0, 1e-12);
    const double sd = result["parameters"][names[i]]["sd"].get<double>();
    EXPECT_NEAR(std::sqrt(result["covariance"][i][i].get<double>()) / sd, 1.0, 1e-9);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NEAR(correlation[i][j].get<double>(), correlation[j][i].get<double>(), 1e-9);
      EXPECT_LT(std::abs(correlation[i][j].get<double>()), 1.0);
      const double of_both = result["covariance"][i][j].get<double>() / sd /
                             result["parameters"][names[j]]["sd"].get<double>();
      EXPECT_NEAR(correlation[i][j].get<double>(), of_both, 1e-9);
    }
  }
  EXPECT_EQ(result["waveforms"].size(), 3U);
  EXPECT_EQ(result["waveforms"][0]["gauges"].size(), 3U);

  const Material filed = read_material(model);
  EXPECT_EQ(filed.E1_Pa().value, result["parameters"]["E1_Pa"]["value"].get<double>());
  EXPECT_EQ(filed.E1_Pa().sd, result["parameters"]["E1_Pa"]["sd"].get<double>());
}

/// A bar that is struck at one end and has one gauge, its length as well known as a tape measures.
class IdentifyBarByOneGauge : public ::testing::Test {
 protected:
  std::string capture(double position_m) {
    folder_.write("bench.toml",
                  fmt::format("kind = \"bar\"\nsampling_frequency_Hz = 1e6\n"
                              "positive = \"compression\"\n[bars.input]\nlength_m = 2.0\n"
                              "length_m_sd = 0.0005\ndiameter_m = 0.02\ndensity_kg_m3 = 1180.0\n"
                              "poisson_ratio = 0.36\n[[gauges]]\nname = \"only\"\n"
                              "bar = \"input\"\nposition_m = {}\nunit = \"V\"\n"
                              "strain_per_V = 0.001\n",
                              position_m));
    testing::BarShots::Setup setup;
    setup.material = IdentifyBar::kTruth;
    setup.position_m = {position_m};
    setup.post_samples = 2000;
    std::mt19937_64 random(4);
    const Shot shot = testing::BarShots(setup).draw(1, {}, random).front();
    std::string table = "time_s,only\n";
    for (std::size_t n = 0; n < shot.samples(); ++n) {
      const ChannelRecord& channel = shot.channels.front();
      table += fmt::format("{:.7f},{:.7e}\n", static_cast<double>(n) * 1e-6,
                           channel.value(channel.codes[n]));
    }
    folder_.write("shot.csv", table);
    std::string path = (folder_ / "shot.h5").string();
    (void)json_of(scene::kolsky({"import", "csv", (folder_ / "shot.csv").string(), "--bench",
                                 folder_ / "bench.toml", "-o", path, "--json"}));
    return path;
  }

  testing::ScratchFolder folder_;
};

TEST_F(IdentifyBarByOneGauge, FindsTheBarFromThePulseAndItsReturn) {
  const json result =
      json_of(scene::kolsky({"identify", "bar", capture(1.0), "--json", "--waveforms"}));
  EXPECT_TRUE(result["two_passes"].get<bool>());
  EXPECT_EQ(result["far_end"], "free");
  const json& E1 = result["parameters"]["E1_Pa"];
  EXPECT_NEAR(E1["value"].get<double>(), 5.66e9, 4.0 * E1["sd"].get<double>());
  // 1 mm of 2 m, twice over in the modulus.
  EXPECT_NEAR(E1["sd"].get<double>() / 5.66e9, 1e-3, 1e-4);
  EXPECT_TRUE(result["waveforms"][0]["gauges"].contains("only returned"));
}

TEST_F(IdentifyBarByOneGauge, SaysHowFarFromTheEndsItWouldServe) {
  EXPECT_TRUE(
      refused(scene::kolsky({"identify", "bar", capture(0.05)}), {"only", "behind that end"}));
}

TEST_F(IdentifyBar, RefusesWhatCannotServe) {
  EXPECT_TRUE(
      refused(scene::kolsky({"identify", "bar", captures_[0], "--solid", "rubber"}), {"rubber"}));
  EXPECT_TRUE(refused(scene::kolsky({"identify", "bar", captures_[0], "--band-limit", "-3"}),
                      {"--band-limit"}));
  EXPECT_TRUE(
      refused(scene::kolsky({"identify", "bar", (folder_ / "none.h5").string()}), {"none.h5"}));
  // What is wrong with all of them is said after the first's name and how many more there are.
  EXPECT_TRUE(refused(scene::kolsky({"identify", "bar", captures_[0], captures_[1], captures_[2],
                                     "--band-limit", "400e3"}),
                      {captures_[0] + " and 2 more: band limit"}));
}

TEST_F(IdentifyBar, ABarIsNotTakenForASpecimen) {
  EXPECT_TRUE(refused(scene::kolsky({"identify", "specimen", captures_.front()}),
                      {captures_.front() + ": kind", "is not \"shpb\"", "kolsky identify bar"}));
}

}  // namespace
}  // namespace kolsky
