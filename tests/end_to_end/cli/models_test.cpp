// From a model's first form to the noise, as a user goes there.
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/reference_effects.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::kolsky;
using scene::refused;

std::string content(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Shots of a simulated bar of which gauge g3 is recorded 3.6 us late, and a model of it.
class SimulatedBar : public ::testing::Test {
 protected:
  SimulatedBar() {
    EXPECT_EQ(
        kolsky({"tour", "--seed", "3", "--quick", "--shots-only", "--folder", folder_ / "campaign"})
            .code,
        0);
    std::filesystem::create_directory(folder_ / "shots");
    for (const char* shot : {"shot01", "shot02", "shot03", "shot04"}) {
      EXPECT_EQ(
          kolsky({"import", "csv", file(std::string("campaign/") + shot + ".csv"), "--bench",
                  file("campaign/bench.toml"), "-o", file(std::string("shots/") + shot + ".h5")})
              .code,
          0);
    }
    EXPECT_EQ(kolsky({"model", "new", "--kind", "bar", "--bench", file("campaign/bench.toml"), "-o",
                      file("m.toml")})
                  .code,
              0);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }

  testing::ScratchFolder folder_;
};

TEST_F(SimulatedBar, FallsToTheNoiseByTheEffectAddedByHand) {
  ASSERT_EQ(kolsky({"model", "add", file("m.toml"), "channel-delay:g3", "-o", file("m1.toml"),
                    "--note", "the long cable"})
                .code,
            0);
  ASSERT_EQ(kolsky({"fit", file("shots"), "--model", file("m1.toml"), "-o", file("m2.toml")}).code,
            0);
  const json fall = json_of(kolsky({"model", "waterfall", file("m2.toml"), file("shots"), "--json",
                                    "--report", file("fall.html"), "--svg", file("fall.svg")}));
  ASSERT_EQ(fall["steps"].size(), 2U);
  EXPECT_EQ(fall["steps"][0]["effect"], "");
  EXPECT_EQ(fall["steps"][1]["effect"], "channel-delay:g3");
  EXPECT_GT(fall["steps"][0]["held_out"], fall["steps"][1]["held_out"]);
  EXPECT_NEAR(fall["steps"][1]["held_out"], fall["floor"], 0.1);
  EXPECT_GT(fall["closed"], 0.7);
  // Nothing more is found then, and the report says of no misfit that it falls.
  ASSERT_EQ(kolsky({"diagnose", file("shots"), "--model", file("m2.toml"), "--report",
                    file("nothing.html")})
                .code,
            0);
  const std::string page = content(file("nothing.html"));
  EXPECT_NE(page.find("stays so as no effect is added"), std::string::npos);
  EXPECT_EQ(page.find("falls from"), std::string::npos);
  // What the simulation was drawn with.
  const json delay = fall["steps"][1]["strengths"]["tau"];
  const json truth = json_of(kolsky({"tour", "--seed", "3", "--quick", "--truth-only", "--json"}));
  ASSERT_EQ(truth["truth"]["effect"], "channel-delay:g3");
  EXPECT_NEAR(delay["value"].get<double>(), truth["truth"]["strength"].get<double>(),
              4.0 * delay["sd"].get<double>());
  EXPECT_NE(content(file("fall.html")).find("<svg class=\"cascade\""), std::string::npos);
  EXPECT_NE(content(file("fall.svg")).find("+ channel-delay:g3"), std::string::npos);

  const json history = json_of(kolsky({"model", "history", file("m2.toml"), "--json"}))["history"];
  ASSERT_EQ(history.size(), 2U);
  EXPECT_EQ(history[0]["note"], "the long cable");
  EXPECT_EQ(history[0]["added"], json({"channel-delay:g3"}));
  EXPECT_EQ(history[1]["fit"]["captures"], 4);
  EXPECT_EQ(history[1]["data_sha256"].get<std::string>().size(), 64U);

  const json difference =
      json_of(kolsky({"model", "diff", file("m2.toml") + "@0", file("m2.toml"), "--json"}));
  EXPECT_NE(std::find(difference["added"].begin(), difference["added"].end(), "channel-delay:g3"),
            difference["added"].end());
  const scene::Answer same = kolsky({"model", "diff", file("m2.toml"), file("m2.toml")});
  EXPECT_EQ(same.out, "the two models are the same\n");
}

// `diagnose` may claim a number that the bench files: it is in the model already, held by that.
TEST_F(SimulatedBar, FreesAFiledNumberOfWhatIsFiledWhenItIsAdded) {
  const std::string model = file("filed.toml");
  const std::string id = "gauge-position:g2";
  ASSERT_EQ(kolsky({"model", "add", file("m.toml"), id, "-o", model}).code, 0);
  EXPECT_TRUE(refused(kolsky({"model", "add", model, id}), {id, "is in the model already"}));
  std::string text = content(model);
  const std::string number = "[effects.parameters.delta]\n";
  ASSERT_NE(text.find(number), std::string::npos);
  text.insert(text.find(number) + number.size(), "prior_mean = 0.0\nprior_sd = 5e-4\n");
  std::ofstream(model) << text;
  EXPECT_TRUE(refused(kolsky({"model", "add", model, id, "--note", std::string(1001, 'x')}),
                      {"--note", "1000"}));
  const scene::Answer freed = kolsky({"model", "add", model, id});
  ASSERT_EQ(freed.code, 0) << freed.err;
  EXPECT_NE(freed.out.find("freed of what the bench files"), std::string::npos) << freed.out;
  const std::string after = content(model);
  const std::string now = after.substr(0, after.find("[[history]]"));
  EXPECT_EQ(now.find("prior_sd"), std::string::npos) << now;
  EXPECT_NE(now.find(id), std::string::npos);
}

TEST_F(SimulatedBar, IsEditedByHandAndSaysSo) {
  const std::string model = file("edited.toml");
  ASSERT_EQ(
      kolsky({"model", "add", file("m.toml"), "temperature", "-o", model, "--note", "two\nlines"})
          .code,
      0);
  EXPECT_EQ(kolsky({"model", "check", model}).out.find("by hand"), std::string::npos);
  std::string text = content(model);
  const std::size_t at = text.find("value = ") + 8;
  text.replace(at, text.find('\n', at) - at, "5.5e9");
  std::ofstream(model) << text;
  for (const char* command : {"check", "show", "history"}) {
    const scene::Answer told = kolsky({"model", command, model});
    EXPECT_NE(told.out.find("edited by hand after step 1"), std::string::npos) << told.out;
    EXPECT_EQ(json_of(kolsky({"model", command, model, "--json"}))["edited_by_hand"], true);
  }
  ASSERT_EQ(kolsky({"model", "add", model, "crosstalk:g2"}).code, 0);
  const json steps = json_of(kolsky({"model", "history", model, "--json"}))["history"];
  EXPECT_EQ(steps[0]["edited_by_hand"], false);
  EXPECT_EQ(steps[1]["edited_by_hand"], true);
  const scene::Answer told = kolsky({"model", "history", model});
  EXPECT_NE(told.out.find("      two\n      lines\n"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("had been edited by hand"), std::string::npos) << told.out;
  EXPECT_EQ(told.out.find("edited by hand after"), std::string::npos) << told.out;
}

TEST_F(SimulatedBar, DiffersByAFormulaToo) {
  const auto with_formula = [&](const std::string& name, const std::string& formula) {
    std::ofstream(file(name)) << content(file("m.toml"))
                              << "\n[[expressions]]\nid = \"mine\"\nstage = \"sensor\"\n"
                                 "formula = \"" +
                                     formula +
                                     "\"\n[expressions.parameters.c]\nunit = \"-\"\n"
                                     "null = 0.0\nbounds = [-0.1, 0.1]\ntypical = 0.01\n";
  };
  with_formula("one.toml", "1 + c");
  with_formula("two.toml", "1 + 2*c");
  const scene::Answer told = kolsky({"model", "diff", file("one.toml"), file("two.toml")});
  EXPECT_NE(told.out.find("expression mine: 1 + c -> 1 + 2*c"), std::string::npos) << told.out;
  EXPECT_EQ(told.out.find("the same"), std::string::npos) << told.out;
  const json told_json =
      json_of(kolsky({"model", "diff", file("m.toml"), file("two.toml"), "--json"}));
  EXPECT_EQ(told_json["expressions"][0]["before"], nullptr);
  EXPECT_EQ(told_json["expressions"][0]["after"], "1 + 2*c");
  EXPECT_EQ(kolsky({"model", "diff", file("two.toml"), file("two.toml")}).out,
            "the two models are the same\n");
}

// Bounds, priors and which shots share a number have no line of their own.
TEST_F(SimulatedBar, DoesNotPassForTheSameWhereOnlyABoundDiffers) {
  std::string text = content(file("m.toml"));
  const std::size_t at = text.find("value = ");
  std::ofstream(file("bound.toml")) << text.insert(at, "bounds = [1e9, 9e9]\n");
  const scene::Answer told = kolsky({"model", "diff", file("m.toml"), file("bound.toml")});
  EXPECT_NE(told.out.find("the two models differ in"), std::string::npos) << told.out;
}

TEST_F(SimulatedBar, GoesBackStepByStepAndToAnyStep) {
  const std::string model = file("walk.toml");
  std::filesystem::copy_file(file("m.toml"), model);
  for (const char* id : {"temperature", "crosstalk:g2"}) {
    const scene::Answer added = kolsky({"model", "add", model, id});
    ASSERT_EQ(added.code, 0);
    EXPECT_NE(added.out.find(id), std::string::npos);
    EXPECT_EQ(added.out.find("three-element-bar"), std::string::npos) << added.out;
  }
  const auto same = [&](const std::string& step) {
    return kolsky({"model", "diff", model, model + "@" + step}).out ==
           "the two models are the same\n";
  };
  ASSERT_EQ(kolsky({"model", "revert", model}).code, 0);
  EXPECT_TRUE(same("1"));
  ASSERT_EQ(kolsky({"model", "revert", model}).code, 0);
  EXPECT_TRUE(same("0"));
  EXPECT_TRUE(refused(kolsky({"model", "revert", model}), {"is as it began", "--to"}));
  ASSERT_EQ(kolsky({"model", "revert", model, "--to", "2"}).code, 0);
  EXPECT_TRUE(same("2"));
  EXPECT_EQ(kolsky({"model", "show", model + "@2"}).out.substr(model.size() + 2),
            kolsky({"model", "show", model}).out.substr(model.size()));
  EXPECT_TRUE(refused(kolsky({"model", "revert", model, "--to", "9"}),
                      {"walk.toml", "step 9", "from 0 to 5"}));
  EXPECT_TRUE(refused(kolsky({"compare", file("shots"), "--model", model + "@9"}), {"@9"}));
}

TEST_F(SimulatedBar, BeginsAModelOfTheKindThatABenchHas) {
  const std::string bench = file("campaign/bench.toml");
  ASSERT_EQ(
      kolsky({"model", "new", "--kind", "bar", "--bench", bench, "-o", file("said.toml")}).code, 0);
  ASSERT_EQ(kolsky({"model", "new", "--bench", bench, "-o", file("read.toml")}).code, 0);
  EXPECT_EQ(content(file("read.toml")), content(file("said.toml")));
  EXPECT_TRUE(refused(kolsky({"model", "new", "-o", file("x.toml")}), {"--kind", "--bench"}));
  EXPECT_TRUE(
      refused(kolsky({"model", "new", "--kind", "shpb", "--bench", bench, "-o", file("x.toml")}),
              {"bench.toml: kind", "give --kind bar"}));
}

TEST_F(SimulatedBar, KeepsAModelWithAHistoryWhoseNameANewOneTakes) {
  const std::string model = file("again.toml");
  const std::vector<std::string> anew{
      "model", "new", "--kind", "bar", "--bench", file("campaign/bench.toml"), "-o", model};
  ASSERT_EQ(kolsky(anew).code, 0);
  ASSERT_EQ(kolsky(anew).code, 0);
  EXPECT_FALSE(std::filesystem::exists(file("again.1.toml"))) << "there was no history to keep";
  for (const char* kept : {"again.1.toml", "again.2.toml"}) {
    ASSERT_EQ(kolsky({"model", "add", model, "temperature"}).code, 0);
    const std::string old = content(model);
    const scene::Answer answer = kolsky(anew);
    ASSERT_EQ(answer.code, 0);
    EXPECT_NE(answer.out.find(kept), std::string::npos) << answer.out;
    EXPECT_EQ(content(file(kept)), old);
    EXPECT_EQ(content(model).find("temperature"), std::string::npos);
  }
}

TEST_F(SimulatedBar, FitsNumbersThatMayStandInForWhatIsMissing) {
  const auto notes = [&](const char* model) {
    const std::string out = file("fitted.toml");
    return json_of(kolsky({"fit", file("shots"), "--model", file(model), "-o", out, "--json"}))
        .at("notes");
  };
  ASSERT_EQ(
      kolsky({"model", "add", file("m.toml"), "channel-delay:g3", "-o", file("whole.toml")}).code,
      0);
  ASSERT_EQ(notes("m.toml").size(), 1U);
  EXPECT_NE(notes("m.toml")[0].get<std::string>().find("by noise alone"), std::string::npos);
  EXPECT_EQ(notes("whole.toml").size(), 0U);
}

TEST_F(SimulatedBar, KeepsAModelWithAHistoryThatAFitOfAnotherWouldReplace) {
  const std::string model = file("own.toml");
  const std::vector<std::string> fit{"fit", file("shots"), "--model", file("m.toml"), "-o", model};
  ASSERT_EQ(kolsky(fit).code, 0);
  ASSERT_EQ(kolsky(fit).code, 0);
  EXPECT_FALSE(std::filesystem::exists(file("own.1.toml"))) << "the same step taken again";
  ASSERT_EQ(kolsky({"model", "add", model, "temperature"}).code, 0);
  const std::string old = content(model);
  const scene::Answer answer = kolsky(fit);
  ASSERT_EQ(answer.code, 0);
  EXPECT_NE(answer.out.find("own.1.toml"), std::string::npos) << answer.out;
  EXPECT_EQ(content(file("own.1.toml")), old);
  ASSERT_EQ(kolsky({"model", "add", file("m.toml"), "geometric-dispersion", "-o", model}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(file("own.2.toml"))) << "a fit is a step, too";
}

// The same captures in another order are the same captures; filed numbers are the bench's.
TEST_F(SimulatedBar, KnowsItsCapturesInAnyOrderAndKeepsWhatIsFiled) {
  ASSERT_EQ(kolsky({"fit", file("shots"), "--model", file("m.toml"), "-o", file("m1.toml")}).code,
            0);
  std::vector<std::string> words{"model", "waterfall", file("m1.toml")};
  for (const char* shot : {"shot04", "shot02", "shot03", "shot01"}) {
    words.push_back(file(std::string("shots/") + shot + ".h5"));
  }
  const scene::Answer fall = kolsky(words);
  EXPECT_NE(fall.out.find("the captures that the model's ledger names"), std::string::npos);
  EXPECT_EQ(fall.out.find("not the captures"), std::string::npos) << fall.out;
  EXPECT_TRUE(refused(kolsky({"model", "remove", file("m1.toml"), "three-element-bar"}),
                      {"m1.toml", "three-element-bar", "nothing to compare"}));
  EXPECT_TRUE(refused(kolsky({"model", "remove", file("m1.toml"), "gauge-factor:g1"}),
                      {"gauge-factor:g1", "files within a deviation", "free = false"}));
}

TEST_F(SimulatedBar, SaysWhatDoesNotFitTogether) {
  ASSERT_EQ(kolsky({"model", "new", "--kind", "impact", "-o", file("ball.toml")}).code, 0);
  EXPECT_TRUE(refused(kolsky({"compare", file("shots"), "--model", file("ball.toml")}),
                      {"ball.toml", "kind impact", "kind bar"}));
  // A model that knows no bench takes any gauge, until a campaign is fitted.
  ASSERT_EQ(kolsky({"model", "new", "--kind", "bar", "-o", file("free.toml")}).code, 0);
  ASSERT_EQ(kolsky({"model", "add", file("free.toml"), "crosstalk:g9", "-o", file("m9.toml")}).code,
            0);
  EXPECT_TRUE(
      refused(kolsky({"fit", file("shots"), "--model", file("m9.toml"), "-o", file("x.toml")}),
              {"m9.toml", "crosstalk:g9", "g1, g2, g3, g4"}));
  std::ofstream(file("none.toml")) << "kolsky_model = 1\nkind = \"bar\"\n";
  for (const char* command : {"fit", "compare", "diagnose"}) {
    std::vector<std::string> call{command, file("shots"), "--model", file("none.toml"), "--json"};
    if (call.front() == "fit") {
      call.insert(call.end(), {"-o", file("x.toml")});
    }
    EXPECT_TRUE(refused(kolsky(call), {"none.toml", "lacks elementary-waves"})) << command;
  }
  EXPECT_TRUE(refused(
      kolsky({"fit", file("shots"), "--model", file("campaign/bench.toml"), "-o", file("x.toml")}),
      {"bench.toml", "bench file", "model new"}));
  EXPECT_TRUE(refused(
      kolsky({"diagnose", file("shots"), "--model", file("m.toml"), "--without", "nonsense"}),
      {"give one of search-count, held-out"}));
  EXPECT_TRUE(
      refused(kolsky({"selftest", file("shots"), "--model", file("m.toml"), "--nulls", "10001"}),
              {"--nulls", "more than 10000"}));
}

// A gauge that reads 2.5 % too much, filed within 0.2 %: the fit bends the filed numbers until
// nothing stands out.
TEST(Comparing, SaysThatFiledNumbersHideWhatIsWrong) {
  const testing::ScratchFolder folder;
  ASSERT_EQ(kolsky({"tour", "--seed", "1", "--shots-only", "--folder", folder / "campaign"}).code,
            0);
  std::filesystem::create_directory(folder / "shots");
  for (int n = 1; n <= 6; ++n) {
    const std::string shot = "shot0" + std::to_string(n);
    ASSERT_EQ(kolsky({"import", "csv", folder / ("campaign/" + shot + ".csv"), "--bench",
                      folder / "campaign/bench.toml", "-o", folder / ("shots/" + shot + ".h5")})
                  .code,
              0);
  }
  ASSERT_EQ(kolsky({"model", "new", "--kind", "bar", "--bench", folder / "campaign/bench.toml",
                    "-o", folder / "m.toml"})
                .code,
            0);
  const scene::Answer compared =
      kolsky({"compare", folder / "shots", "--model", folder / "m.toml"});
  EXPECT_NE(compared.out.find("gauge-factor:g1.kappa"), std::string::npos);
  EXPECT_NE(compared.out.find("filed numbers are strained"), std::string::npos) << compared.out;
}

TEST_F(SimulatedBar, IsComparedWithANoteWhereGaugesWereExchanged) {
  const std::string said = "were the two exchanged";
  EXPECT_EQ(kolsky({"compare", file("shots"), "--model", file("m.toml")}).out.find(said),
            std::string::npos);
  std::string bench = content(file("campaign/bench.toml"));
  const std::size_t second = bench.find("\"g2\"");
  const std::size_t third = bench.find("\"g3\"");
  ASSERT_LT(second, third);
  ASSERT_LT(third, bench.size());
  bench[second + 2] = '3';
  bench[third + 2] = '2';
  std::ofstream(file("exchanged.toml")) << bench;
  ASSERT_EQ(kolsky({"import", "csv", file("campaign/shot01.csv"), "--bench", file("exchanged.toml"),
                    "-o", file("exchanged.h5")})
                .code,
            0);
  const json compared = json_of(kolsky({"compare", file("exchanged.h5"), "--model", file("m.toml"),
                                        "--json", "--report", file("exchanged.html")}));
  EXPECT_NE(compared["notes"].dump().find(said), std::string::npos) << compared["notes"];
  EXPECT_NE(content(file("exchanged.html")).find(said), std::string::npos);
  EXPECT_NE(kolsky({"compare", file("exchanged.h5"), "--model", file("m.toml")}).out.find(said),
            std::string::npos);
}

TEST_F(SimulatedBar, KeepsTheLedgerOfADiagnosisAndRevertsIt) {
  ASSERT_EQ(kolsky({"diagnose", file("shots"), "--model", file("m.toml"), "-o", file("m2.toml"),
                    "--note", "first look"})
                .code,
            0);
  const json step = json_of(kolsky({"model", "history", file("m2.toml"), "--json"}))["history"][0];
  EXPECT_EQ(step["note"], "first look");
  EXPECT_FALSE(step["verdict"].get<std::string>().empty());
  EXPECT_FALSE(step["seeds"].empty());
  EXPECT_GT(step["tests"].size(), 10U);
  EXPECT_GT(step["held_out"]["before"], step["held_out"]["after"]);
  ASSERT_EQ(kolsky({"model", "revert", file("m2.toml")}).code, 0);
  const scene::Answer same = kolsky({"model", "diff", file("m.toml"), file("m2.toml")});
  EXPECT_EQ(same.out, "the two models are the same\n");
  EXPECT_EQ(json_of(kolsky({"model", "history", file("m2.toml"), "--json"}))["history"].size(), 2U);
}

// Of all places, those that do not fail too: bands without gaps, windows one after the other.
TEST_F(SimulatedBar, SaysWhichPlacesAreCompared) {
  const json compared =
      json_of(kolsky({"compare", file("shots"), "--model", file("m.toml"), "--json"}));
  const json& places = compared["places"];
  EXPECT_EQ(places["shots"].size(), 4U);
  const json& bands = places["bands_Hz"];
  for (std::size_t b = 1; b < bands.size(); ++b) {
    EXPECT_EQ(bands[b][0], bands[b - 1][1]);
  }
  const json* before = nullptr;
  for (const json& window : places["windows"]) {
    EXPECT_LE(window["start_s"], window["end_s"]);
    EXPECT_GE(window["start_s"], 0.0);
    if (before != nullptr && (*before)["shot"] == window["shot"] &&
        (*before)["gauge"] == window["gauge"]) {
      EXPECT_EQ(window["start_s"], (*before)["end_s"]);
    }
    before = &window;
  }
  ASSERT_FALSE(compared["where"].empty());
  for (const json& tile : compared["where"]) {
    EXPECT_NE(std::find(bands.begin(), bands.end(), tile["band_Hz"]), bands.end());
  }
}

TEST_F(SimulatedBar, SaysWhichSafeguardsADiagnosisDidWithout) {
  const std::vector<std::string> words{"diagnose", file("shots"), "--model", file("m.toml"),
                                       "--json"};
  EXPECT_FALSE(json_of(kolsky(words)).contains("without"));
  std::vector<std::string> fewer = words;
  fewer.insert(fewer.end(),
               {"-o", file("m2.toml"), "--without", "unknown", "--without", "search-count"});
  EXPECT_EQ(json_of(kolsky(fewer))["without"], json({"search-count", "unknown"}));
  EXPECT_NE(content(file("m2.toml")).find("without search-count; without unknown"),
            std::string::npos);
  EXPECT_TRUE(refused(
      kolsky({"diagnose", file("shots"), "--model", file("m.toml"), "--without", "heldout"}),
      {"\"heldout\"", "the nearest is held-out"}));
  const std::string help = kolsky({"diagnose", "--help"}).out;
  for (const char* name : {"search-count:", "held-out:", "shot-agreement:", "own-strengths:",
                           "fitted-noise:", "slow-noise:", "backward:", "unknown:"}) {
    EXPECT_NE(help.find("\n                            " + std::string(name)), std::string::npos)
        << name;
  }
}

/// Copies a table of voltages, with what its second gauge reads more at a time.
void copy_with_more(const std::string& from, const std::string& to,
                    const std::function<double(double)>& more_V) {
  std::ifstream table(from);
  std::ofstream copy(to);
  std::string line;
  std::getline(table, line);
  copy << line << "\n";
  while (std::getline(table, line)) {
    const std::size_t g1 = line.find(',') + 1;
    const std::size_t g2 = line.find(',', g1) + 1;
    const std::size_t g3 = line.find(',', g2);
    const double voltage = std::stod(line.substr(g2, g3 - g2));
    copy << line.substr(0, g2) << voltage + more_V(std::stod(line)) << line.substr(g3) << "\n";
  }
}

TEST_F(SimulatedBar, IsJudgedOnlyAsFarAsAsked) {
  std::filesystem::create_directory(file("knocked"));
  // A quarter of a millisecond of quiet is before time 0 of these tables.
  for (const char* shot : {"shot01", "shot02", "shot03", "shot04"}) {
    copy_with_more(file(std::string("campaign/") + shot + ".csv"), file("knocked.csv"),
                   [](double time_s) { return time_s > 0.9e-3 ? 0.5 : 0.0; });
    ASSERT_EQ(kolsky({"import", "csv", file("knocked.csv"), "--bench", file("campaign/bench.toml"),
                      "-o", file(std::string("knocked/") + shot + ".h5")})
                  .code,
              0);
  }
  const auto diagnosed = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"diagnose", file("knocked"), "--model", file("m.toml"),
                                   "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json_of(kolsky(words));
  };
  EXPECT_NE(diagnosed({})["effects"], json({"channel-delay:g3"}));
  EXPECT_EQ(diagnosed({"--until", "1.1e-3", "-o", file("d.toml")})["effects"],
            json({"channel-delay:g3"}));
  EXPECT_NE(content(file("d.toml")).find("records up to 0.0011 s"), std::string::npos);
  const auto chi2_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"compare", file("knocked"), "--model", file("d.toml"), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json_of(kolsky(words))["misfit"]["chi2_reduced"].get<double>();
  };
  EXPECT_LT(chi2_of({"--until", "1.1e-3"}), 1.3);
  EXPECT_GT(chi2_of({}), 10.0);
  EXPECT_EQ(chi2_of({"--until", "1"}), chi2_of({}));
  const json narrow = json_of(kolsky({"compare", file("knocked"), "--model", file("d.toml"),
                                      "--until", "1.1e-3", "--band-limit", "20e3", "--json"}));
  EXPECT_NEAR(narrow["misfit"]["judged_to_Hz"], 20e3, 1e3);
  ASSERT_EQ(kolsky({"fit", file("knocked"), "--model", file("d.toml"), "--until", "1.1e-3", "-o",
                    file("f.toml")})
                .code,
            0);
  EXPECT_NE(content(file("f.toml")).find("fit 4 captures up to 0.0011 s"), std::string::npos);
  EXPECT_TRUE(
      refused(kolsky({"compare", file("knocked"), "--model", file("d.toml"), "--until", "0"}),
              {"--until", "above 0 s"}));
  EXPECT_TRUE(
      refused(kolsky({"compare", file("knocked"), "--model", file("d.toml"), "--until", "1e-5"}),
              {"--until", "leaves nothing of shot01.h5 to judge", "give a later time"}));
}

/// The first table after a heading.
std::string table_after(const std::string& heading, const std::string& page) {
  const std::size_t begin = page.find("<table", page.find(heading));
  return page.substr(begin, page.find("</table>", begin) - begin);
}

// A fit counts as noise what differs from shot to shot; where it is people are to see all the same.
TEST_F(SimulatedBar, FailedBeforeWhereCompareSaysSo) {
  ASSERT_EQ(
      kolsky({"compare", file("shots"), "--model", file("m.toml"), "--report", file("c.html")})
          .code,
      0);
  ASSERT_EQ(
      kolsky({"diagnose", file("shots"), "--model", file("m.toml"), "--report", file("d.html")})
          .code,
      0);
  const std::string compared = table_after("Where it is", content(file("c.html")));
  EXPECT_NE(compared.find("g3"), std::string::npos);
  EXPECT_EQ(table_after("Where the model failed before", content(file("d.html"))), compared);
}

TEST_F(SimulatedBar, RefusesAPlaceForItsResultBeforeTheWork) {
  // No capture is there: what is refused first is what is said.
  const std::string none = file("no-such.h5");
  const std::string nowhere = file("no/such/folder/m.toml");
  const std::string bench = file("bench.toml");
  const std::vector<std::string> model{"--model", file("m.toml")};
  const auto asked = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), model.begin(), model.end());
    words.insert(words.end(), more.begin(), more.end());
    return kolsky(words);
  };
  std::ofstream(bench) << "kind = \"bar\"\n";
  for (const std::string& output : {nowhere, bench, file("shots")}) {
    EXPECT_TRUE(refused(asked({"fit", none}, {"-o", output}), {output})) << output;
    EXPECT_TRUE(refused(asked({"diagnose", none}, {"-o", output}), {output})) << output;
    EXPECT_TRUE(refused(asked({"diagnose", none}, {"--report", output}), {output})) << output;
    EXPECT_TRUE(refused(asked({"compare", none}, {"--report", output}), {output})) << output;
    EXPECT_TRUE(
        refused(kolsky({"model", "waterfall", file("m.toml"), none, "--svg", output}), {output}))
        << output;
  }
  EXPECT_EQ(content(bench), "kind = \"bar\"\n");
}

