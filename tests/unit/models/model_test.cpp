#include "processing/models/model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "drivers/files/models/model_file.hpp"
#include "drivers/files/models/toml_values.hpp"
#include "drivers/files/settings/toml_document.hpp"
#include "processing/base/error.hpp"
#include "processing/models/physics.hpp"
#include "processing/models/transfers.hpp"
#include "tests/reference_effects.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

Bench bench_of(BenchKind kind) {
  Bench bench;
  bench.kind = kind;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {2.0, 0.0};
  bench.input.diameter_m = {0.02, 0.0};
  bench.input.density_kg_m3 = {1180.0, 0.0};
  bench.input.poisson_ratio = {0.36, 0.0};
  for (const auto& [name, x] : {std::pair{"g1", 0.2}, std::pair{"g2", 0.6}, std::pair{"g3", 1.1}}) {
    Gauge gauge;
    gauge.name = name;
    gauge.bar = "input";
    gauge.position_m = {x, 0.0};
    gauge.unit = "strain";
    bench.gauges.push_back(gauge);
  }
  if (kind == BenchKind::shpb) {
    bench.output = bench.input;
    bench.gauges[2].bar = "output";
    bench.specimen =
        Specimen{{0.004, 0.0}, {0.012, 0.0}, Measured{1140.0, 0.0}, Measured{0.376, 0.0}};
  }
  return bench;
}

std::vector<AppliedEffect> applied(const Model& model) {
  std::vector<AppliedEffect> list;
  for (const EffectUse& use : model.effects) {
    AppliedEffect effect{use.effect, use.gauge == "g2" ? std::size_t{1} : std::size_t{0}, {}};
    for (const ModelValue& value : use.values) {
      effect.values.push_back(value.value);
    }
    list.push_back(std::move(effect));
  }
  return list;
}

/// Everything a model says of a shot, in one list.
std::vector<Complex> said(const Model& model, const Bench& bench) {
  ShotFacts facts;
  facts.peak_strain = 2e-3;
  facts.warmer_by_K = 3.0;
  for (int n = 0; n < 50; ++n) {
    facts.time_s.push_back(1e-5 * n);
  }
  std::vector<Complex> path;
  for (int k = 0; k < 40; ++k) {
    path.emplace_back(4000.0, 8000.0 * k);
  }
  Scene scene(bench, facts, path);
  shape(applied(model), scene);
  std::vector<Complex> all;
  for (const auto& reading : transfers_of(scene, 0).reading) {
    all.insert(all.end(), reading.begin(), reading.end());
  }
  all.emplace_back(scene.record.bridge_b);
  for (std::vector<double> addition : scene.record.additions) {
    addition.resize(facts.time_s.size(), 0.0);
    all.insert(all.end(), addition.begin(), addition.end());
  }
  if (scene.specimen) {
    all.emplace_back(scene.specimen->stiffening);
    all.emplace_back(scene.specimen->friction);
    all.emplace_back(scene.specimen->gap_m);
    all.emplace_back(scene.specimen->parts ? 1.0 : 0.0);
    all.emplace_back(scene.specimen->lateral_inertia_kg_per_m);
  }
  return all;
}

