// Effects that a model file declares by formula, on campaigns made in the time domain.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/files/models/model_file.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "processing/criticism/verdict/distinction.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

std::vector<Shot> shots_with(std::uint64_t seed, const std::string& effect) {
  testing::CampaignWishes wishes{.seed = seed,
                                 .shots = 6,
                                 .tolerances = testing::Tolerances::none,
                                 .samples = 2048,
                                 .rate_Hz = 1e6};
  testing::Campaign made = testing::draw_campaign(wishes);
  if (!effect.empty()) {
    testing::hide(made, testing::parse_effect(effect));
  }
  return testing::shots_of(made);
}

/// The paper's model that also declares an effect.
Model declaring(const std::string& expression) {
  ModelFile paper;
  paper.model = paper_model(BenchKind::bar, false);
  return parse_model(format_model(paper) + expression, "m.toml").model;
}

const char* const kCreep = R"toml(
[[expressions]]
id = "my-creep"
stage = "sensor"
formula = "1 - c/(1 + s*tau)"
[expressions.parameters.c]
unit = "-"
null = 0.0
bounds = [0.0, 0.5]
typical = 0.01
[expressions.parameters.tau]
unit = "s"
starts = [3e-5, 1e-4, 3e-4]
bounds = [1e-5, 1e-2]
typical = 1e-5
)toml";

const char* const kBranch = R"toml(
[[expressions]]
id = "my-branch"
stage = "material"
formula = "D/(1 + s*tau)"
[expressions.parameters.D]
unit = "1/Pa"
null = 0.0
bounds = [0.0, 1e-9]
typical = 1e-12
[expressions.parameters.tau]
unit = "s"
starts = [2e-6, 5e-6, 1.2e-5, 3e-5, 8e-5, 2e-4, 6e-4, 2e-3]
bounds = [1e-6, 1e-1]
typical = 1e-5
)toml";

// The adhesive's creep is in no library (see Diagnosis.CallsUnknownWhatTheLibraryDoesNotHold).
TEST(Expression, NamesWhatTheLibraryDoesNotHoldAndFindsItsStrength) {
  const Campaign campaign = read_campaign(shots_with(79, "x-gauge-creep:g2=0.05"));
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, declaring(kCreep), {});
  ASSERT_EQ(diagnosis.effects, std::vector<std::string>{"my-creep:g2"});
  const EffectUse& found = *diagnosis.model->find("my-creep:g2");
  EXPECT_LT(std::abs(found.values[0].value - 0.05), 4.0 * found.values[0].sd + 5e-4);
  EXPECT_LT(std::abs(found.values[1].value - 1e-4), 4.0 * found.values[1].sd + 2e-6);
  EXPECT_NEAR(diagnosis.held_out.after, diagnosis.held_out.floor, 0.06);
}

// Whichever of the two a fit's last digit favours.
TEST(Expression, StandsForNoTieThatTheLibraryIsIn) {
  for (const std::uint64_t seed : {81U, 82U, 83U}) {
    const Campaign campaign = read_campaign(shots_with(seed, "second-relaxation=2e-12,tau=3e-5"));
    Study study(campaign, 0.0, Workers{});
    const Diagnosis diagnosis = diagnose(study, declaring(kBranch), {});
    ASSERT_EQ(diagnosis.effects.size(), 1U) << seed;
    EXPECT_NE(diagnosis.effects[0], "my-branch") << seed;
    const auto& ties = diagnosis.tied_with.at(diagnosis.effects[0]);
    EXPECT_NE(std::ranges::find(ties, "my-branch"), ties.end()) << seed;
  }
}

TEST(Expression, IsFittedLikeTheLibrarysEffectOfTheSameFormula) {
  const Campaign campaign = read_campaign(shots_with(91, ""));
  Study one(campaign, 0.0, Workers{});
  Model library = paper_model(BenchKind::bar, false);
  library.effects.push_back(use_named("second-relaxation"));
  const Studied by_library = one.fit(library);
  Study other(campaign, 0.0, Workers{});
  Model own = declaring(kBranch);
  own.effects.push_back(use_named("my-branch", own));
  const Studied by_formula = other.fit(own);
  EXPECT_NEAR(by_formula.fit.chi2, by_library.fit.chi2, 1e-6 * by_library.fit.chi2);
}