TEST_F(SimulatedBar, TakesNoEffectOfAGaugeThatItsBenchDoesNotHave) {
  const std::string before = content(file("m.toml"));
  EXPECT_TRUE(refused(kolsky({"model", "add", file("m.toml"), "gauge-position:g9"}),
                      {"gauge-position:g9", "its gauges are g1, g2, g3", "gauge-position:g1"}));
  EXPECT_EQ(content(file("m.toml")), before);
  // Of a model whose bench was not said nothing is known, until it is fitted.
  ASSERT_EQ(kolsky({"model", "new", "--kind", "bar", "-o", file("any.toml")}).code, 0);
  EXPECT_EQ(
      kolsky({"model", "add", file("any.toml"), "gauge-position:g9", "-o", file("far.toml")}).code,
      0);
  ASSERT_EQ(
      kolsky({"fit", file("shots"), "--model", file("any.toml"), "-o", file("any.toml")}).code, 0);
  EXPECT_TRUE(refused(kolsky({"model", "add", file("any.toml"), "gauge-position:g9"}),
                      {"gauge-position:g9", "its gauges are"}));
}

// Nothing repeats in a shot: what was foretold is not another one.
TEST_F(SimulatedBar, SaysOfOneShotThatPartsOfItWereHeldOut) {
  const std::string shot = file("shots/shot01.h5");
  const std::string held_out = "one shot: held out were parts of its record, not shots";
  const scene::Answer fitted =
      kolsky({"fit", shot, "--model", file("m.toml"), "-o", file("f.toml")});
  EXPECT_EQ(fitted.code, 0) << fitted.err;
  EXPECT_NE(fitted.out.find("whether it would come again one shot cannot say"), std::string::npos)
      << fitted.out;
  const json compared = json_of(kolsky({"compare", shot, "--model", file("f.toml"), "--json"}));
  EXPECT_EQ(compared["places"]["shots"].size(), 1U);
  ASSERT_FALSE(compared["where"].empty());

  const std::vector<std::string> words{"diagnose", shot, "--model", file("m.toml")};
  const auto diagnose = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return kolsky(all);
  };
  const scene::Answer told = diagnose({"-o", file("d.toml"), "--report", file("d.html")});
  EXPECT_EQ(told.code, 0) << told.err;
  EXPECT_NE(told.out.find("note: " + held_out), std::string::npos) << told.out;
  const std::string page = content(file("d.html"));
  EXPECT_NE(page.find(held_out), std::string::npos);
  EXPECT_NE(page.find("chi-square per residual falls from"), std::string::npos);
  const json diagnosis = json_of(diagnose({"--json"}));
  EXPECT_EQ(diagnosis["verdict"], "named");
  EXPECT_EQ(diagnosis["effects"], json({"channel-delay:g3"}));
  EXPECT_NE(diagnosis["notes"].dump().find(held_out), std::string::npos) << diagnosis["notes"];
  const json& misfit = diagnosis["misfit"]["held_out"];
  EXPECT_GT(misfit["before"], 2.0 * misfit["after"].get<double>());
  EXPECT_NEAR(misfit["after"], misfit["floor"], 0.2);
  const json fall = json_of(kolsky({"model", "waterfall", file("d.toml"), shot, "--json"}));
  EXPECT_NE(fall["notes"].dump().find("one shot: held out are parts of its record, not shots"),
            std::string::npos)
      << fall["notes"];
  // Of several the note would be wrong.
  EXPECT_EQ(kolsky({"diagnose", file("shots"), "--model", file("m.toml")}).out.find("one shot:"),
            std::string::npos);
}