double difference(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

class EveryEffect : public ::testing::TestWithParam<const Effect*> {};

TEST_P(EveryEffect, IsNotThereAtItsNullAndIsThereBesideIt) {
  const EffectAbout& about = GetParam()->about();
  if (about.base) {
    GTEST_SKIP() << "part of the paper's model";
  }
  for (const BenchKind kind : about.kinds) {
    if (kind == BenchKind::impact) {
      continue;
    }
    const Bench bench = bench_of(kind);
    Model model = paper_model(kind, false);
    if (about.id == "bar-length") {
      model.effects.push_back(use_named("end-reflection"));
    }
    const auto without = said(model, bench);
    EffectUse use = null_use(*GetParam(), about.per_gauge ? "g2" : "");
    model.effects.push_back(use);
    EXPECT_LT(difference(without, said(model, bench)), 1e-12) << "at null";
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      const EffectParameter& parameter = about.parameters[p];
      // Split bars have a far end that returns waves anyway: it is another one with r alone.
      const bool is_there = parameter.is_switch && kind == BenchKind::shpb;
      if (!parameter.auxiliary() && !is_there) {
        model.effects.back() = use;
        const double up = parameter.null_value + parameter.typical;
        model.effects.back().values[p].value =
            up <= parameter.upper ? up : parameter.null_value - parameter.typical;
        EXPECT_GT(difference(without, said(model, bench)), 1e-9) << parameter.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Library, EveryEffect, ::testing::ValuesIn(effect_library()),
                         [](const auto& tested) {
                           std::string name = tested.param->about().id;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(EffectLibrary, HoldsTheReferencesEffectsOnce) {
  std::set<std::string> ids;
  for (const Effect* effect : effect_library()) {
    EXPECT_TRUE(ids.insert(effect->about().id).second) << effect->about().id;
  }
  for (const char* id : testing::kReferenceEffects) {
    EXPECT_TRUE(ids.contains(id)) << id;
  }
}

// A bench files each bar's numbers and how far they may be off; one without a deviation is exact.
TEST(EffectLibrary, AFiledNumberOfOneBarMovesNothingOfTheOther) {
  for (const auto& [id, moved] : std::map<std::string, std::size_t>{{"bar-density", 0},
                                                                    {"output-bar-density", 1},
                                                                    {"bar-diameter", 0},
                                                                    {"output-bar-diameter", 1}}) {
    const Scene filed(bench_of(BenchKind::shpb), {}, {});
    Scene scene = filed;
    use_named(id).effect->apply(scene, std::vector<double>{0.01}, 0);
    ASSERT_EQ(scene.bars.size(), 2U);
    for (std::size_t b = 0; b < 2; ++b) {
      const bool same = scene.bars[b].density_kg_m3 == filed.bars[b].density_kg_m3 &&
                        scene.bars[b].radius_m == filed.bars[b].radius_m &&
                        scene.bars[b].area_m2 == filed.bars[b].area_m2;
      EXPECT_EQ(same, b != moved) << id << ", bar " << b;
    }
  }
}

TEST(EffectLibrary, CorrectionsWithoutAFreeParameterAreNotSoughtBelowNothing) {
  std::size_t corrections = 0;
  for (const Effect* effect : effect_library()) {
    const EffectAbout& about = effect->about();
    if (about.base || about.parameters.front().name != "s") {
      continue;
    }
    ++corrections;
    EXPECT_EQ(about.parameters.front().null_value, 0.0) << about.id;
    EXPECT_EQ(about.parameters.front().lower, 0.0) << about.id;
    EXPECT_GT(about.parameters.front().upper, 1.0) << about.id;
  }
  EXPECT_EQ(corrections, 4U);
}

TEST(UseNamed, RefusesWhatTheLibraryDoesNotHaveOrWhatNamesNoGauge) {
  EXPECT_THROW((void)use_named("geometrical-dispersion"), InputError);
  EXPECT_THROW((void)use_named("gauge-position"), InputError);
  EXPECT_THROW((void)use_named("temperature:g1"), InputError);
  EXPECT_THROW((void)use_named("gauge-length:g1=0.06"), InputError);
  EXPECT_EQ(use_named("gauge-position:g3").id(), "gauge-position:g3");
}

TEST(ModelFile, ReadsBackTheSameBitsAndKeepsItsHistory) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  file.model.effects.front().values[0] = {5.6612345678901234e9, 1.25e6, true, 0.0, 0.0};
  begin_step(file, "add gauge-position:g2", "2026-01-02T03:04:05Z");
  file.model.effects.push_back(use_named("gauge-position:g2"));
  const std::string text = format_model(file);
  const ModelFile again = parse_model(text, "m.toml");
  EXPECT_EQ(format_model(again), text);
  EXPECT_EQ(again.model.effects.front().values[0].value, 5.6612345678901234e9);
  ASSERT_EQ(again.history.size(), 1U);
  const ModelFile before = parse_model(again.history.front().before, "before");
  EXPECT_EQ(before.model.find("gauge-position:g2"), nullptr);
  EXPECT_NE(before.model.find("three-element-bar"), nullptr);
}

/// The paper's model beside as many filed numbers as a bench of so many gauges has.
ModelFile file_of_gauges(int gauges) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  for (int g = 1; g <= gauges; ++g) {
    for (const char* effect : {"gauge-position:g", "gauge-factor:g", "channel-delay:g"}) {
      file.model.effects.push_back(use_named(effect + std::to_string(g)));
    }
  }
  return file;
}

TEST(ModelFile, ReadsBackStepsOfModelsOfAnyLength) {
  ModelFile file = file_of_gauges(16);
  begin_step(file, "add temperature", "2026-01-02T03:04:05Z");
  ASSERT_GT(file.history.back().before.size(), 4096U);
  const std::string text = format_model(file);
  const ModelFile again = parse_model(text, "m.toml");
  EXPECT_EQ(again.history.front().before, file.history.front().before);
  EXPECT_EQ(format_model(again), text);
}

TEST(ModelFile, ReadsStepsThatWereWrittenOnOneLine) {
  ModelFile file = file_of_gauges(1);
  begin_step(file, "add temperature", "2026-01-02T03:04:05Z");
  std::string text = format_model(file);
  const std::string now = toml_lines(file.history.back().before);
  ASSERT_NE(text.find(now), std::string::npos);
  text.replace(text.find(now), now.size(), toml_quoted(file.history.back().before));
  EXPECT_EQ(parse_model(text, "m.toml").history.front().before, file.history.front().before);
}

TEST(ModelFile, QuotesTextOfManyLinesSoThatItReadsBackTheSame) {
  for (const std::string text : {"", "\n", "\n\n", "one", "one\n", "\none\ntwo", "a \"b\" \\c\\\n",
                                 "\"\"\"\n\"", "tab\there\r\n", "ends in \\"}) {
    const TomlNode read = parse_toml("text = " + toml_lines(text) + "\n", "t.toml");
    ASSERT_EQ(read.entries.size(), 1U);
    EXPECT_EQ(read.entries.front().node.text, text) << toml_lines(text);
  }
}

TEST(ModelFile, KeepsTheWholeLedgerOfAStep) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  begin_step(file, "diagnose: temperature", "2026-01-02T03:04:05Z");
  ModelStep& step = file.history.back();
  step.note = "after the \"new\" cable";
  step.data_sha256 = "abc";
  step.verdict = "tied";
  step.added = {"temperature"};
  step.seeds = {20260101.0};
  step.fit = StepFit{8, 1.0123456789012345, 3411.5, 8e-8, 6.7e-6};
  step.held_out = StepHeldOut{15.25, 1.02, 1.003};
  step.tests = {{"temperature", 3e-3, 1.7e-5, "1/K", -7133.0, 49268.3, "tied", {"bar-modulus"}},
                {"gauge-length:g1", INFINITY, 1.0, "m", 0.0, 0.0, "untestable", {}}};
  const ModelFile again = parse_model(format_model(file), "m.toml");
  ASSERT_EQ(again.history.size(), 1U);
  const ModelStep& read = again.history.front();
  EXPECT_EQ(read.note, step.note);
  EXPECT_EQ(read.verdict, "tied");
  EXPECT_EQ(read.added, step.added);
  EXPECT_EQ(read.seeds, step.seeds);
  EXPECT_FALSE(read.software.empty());
  EXPECT_EQ(read.fit->chi2_reduced, 1.0123456789012345);
  EXPECT_EQ(read.fit->captures, 8);
  EXPECT_EQ(read.held_out->before, 15.25);
  // What is not finite says nothing of an effect and is left out.
  ASSERT_EQ(read.tests.size(), 1U);
  EXPECT_EQ(read.tests.front().log_p, -7133.0);
  EXPECT_EQ(read.tests.front().tied_with, (std::vector<std::string>{"bar-modulus"}));
}

/// Three steps: add A, add B, revert to after A.
ModelFile walked() {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  begin_step(file, "add temperature");
  file.model.effects.push_back(use_named("temperature"));
  begin_step(file, "add crosstalk:g2");
  file.model.effects.push_back(use_named("crosstalk:g2"));
  const Model after_one = file.at(1).model;
  begin_step(file, "revert to step 1");
  file.model = after_one;
  return file;
}

TEST(ModelFile, IsWhatItWasAfterAnyStep) {
  const ModelFile file = walked();
  const std::vector<std::size_t> effects{2, 3, 4, 3};
  for (std::size_t steps = 0; steps < effects.size(); ++steps) {
    const ModelFile then = file.at(steps);
    EXPECT_EQ(then.model.effects.size(), effects[steps]) << steps;
    EXPECT_EQ(then.history.size(), steps);
  }
  EXPECT_THROW((void)file.at(4), InputError);
}

// What a reversion led to is where another one begins.
TEST(ModelFile, KnowsSinceWhichStepItIsWhatItIs) {
  const ModelFile file = walked();
  EXPECT_EQ(file.first_alike(0), 0U);
  EXPECT_EQ(file.first_alike(1), 1U);
  EXPECT_EQ(file.first_alike(2), 2U);
  EXPECT_EQ(file.first_alike(3), 1U);
  const ModelFile again = parse_model(format_model(file), "m.toml");
  EXPECT_EQ(again.first_alike(3), 1U);
}

TEST(DigestOfFiles, IsTheSameInAnyOrderAndKnowsThatOfOlderHistories) {
  const testing::ScratchFolder folder;
  const auto one = folder.write("one", "abc");
  const auto two = folder.write("two", "");
  EXPECT_EQ(digest_of_files({one, two}), digest_of_files({two, one}));
  // printf '%s%s' $(printf abc | sha256sum | cut -c1-64) $(printf '' | sha256sum | cut -c1-64) |
  // sha256sum, and the other way round
  const std::string abc_first = "17076dc047c0c18dc1ba5e0310336762a1db0b7daa275b1004887c2cca2c25b0";
  const std::string empty_first =
      "302d3d24b187100835e04a2cd639ad14026ab49e914d2fdc80abf018000b10dd";
  EXPECT_EQ(digest_of_files({one, two}), abc_first);
  EXPECT_TRUE(is_digest_of(abc_first, {two, one}));
  EXPECT_TRUE(is_digest_of(empty_first, {two, one}));
  EXPECT_FALSE(is_digest_of(empty_first, {one, two}));
  EXPECT_FALSE(is_digest_of(abc_first, {one}));
}

TEST(ModelFile, SaysOfABenchFileThatItIsOne) {
  try {
    (void)parse_model("kind = \"bar\"\n[sampling]\nfrequency_Hz = 1e6\n[[gauges]]\nname = \"g1\"\n",
                      "bench.toml");
    FAIL() << "a bench file was taken for a model";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("bench file"), std::string::npos) << error.what();
  }
}

TEST(ModelFile, RefusesAHistoryThatWasEdited) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  begin_step(file, "add temperature", "2026-01-02T03:04:05Z");
  file.history.back().before += "# a better past\n";
  try {
    (void)parse_model(format_model(file), "m.toml");
    FAIL() << "an edited history was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("history"), std::string::npos) << error.what();
  }
}

