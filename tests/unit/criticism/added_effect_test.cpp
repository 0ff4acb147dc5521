// What a user adds by hand and fits: the campaign's generator works in time and has no part in it.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/verdict/at_bounds.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

testing::CampaignWishes wishes(bool split) {
  return {.seed = 5, .shots = 3, .gauges = split ? 3 : 4, .noise_strain = 4e-6, .split = split};
}

struct Added {
  testing::Campaign truth;
  Studied studied;

  [[nodiscard]] const ModelValue& value(const std::string& id, std::size_t parameter) const {
    return studied.model.find(id)->values[parameter];
  }
  /// In its deviations.
  [[nodiscard]] double off(const std::string& id, std::size_t parameter, double true_value) const {
    const ModelValue& own = value(id, parameter);
    return std::abs(own.value - true_value) / own.sd;
  }
};

/// @param hidden  name and strength of each, all of which are added
Added fitted_with(const testing::CampaignWishes& wished,
                  const std::vector<std::pair<std::string, std::string>>& hidden) {
  testing::Campaign truth = testing::draw_campaign(wished);
  Model model = paper_model(wished.split ? BenchKind::shpb : BenchKind::bar, false);
  for (const auto& [name, strength] : hidden) {
    testing::hide(truth, testing::parse_effect(name + "=" + strength));
    model.effects.push_back(use_named(name));
  }
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  return {std::move(truth), study.fit(model)};
}

Added fitted_with(bool split, const std::vector<std::pair<std::string, std::string>>& hidden) {
  return fitted_with(wishes(split), hidden);
}

class Gap : public ::testing::TestWithParam<double> {};

// Closing takes a few samples, less than the records' filter resolves.
TEST_P(Gap, IsFoundWithTheMaterialBehindIt) {
  const double gap_m = GetParam();
  const Added added = fitted_with(true, {{"interface-gap", std::to_string(1e6 * gap_m) + "e-6"}});
  EXPECT_LT(added.off("interface-gap", 0, gap_m), 3.0);
  EXPECT_LT(added.value("interface-gap", 0).sd, 0.5e-6);
  const testing::TrueSpecimen& specimen = added.truth.split->specimen;
  EXPECT_LT(added.off("three-element-specimen", 0, specimen.E1_Pa), 3.0);
  EXPECT_LT(added.off("three-element-specimen", 1, specimen.E2_Pa), 3.0);
  EXPECT_LT(added.off("three-element-specimen", 2, specimen.eta2_Pa_s), 3.0);
  EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Gap, ::testing::Values(3e-6, 10e-6, 20e-6));

// Waves that come back pull the bars apart: dry faces part wherever the specimen would be pulled,
// while it recovers, and meet again later.
TEST(Added, AGapOfDryFacesPullsNothing) {
  for (std::uint64_t seed = 5; seed < 8; ++seed) {
    testing::CampaignWishes wished = wishes(true);
    wished.seed = seed;
    testing::Campaign truth = testing::draw_campaign(wished);
    testing::hide(truth, testing::parse_effect("interface-gap=10e-6,dry=1"));
    Model model = paper_model(BenchKind::shpb, false);
    model.effects.push_back(use_named("interface-gap"));
    const Campaign campaign = read_campaign(testing::shots_of(truth));
    Study study(campaign, 0.0, Workers{});
    const Studied added = study.fit(model);
    const EffectUse& gap = *added.model.find("interface-gap");
    EXPECT_LT(std::abs(gap.values[0].value - 10e-6), 3.5 * gap.values[0].sd) << seed;
    EXPECT_EQ(gap.values[1].value, 2.0) << seed;
    EXPECT_LT(added.misfit.chi2_reduced, 1.1) << seed;
  }
}