/// An expression as people write one: a strength, and a time that means nothing without it.
std::string expression(const std::string& id, const std::string& stage, const std::string& formula,
                       const std::string& strength, const std::string& time) {
  return "\n[[expressions]]\nid = \"" + id + "\"\nstage = \"" + stage + "\"\nformula = \"" +
         formula + "\"\n[expressions.parameters.D]\n" + strength +
         "[expressions.parameters.tau]\nunit = \"s\"\n" + time;
}

const std::string kCompliance =
    "unit = \"1/Pa\"\nnull = 0.0\nbounds = [0.0, 1e-9]\ntypical = 1e-12\n";
const std::string kShare = "unit = \"-\"\nnull = 0.0\nbounds = [0.0, 0.5]\ntypical = 0.01\n";
const std::string kSlowTimes =
    "starts = [1e-5, 1e-4, 1e-3]\nbounds = [1e-6, 1e-1]\ntypical = 1e-5\n";
const std::string kFastTimes = "starts = [2e-7]\nbounds = [1e-7, 5e-7]\ntypical = 1e-7\n";

std::string branch() {
  return expression("my-branch", "material", "D / (1 + s*tau)", kCompliance, kSlowTimes);
}

/// Powers of complex numbers are what a formula can spend most on.
std::string laborious() {
  std::string sum = "1";
  for (int n = 0; n < 20; ++n) {
    sum += "+(s*tau)^.1-(s*tau)^.1";
  }
  return expression("laborious", "sensor", "1 - D*(" + sum + ")", kShare, kFastTimes);
}