TEST(ModelFile, RefusesALedgerOfWhichAnyNumberWasEditedOrAStepCutOff) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  begin_step(file, "diagnose", "2026-01-02T03:04:05Z");
  ModelStep& step = file.history.back();
  step.note = "after lunch";
  step.data_sha256 = "0123456789abcdef";
  step.verdict = "named";
  step.fit = StepFit{6, 1.25, 2600.0, 1e-6, 2e-6};
  step.held_out = StepHeldOut{1.75, 1.125, 1.0625};
  step.tests = {{"temperature", 0.375, 0.0625, "1/K", -31.5, 62.5, "named", {}}};
  begin_step(file, "add crosstalk:g1", "2026-01-02T03:05:05Z");
  const std::string sound = format_model(file);
  EXPECT_EQ(format_model(parse_model(sound, "m.toml")), sound);

  const auto refused = [](const std::string& text) {
    try {
      (void)parse_model(text, "m.toml");
    } catch (const InputError& error) {
      return std::string(error.what()).find("ledger") != std::string::npos;
    }
    return false;
  };
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"1.25", "1.0"},
           {"1.125", "1.0"},
           {"-31.5", "-41.5"},
           {"0.375", "0.5"},
           {"62.5", "72.5"},
           {"after lunch", "before lunch"},
           {"0123456789abcdef", "0123"},
           {"verdict = \"named\"", "verdict = \"tied\""}}) {
    std::string text = sound;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    EXPECT_TRUE(refused(text.replace(text.find(from), from.size(), to))) << from;
  }
  EXPECT_TRUE(refused(sound.substr(0, sound.rfind("\n[[history]]"))));
  std::string unsealed = sound;
  const std::size_t seal = unsealed.find("ledger = ");
  EXPECT_TRUE(refused(unsealed.erase(seal, unsealed.find('\n', seal) + 1 - seal)));
}