// The same without a gap: loose from the beginning.
TEST(Added, AFaceThatPartsPullsNothing) {
  for (std::uint64_t seed = 5; seed < 8; ++seed) {
    testing::CampaignWishes wished = wishes(true);
    wished.seed = seed;
    testing::Campaign truth = testing::draw_campaign(wished);
    testing::hide(truth, testing::parse_effect("interface-gap=1e-12,dry=1"));
    const Campaign campaign = read_campaign(testing::shots_of(truth));
    Study study(campaign, 0.0, Workers{});
    Model model = paper_model(BenchKind::shpb, false);
    EXPECT_GT(study.fit(model).misfit.chi2_reduced, 1.5) << seed;
    model.effects.push_back(use_named("parting-faces"));
    EXPECT_LT(study.fit(model).misfit.chi2_reduced, 1.1) << seed;
  }
}

// The moment is that of the force at the end. A wave that comes back to it, free by then, makes
// none.
TEST(Added, BendingIsNotMadeByWavesThatComeBack) {
  testing::CampaignWishes wished = wishes(false);
  wished.samples = 3000;  // 1.1 round trips and more
  const Added added = fitted_with(wished, {{"end-reflection", "0.05"}, {"bending", "3e-4"}});
  EXPECT_LT(added.off("bending", 0, 3e-4), 3.5) << added.value("bending", 0).value;
  EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1);
}

struct Form {
  std::string hidden;
  std::string name;
  bool per_shot;
};

class OpenForm : public ::testing::TestWithParam<Form> {};

// Whoever adds a hum or a drift does not know whether shots share it.
TEST_P(OpenForm, IsSettledByTheFit) {
  testing::Campaign truth = testing::draw_campaign(wishes(false));
  testing::hide(truth, testing::parse_effect(GetParam().hidden));
  Model model = paper_model(BenchKind::bar, false);
  model.effects.push_back(use_named(GetParam().name));
  model.effects.back().form_open = true;
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Studied added = study.fit(model);
  EXPECT_EQ(added.model.find(GetParam().name)->per_shot, GetParam().per_shot);
  EXPECT_FALSE(added.model.find(GetParam().name)->form_open);
  EXPECT_LT(added.misfit.chi2_reduced, 1.1);
}

INSTANTIATE_TEST_SUITE_P(HumsAndDrifts, OpenForm,
                         ::testing::Values(Form{"mains-hum=3e-5", "mains-hum", true},
                                           Form{"mains-hum=3e-5,phase=0.3", "mains-hum", false},
                                           Form{"baseline-drift:g2=0.1", "baseline-drift:g2",
                                                false}));

/// A model that was fitted without what is hidden, and fitted again with it.
struct AddedLater {
  testing::Campaign truth;
  Model without;
  Studied studied;
};

AddedLater added_to_what_was_fitted(std::uint64_t seed, const std::string& hidden) {
  testing::CampaignWishes wished = wishes(true);
  wished.seed = seed;
  testing::Campaign truth = testing::draw_campaign(wished);
  const testing::HiddenEffect effect = testing::parse_effect(hidden);
  testing::hide(truth, effect);
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  Model without = study.fit(paper_model(BenchKind::shpb, false)).model;
  Model with = without;
  with.effects.push_back(use_named(effect.name()));
  return {std::move(truth), std::move(without), study.fit(with)};
}

// Without the gap the specimen's moduli are nowhere.
TEST(Added, AGapToAModelWhoseSpecimenRanAwayWithoutIt) {
  for (std::uint64_t seed = 5; seed < 8; ++seed) {
    const AddedLater added = added_to_what_was_fitted(seed, "interface-gap=40e-6");
    const ModelValue& gap_m = added.studied.model.find("interface-gap")->values[0];
    EXPECT_LT(std::abs(gap_m.value - 40e-6), 3.5 * gap_m.sd) << seed;
    EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1) << seed;
  }
}