TEST_F(SimulatedBar, ChecksTheEffectsThatItsModelDeclares) {
  std::ofstream(file("m.toml"), std::ios::app) << branch() << laborious();
  const scene::Answer alone = kolsky({"model", "check", file("m.toml")});
  ASSERT_EQ(alone.code, 0) << alone.err;
  EXPECT_NE(alone.out.find("sound; 2 effects, 2 expressions of its own"), std::string::npos)
      << alone.out;
  EXPECT_NE(
      alone.out.find("my-branch (material): J += D / (1 + s*tau)\n  admitted: nothing at null, "
                     "derivative finite, passive, causal, units right; declared, not used"),
      std::string::npos)
      << alone.out;
  EXPECT_EQ(alone.out.find("nearest:"), std::string::npos) << "there are no captures to tell by";

  const std::vector<std::string> words{"model", "check", file("m.toml"), file("shots")};
  const scene::Answer here = kolsky(words);
  ASSERT_EQ(here.code, 0) << here.err;
  for (const char* said :
       {"my-branch: D from ", " 1/Pa on is seen here, from ", "told apart; ",
        " % of it is taken up by the model\n      nearest: second-relaxation (cosine 0.99",
        "us along 2048 places: an evaluation takes 1."}) {
    EXPECT_NE(here.out.find(said), std::string::npos) << said << "\n" << here.out;
  }
  std::vector<std::string> asked = words;
  asked.emplace_back("--json");
  const json checked = json_of(kolsky(asked));
  ASSERT_EQ(checked["expressions"].size(), 2U);
  const json& own = checked["expressions"][0];
  EXPECT_EQ(own["id"], "my-branch");
  EXPECT_EQ(own["stage"], "material");
  EXPECT_EQ(own["admitted"], true);
  EXPECT_EQ(own["used"], false);
  ASSERT_EQ(own["here"].size(), 1U);
  const json& seen = own["here"][0];
  EXPECT_EQ(seen["parameter"], "D");
  EXPECT_EQ(seen["unit"], "1/Pa");
  EXPECT_GT(seen["smallest_detectable"], 0.0);
  EXPECT_GT(seen["smallest_identifiable"], seen["smallest_detectable"]);
  // Moduli take up most of a branch.
  EXPECT_GT(seen["absorbed_share"], 0.5);
  EXPECT_LT(seen["absorbed_share"], 1.0);
  // The same physics from other starts.
  EXPECT_EQ(seen["rivals"][0]["effect"], "second-relaxation");
  EXPECT_GT(seen["rivals"][0]["cosine"], 0.99);
  for (std::size_t n = 1; n < seen["rivals"].size(); ++n) {
    EXPECT_LE(seen["rivals"][n]["cosine"], seen["rivals"][n - 1]["cosine"]);
  }
}