// A model may be edited, and no step is said to have done it.
TEST(ModelFile, KnowsWhatWasEditedByHandAfterItsLastStep) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  begin_step(file, "add temperature", "2026-01-02T03:04:05Z");
  file.model.effects.push_back(use_named("temperature"));
  const std::string sound = format_model(file);
  EXPECT_FALSE(parse_model("# of the blue bar\n" + sound, "m.toml").edited_by_hand);

  std::string text = sound;
  const std::size_t at = text.find("value = ") + 8;
  text.replace(at, text.find('\n', at) - at, "5.5e9");
  ModelFile edited = parse_model(text, "m.toml");
  EXPECT_TRUE(edited.edited_by_hand);
  EXPECT_TRUE(parse_model(format_model(edited), "m.toml").edited_by_hand);
  EXPECT_FALSE(edited.at(0).edited_by_hand);

  begin_step(edited, "add crosstalk:g1", "2026-01-02T03:05:05Z");
  EXPECT_FALSE(edited.edited_by_hand);
  const ModelFile again = parse_model(format_model(edited), "m.toml");
  EXPECT_FALSE(again.edited_by_hand);
  EXPECT_FALSE(again.history.front().edited_by_hand);
  EXPECT_TRUE(again.history.back().edited_by_hand);
}

TEST(ModelFile, TakesAStateCutOutForAnEdit) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  begin_step(file, "add temperature", "2026-01-02T03:04:05Z");
  std::string text = format_model(file);
  const std::size_t state = text.find("state = ");
  ASSERT_NE(state, std::string::npos);
  text.erase(state, text.find('\n', state) + 1 - state);
  EXPECT_TRUE(parse_model(text, "m.toml").edited_by_hand);
}