TEST(Added, ANumberAtItsBoundIsSaid) {
  Model model = paper_model(BenchKind::bar, false);
  EffectUse relaxation = use_named("second-relaxation");
  relaxation.values[1].value = relaxation.effect->about().parameters[1].upper;
  model.effects.push_back(relaxation);
  const std::vector<AtBound> there = numbers_at_bounds(model);
  ASSERT_EQ(there.size(), 1U) << "a strength of null is at no bound";
  EXPECT_EQ(there[0].effect, "second-relaxation");
  EXPECT_EQ(there[0].parameter, "tau");
  EXPECT_TRUE(there[0].most);
  EXPECT_NE(in_words(there[0]).find("is the most that it may be"), std::string::npos);
  model.effects.back().values[1].value = 3e-4;
  EffectUse free_end = use_named("end-reflection");
  free_end.values[1].value = free_end.effect->about().parameters[1].upper;
  model.effects.push_back(free_end);
  EXPECT_TRUE(numbers_at_bounds(model).empty()) << "an end that is fixed is at no bound";
}

// The generator's own branch yields a fifth of the hidden one: that becomes the material's.
TEST(Added, ABranchThatYieldsMoreIsTheMaterialsOwnAndSaidToBe) {
  const Added added = fitted_with(true, {{"specimen-second-relaxation", "2e-8,tau=5e-3"}});
  const testing::TrueSpecimen& specimen = added.truth.split->specimen;
  EXPECT_NEAR(added.value("specimen-second-relaxation", 0).value, 1.0 / specimen.E2_Pa,
              0.05 / specimen.E2_Pa);
  const std::string further = "specimen-second-relaxation";
  EXPECT_FALSE(either_branch_text(added.studied.model, further));
  Model alike = added.studied.model;
  for (EffectUse& use : alike.effects) {
    if (use.id() == further) {
      use.values[0].value = 0.5 / added.value("three-element-specimen", 1).value;
    }
  }
  EXPECT_TRUE(either_branch_text(alike, further));
}

TEST(Added, CrosstalkTakesTheNeighbourThatItFits) {
  for (const auto* from : {"2", "4"}) {
    const Added added = fitted_with(false, {{"crosstalk:g3", std::string("0.02,from=") + from}});
    EXPECT_LT(added.off("crosstalk:g3", 0, 0.02), 3.0) << from;
    EXPECT_EQ(added.value("crosstalk:g3", 1).value, from[0] == '2' ? -1.0 : 1.0);
    EXPECT_FALSE(added.value("crosstalk:g3", 1).free);
  }
}

// Half the shortest wave judged is 40 mm here: the gauge is blind to some of what is judged.
TEST(Added, ALengthOfTheReferenceGaugeIsFoundPastItsBlindFrequency) {
  const Campaign bare = read_campaign(testing::shots_of(testing::draw_campaign(wishes(false))));
  const std::string id = "gauge-length:" + bare.bench.gauges[bare.reference].name;
  for (const double length_m : {0.02, 0.05, 0.08}) {
    const Added added = fitted_with(false, {{id, std::to_string(length_m)}});
    EXPECT_LT(added.off(id, 0, length_m), 3.0) << length_m;
    EXPECT_LT(added.value(id, 0).sd, 0.05 * length_m) << length_m;
    EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1) << length_m;
    const testing::TrueMaterial& bar = added.truth.world.material;
    EXPECT_LT(added.off("three-element-bar", 0, bar.E1_Pa), 3.0) << length_m;
    EXPECT_LT(added.off("three-element-bar", 1, bar.E2_Pa), 3.0) << length_m;
  }
}

// A spring that gives way strains the specimen further, and what is strained further is moved
// sideways further, too.
TEST(Added, LateralInertiaOfASpecimenThatSoftens) {
  const Added added = fitted_with(true, {{"radial-inertia", "8"}, {"specimen-nonlinearity", "-6"}});
  EXPECT_LT(added.off("radial-inertia", 0, 8.0), 3.0);
  EXPECT_LT(added.off("specimen-nonlinearity", 0, -6.0), 3.0);
  const testing::TrueSpecimen& specimen = added.truth.split->specimen;
  EXPECT_LT(added.off("three-element-specimen", 0, specimen.E1_Pa), 3.0);
  EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1);
}