TEST_F(SimulatedBar, SaysWhatAnEvaluationOfADeclaredEffectCosts) {
  std::ofstream(file("m.toml"), std::ios::app) << branch() << laborious();
  const scene::Answer said = kolsky({"model", "check", file("m.toml")});
  const std::size_t warning = said.out.find("  slow: more than 10 times;");
  EXPECT_GT(warning, said.out.find("laborious (sensor)")) << said.out;
  EXPECT_EQ(warning, said.out.rfind("  slow:")) << said.out;
  EXPECT_NE(warning, std::string::npos) << said.out;
  const json checked = json_of(kolsky({"model", "check", file("m.toml"), "--json"}));
  const json& quick = checked["expressions"][0];
  const json& slow = checked["expressions"][1];
  EXPECT_GT(quick["time_s"], 0.0);
  EXPECT_GT(quick["times_model"], 1.0);
  EXPECT_EQ(quick["slow"], false);
  EXPECT_GT(slow["time_s"], quick["time_s"]);
  EXPECT_GT(slow["times_model"], 10.0);
  EXPECT_EQ(slow["slow"], true);
}

TEST_F(SimulatedBar, RefusesADeclaredEffectThatIsNotSound) {
  const std::string model = content(file("m.toml"));
  const auto check = [&](const std::string& declared) {
    std::ofstream(file("unsound.toml")) << model << declared;
    return kolsky({"model", "check", file("unsound.toml")});
  };
  const auto material = [&](const std::string& formula) {
    return check(expression("mine", "material", formula, kCompliance, kSlowTimes));
  };
  const auto sensor = [&](const std::string& formula, const std::string& times) {
    return check(expression("mine", "sensor", formula, kShare, times));
  };
  EXPECT_TRUE(refused(material("D*s/(1 + s*tau)"), {"unsound.toml:", "formula", "1/Pa"}));
  EXPECT_TRUE(refused(sensor("1 + s*tau + D", kFastTimes), {"unsound.toml:", "identity"}));
  EXPECT_TRUE(refused(sensor("1 - D^2/(1 + s*tau)", kSlowTimes), {"unsound.toml:", "derivative"}));
  EXPECT_TRUE(refused(material("D + D*s*tau"), {"unsound.toml:", "passivity", "bound"}));
  EXPECT_TRUE(refused(
      sensor("1 - D*exp(s*tau)", "starts = [1e-4]\nbounds = [5e-5, 2e-4]\ntypical = 1e-5\n"),
      {"unsound.toml:", "causality"}));
}