TEST(ModelFile, HoldsBoundsOfItsOwnWithinTheEffectsOwn) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  file.model.find("three-element-bar")->values[0].bounds = std::array{5e9, 6e9};
  const std::string text = format_model(file);
  const ModelFile back = parse_model(text, "m.toml");
  ASSERT_TRUE(back.model.effects[0].values[0].bounds);
  EXPECT_EQ(*back.model.effects[0].values[0].bounds, (std::array{5e9, 6e9}));
  EXPECT_EQ(format_model(back), text);
  for (const char* wrong : {"[6e+09, 5e+09]", "[-1.0, 6e+09]", "[5e+09]", "[5.8e+09, 6e+09]"}) {
    std::string own = text;
    const std::size_t at = own.find("bounds = [") + 9;
    own.replace(at, own.find(']', at) + 1 - at, wrong);
    EXPECT_THROW((void)parse_model(own, "m.toml"), InputError) << wrong;
  }
}

// Halves that are pushed against each other and halves that are carried along make up the layer.
TEST(Transfers, OfASectionThatTakesNextToNothingToMoveAreThoseOfALayer) {
  const Bench bench = bench_of(BenchKind::shpb);
  const auto with_radial = [&](double s, double waves) {
    Model model = paper_model(BenchKind::shpb, false);
    model.effects.push_back(use_named("specimen-inertia"));
    model.effects.back().values[0].value = 1.0;
    model.effects.push_back(use_named("radial-inertia"));
    model.effects.back().values[0].value = s;
    model.effects.back().values[1].value = waves;
    auto all = said(model, bench);
    all.pop_back();  // the strength itself
    return all;
  };
  EXPECT_LT(difference(with_radial(0.0, 0.0), with_radial(1e-10, 1.0)), 1e-9);
  EXPECT_GT(difference(with_radial(1.0, 0.0), with_radial(1.0, 1.0)), 1e-4);
}