// A model that lacks the lateral inertia of a soft specimen is fitted by a spring that is as good
// as rigid. Who adds the inertia then must not be left there.
TEST(Added, ToAModelWhoseSpecimenRanAwayWithoutIt) {
  int ran_away = 0;
  for (std::uint64_t seed = 5; seed < 9; ++seed) {
    const AddedLater added = added_to_what_was_fitted(seed, "radial-inertia=8");
    const double E1_Pa = added.truth.split->specimen.E1_Pa;
    const auto E1 = [](const Model& model) {
      return model.find("three-element-specimen")->values[0];
    };
    ran_away += E1(added.without).value > 10.0 * E1_Pa ? 1 : 0;
    const ModelValue found = E1(added.studied.model);
    EXPECT_LT(std::abs(found.value - E1_Pa), 4.0 * found.sd) << seed;
    EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1) << seed;
  }
  EXPECT_GT(ran_away, 0) << "nothing to find back from";
}

/// An effect as the generator plants it, on a split bar or a bar.
struct Planted {
  bool split;
  std::string hidden;
};

void PrintTo(const Planted& planted, std::ostream* out) {
  *out << (planted.split ? "split bar, " : "bar, ") << planted.hidden;
}

class Every : public ::testing::TestWithParam<Planted> {};

// What the library makes of an effect is what a solver in time makes of the same definition: the
// strength planted comes out, and nothing is left. Lengths of gauges, crosstalk, gaps and a far
// end's reflection have tests of their own. Not here, since a fit alone does not tell them: hums,
// whose strengths are cosines and sines of every gauge, and what a specimen's moduli absorb
// (punching, its dimensions).
TEST_P(Every, EffectIsWhatTheGeneratorMakesOfIt) {
  const std::string& text = GetParam().hidden;
  const testing::HiddenEffect hidden = testing::parse_effect(text);
  testing::CampaignWishes short_records = wishes(GetParam().split);
  short_records.rate_Hz = 1e6;
  short_records.samples = 1800;
  const Added added =
      fitted_with(short_records, {{hidden.name(), text.substr(text.find('=') + 1)}});
  const ModelValue& value = added.value(hidden.name(), 0);
  const double null = find_effect(hidden.id)->about().parameters.front().null_value;
  EXPECT_LT(added.off(hidden.name(), 0, hidden.strength), 3.5) << value.value << " ± " << value.sd;
  EXPECT_GT(added.off(hidden.name(), 0, null), 5.0) << "too small to try it";
  EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1);
}

INSTANTIATE_TEST_SUITE_P(
    OnABar, Every,
    ::testing::Values(
        Planted{false, "second-relaxation=6e-12,tau=3e-4"}, Planted{false, "series-dashpot=5e-8"},
        Planted{false, "fractional-damping=0.9"}, Planted{false, "amplitude-dependence=6"},
        Planted{false, "temperature=0.004"}, Planted{false, "geometric-dispersion=1"},
        Planted{false, "bending=1e-4"}, Planted{false, "bending=1e-4,deflection=1"},
        Planted{false, "gauge-position:g3=0.003"}, Planted{false, "gauge-factor:g2=0.02"},
        Planted{false, "channel-delay:g3=1e-6"}, Planted{false, "amplifier-bandwidth:g3=2e-6"},
        Planted{false, "baseline-drift:g2=0.1"}, Planted{false, "bridge-nonlinearity=20"}));

// Of two branches that may change names the further one is that which yields less.
INSTANTIATE_TEST_SUITE_P(
    OnASplitBar, Every,
    ::testing::Values(Planted{true, "specimen-second-relaxation=1e-9,tau=2e-4"},
                      Planted{true, "specimen-nonlinearity=3"}, Planted{true, "specimen-inertia=1"},
                      Planted{true, "radial-inertia=10"}, Planted{true, "interface-friction=0.6"},
                      Planted{true, "bar-length=0.004"}, Planted{true, "second-relaxation=6e-12"},
                      Planted{true, "temperature=0.004"}, Planted{true, "bridge-nonlinearity=8"}));

}  // namespace
}  // namespace kolsky