// As `kolsky identify specimen` files it.
TEST(NewModel, OfABallTakesTheCovarianceOfItsMaterials) {
  const testing::ScratchFolder folder;
  folder.write("core.toml",
               "density_kg_m3 = 1140\npoisson_ratio = 0.376\nE1_Pa = 121e6\nE1_Pa_sd = 2e6\n"
               "E2_Pa = 143e6\nE2_Pa_sd = 3e6\neta2_Pa_s = 2860\neta2_Pa_s_sd = 100\n"
               "covariance = [4e12, -3e12, 0, -3e12, 9e12, 0, 0, 0, 1e4]\n");
  ASSERT_EQ(kolsky({"model", "new", "--kind", "impact", "--core", folder / "core.toml", "-o",
                    folder / "m.toml"})
                .code,
            0);
  const std::string model = content(folder / "m.toml");
  const std::size_t core = model.find("three-element-core");
  const std::size_t prior = model.find("prior_correlation = [1.0, -0.5, 0.0, 0.0, 0.0, -0.5, 1.0,");
  EXPECT_LT(core, prior) << model;
  EXPECT_LT(prior, model.find("three-element-cover")) << model;
}

// As `kolsky identify bar` files it.
TEST(NewModel, OfASplitBarTakesTheCovarianceOfItsBars) {
  const testing::ScratchFolder folder;
  folder.write("bars.toml",
               "density_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.66e9\nE1_Pa_sd = 2e6\n"
               "E2_Pa = 37e9\nE2_Pa_sd = 3e7\neta2_Pa_s = 1.81e6\neta2_Pa_s_sd = 1e3\n"
               "covariance = [4e12, -3e13, 0, -3e13, 9e14, 0, 0, 0, 1e6]\n");
  const auto prior_of = [&](const std::string& kind) {
    const std::string name = folder / (kind + ".toml");
    EXPECT_EQ(
        kolsky({"model", "new", "--kind", kind, "--bar-model", folder / "bars.toml", "-o", name})
            .code,
        0);
    const std::string model = content(name);
    EXPECT_TRUE(model.find("5.66e+09") != std::string::npos) << model;
    return model.find("prior_correlation = [1.0, -0.5, 0.0, -0.5, 1.0, 0.0, 0.0, 0.0, 1.0]");
  };
  EXPECT_NE(prior_of("shpb"), std::string::npos);
  EXPECT_EQ(prior_of("bar"), std::string::npos) << "there it only says where to start";
}