TEST(ModelFile, ReadsBackThePapersModelOfEveryBench) {
  for (const BenchKind kind : {BenchKind::bar, BenchKind::shpb, BenchKind::impact}) {
    ModelFile file;
    file.model = paper_model(kind, kind == BenchKind::impact);
    EXPECT_EQ(format_model(parse_model(format_model(file), "m.toml")), format_model(file));
  }
}

TEST(ModelFile, RefusesUnknownEffectsOutOfBoundsAndWrongUnits) {
  const std::string head = "kolsky_model = 1\nkind = \"bar\"\n[[effects]]\n";
  EXPECT_THROW((void)parse_model(head + "id = \"warp\"\n", "m"), InputError);
  EXPECT_THROW((void)parse_model(head + "id = \"interface-friction\"\n", "m"), InputError);
  EXPECT_THROW((void)parse_model(head + "id = \"second-relaxation\"\n[effects.parameters.D]\n"
                                        "value = -1e-12\n",
                                 "m"),
               InputError);
  EXPECT_THROW((void)parse_model(head + "id = \"second-relaxation\"\n[effects.parameters.D]\n"
                                        "value = 1e-12\nunit = \"1/MPa\"\n",
                                 "m"),
               InputError);
}

// Files from before it had waves across the section.
TEST(ModelFile, HasTheFirstTermOfRadialInertiaWhereItSaysNoMore) {
  const Model model = parse_model(
                          "kolsky_model = 1\nkind = \"shpb\"\n[[effects]]\n"
                          "id = \"radial-inertia\"\n[effects.parameters.s]\nvalue = 1\n",
                          "m")
                          .model;
  ASSERT_EQ(model.effects.back().id(), "radial-inertia");
  EXPECT_EQ(model.effects.back().values[0].value, 1.0);
  EXPECT_EQ(model.effects.back().values[1].value, 0.0);
}

TEST(ModelFile, RefusesAPriorThatIsNoDeviation) {
  const std::string head =
      "kolsky_model = 1\nkind = \"bar\"\n[[effects]]\nid = \"gauge-factor:g2\"\n"
      "[effects.parameters.kappa]\nvalue = 0.01\n";
  EXPECT_EQ(parse_model(head + "prior_sd = 0.01\n", "m").model.effects[0].values[0].prior_sd, 0.01);
  for (const char* none : {"0", "-0.01", "nan"}) {
    try {
      (void)parse_model(head + "prior_sd = " + none + "\n", "m");
      ADD_FAILURE() << none << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("prior_sd"), std::string::npos) << error.what();
    }
  }
}

// An effect that was added is fitted either way unless its file says which, and stays so.
TEST(ModelFile, KeepsWhetherAFormIsOpen) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  file.model.effects.push_back(use_named("mains-hum"));
  const auto again = [&file] {
    return *parse_model(format_model(file), "m.toml").model.find("mains-hum");
  };
  EXPECT_FALSE(again().form_open);
  EXPECT_FALSE(again().per_shot);
  file.model.effects.back().form_open = true;
  EXPECT_TRUE(again().form_open);
  file.model.effects.back().form_open = false;
  file.model.effects.back().per_shot = true;
  EXPECT_TRUE(again().per_shot);
  EXPECT_FALSE(again().form_open);
  // What a fit has found is found.
  file.model.effects.back().per_shot = false;
  file.model.effects.back().values.front().sd = 1e-7;
  EXPECT_FALSE(again().form_open);
}

}  // namespace
}  // namespace kolsky