TEST(Distinction, IsNoneBetweenTwoNamesOfOneEffect) {
  const Campaign campaign = read_campaign(shots_with(91, ""));
  Study study(campaign, 0.0, Workers{});
  const Model model = declaring(kBranch);
  const auto list = distinctions(study, study.fit(paper_model(BenchKind::bar, false)), {});
  EXPECT_TRUE(list.empty());
  const auto own = distinctions(study, study.fit(model), {"my-branch"});
  ASSERT_EQ(own.size(), 1U);
  ASSERT_FALSE(own.front().rivals.empty());
  const auto twin = std::find_if(own.front().rivals.begin(), own.front().rivals.end(),
                                 [](const auto& r) { return r.effect == "second-relaxation"; });
  ASSERT_NE(twin, own.front().rivals.end());
  EXPECT_GT(twin->cosine, 1.0 - 1e-6);
  EXPECT_GT(own.front().absorbed_share, 0.5) << "moduli take up most of a branch";
  EXPECT_LT(own.front().absorbed_share, 1.0);
  for (const Resemblance& rival : own.front().rivals) {
    EXPECT_GE(rival.cosine, 0.0);
    EXPECT_LE(rival.cosine, 1.0);
  }
}

TEST(Distinction, IsNoneBeyondTheBoundsOfAStrength) {
  const Campaign campaign = read_campaign(shots_with(91, ""));
  Study study(campaign, 0.0, Workers{});
  const Studied fitted = study.fit(paper_model(BenchKind::bar, false));
  const auto of_most = [&](const std::string& most) {
    std::string creep = kCreep;
    creep.replace(creep.find("0.5]"), 3, most);
    creep.replace(creep.find("0.01"), 4, "1e-6");
    Studied declared = fitted;
    declared.model.expressions = declaring(creep).expressions;
    return distinctions(study, declared, {"my-creep"}).front();
  };
  const Distinction wide = of_most("0.5");
  ASSERT_LT(wide.detectable, wide.identifiable);
  ASSERT_LT(wide.identifiable, 0.5);
  const Distinction less =
      of_most(fmt::format("{:.9f}", std::sqrt(wide.detectable * wide.identifiable)));
  EXPECT_TRUE(std::isfinite(less.detectable));
  EXPECT_FALSE(std::isfinite(less.identifiable));
  EXPECT_FALSE(std::isfinite(of_most(fmt::format("{:.9f}", 0.5 * wide.detectable)).detectable));
}

TEST(Expression, OfABallIsRefusedWithTheReasonWhateverItsStage) {
  ModelFile ball;
  ball.model = paper_model(BenchKind::impact, true);
  for (const char* stage : {"propagation", "boundary", "sensor"}) {
    try {
      static_cast<void>(parse_model(
          format_model(ball) + "\n[[expressions]]\nid = \"mine\"\nstage = \"" + stage +
              "\"\nformula = \"" + (stage == std::string("boundary") ? "a" : "1 + a") +
              "\"\n[expressions.parameters.a]\nunit = \"-\"\nnull = 0.0\nbounds = [-0.1, 0.1]\n"
              "typical = 0.01\n",
          "m.toml"));
      ADD_FAILURE() << stage << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("a ball's force is calculated by finite elements"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(Model, ThatLacksWavesOrAMaterialIsRefusedBeforeItIsCompared) {
  const Campaign campaign = read_campaign(shots_with(91, ""));
  for (const char* id : {"elementary-waves", "three-element-bar"}) {
    Model model = paper_model(BenchKind::bar, false);
    std::erase_if(model.effects, [&](const EffectUse& use) { return use.id() == id; });
    try {
      const Composition composition(model, campaign);
      ADD_FAILURE() << id << " was not missed";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(id), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace kolsky