TEST(EffectsCommand, ListsEveryEffectByIdWithWhatAPersonNeedsToAddIt) {
  const std::string text = kolsky({"effects"}).out;
  const json list = json_of(kolsky({"effects", "--json"}))["effects"];
  const auto of = [&](const std::string& id) {
    const auto found = std::find_if(list.begin(), list.end(),
                                    [&](const json& effect) { return effect["id"] == id; });
    return found == list.end() ? json() : *found;
  };
  for (const std::string id : testing::kReferenceEffects) {
    const json effect = of(id);
    ASSERT_TRUE(effect.is_object()) << id;
    EXPECT_FALSE(effect["stage"].get<std::string>().empty()) << id;
    EXPECT_FALSE(effect["reference"].get<std::string>().empty()) << id;
    EXPECT_FALSE(effect["kinds"].empty()) << id;
    ASSERT_FALSE(effect["parameters"].empty()) << id;
    for (const json& parameter : effect["parameters"]) {
      EXPECT_FALSE(parameter["unit"].get<std::string>().empty()) << id;
      EXPECT_TRUE(parameter["null"].is_number()) << id;
      EXPECT_LT(parameter["bounds"][0], parameter["bounds"][1]) << id;
    }
    const bool of_a_gauge = effect["per_gauge"].get<bool>();
    EXPECT_NE(text.find("\n  " + id + (of_a_gauge ? ":GAUGE " : " ")), std::string::npos) << id;
  }
  EXPECT_EQ(of("gauge-position")["per_gauge"], true);
  EXPECT_EQ(of("bending")["parameters"][0]["unit"], "m");
  EXPECT_EQ(of("fractional-damping")["parameters"][0]["null"], 1.0);
  for (const json& effect : list) {
    EXPECT_NE(text.find("\n  " + effect["id"].get<std::string>()), std::string::npos) << effect;
  }
}

TEST_F(SimulatedBar, RefusesWhatCannotBeAsked) {
  EXPECT_TRUE(refused(kolsky({"model", "diff", file("m.toml") + "@3", file("m.toml")}),
                      {"names no step", "from 0 to 0"}));
  EXPECT_TRUE(
      refused(kolsky({"model", "waterfall", file("m.toml"), file("nowhere")}), {"nowhere"}));
  EXPECT_TRUE(
      refused(kolsky({"selftest", file("shots"), "--model", file("m.toml"), "--sizes", "0.001"}),
              {"--sizes", "--effects"}));
  EXPECT_TRUE(refused(kolsky({"selftest", file("shots"), "--model", file("m.toml"), "--effects",
                              "warp", "--sizes", "0.001"}),
                      {"warp"}));
  EXPECT_TRUE(refused(kolsky({"selftest", file("shots"), "--model", file("m.toml"), "--effects",
                              "gauge-position:g9", "--sizes", "0.001"}),
                      {"gauge-position:g9"}));
  // Two folders, one name: only the paths tell which is which.
  std::filesystem::create_directory(folder_ / "later");
  std::ofstream(file("later.toml")) << content(file("campaign/bench.toml")) << "\n# again\n";
  ASSERT_EQ(kolsky({"import", "csv", file("campaign/shot01.csv"), "--bench", file("later.toml"),
                    "-o", file("later/shot01.h5")})
                .code,
            0);
  EXPECT_TRUE(refused(kolsky({"compare", file("shots/shot01.h5"), file("later/shot01.h5"),
                              "--model", file("m.toml")}),
                      {"later/shot01.h5: is of another bench", "than " + file("shots/shot01.h5")}));
  EXPECT_TRUE(refused(kolsky({"tour", "--truth-only"}), {"--seed"}));
  EXPECT_TRUE(refused(kolsky({"tour", "--seed", "1", "--shots-only"}), {"--folder"}));
  EXPECT_TRUE(refused(kolsky({"tour", "--folder", file("shots")}), {"empty folder"}));
}

TEST(TourCommand, RunsRealCommandsFindsWhatItHidAndLeavesNothingWhereAsked) {
  const json said = json_of(kolsky({"tour", "--seed", "3", "--quick", "--remove", "--json"}));
  EXPECT_EQ(said["truth"]["effect"], "channel-delay:g3");
  EXPECT_TRUE(said["end"] == "found" || said["end"] == "among-tied") << said.dump();
  EXPECT_GE(said["commands"].size(), 8U);
  EXPECT_EQ(said["folder"], "");
}

TEST(TourCommand, ClaimsNothingWhereNothingIsHidden) {
  const json said = json_of(kolsky({"tour", "--seed", "7", "--quick", "--remove", "--json"}));
  EXPECT_EQ(said["truth"]["effect"], "");
  EXPECT_EQ(said["verdict"], "adequate");
  EXPECT_EQ(said["end"], "rightly-quiet");
}

}  // namespace
}  // namespace kolsky
