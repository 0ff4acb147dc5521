#include "processing/criticism/waterfall/waterfall.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

struct Made {
  testing::Campaign truth;
  Campaign campaign;
};

Made make(std::uint64_t seed, const std::vector<std::string>& effects, bool split = false) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = 6, .samples = 2048, .rate_Hz = 1e6, .split = split};
  if (split) {
    wishes.gauges = 3;
  }
  testing::Campaign truth = testing::draw_campaign(wishes);
  for (const std::string& effect : effects) {
    testing::hide(truth, testing::parse_effect(effect));
  }
  Campaign campaign = read_campaign(testing::shots_of(truth));
  return {std::move(truth), std::move(campaign)};
}

Model paper_with(const std::vector<std::string>& effects, BenchKind kind = BenchKind::bar) {
  Model model = paper_model(kind, false);
  for (const std::string& id : effects) {
    model.effects.push_back(use_named(id));
  }
  return model;
}

std::vector<std::string> ids_of(const std::vector<LineageStep>& steps) {
  std::vector<std::string> ids;
  for (const LineageStep& step : steps) {
    ids.push_back((step.removed ? "-" : "") + step.effect);
  }
  return ids;
}

TEST(Lineage, AddsInTheOrderOfTheLedgerAndThenInThatOfTheModel) {
  const Model first = paper_with({});
  const Model last = paper_with({"temperature", "gauge-position:g2", "crosstalk:g3"});
  const auto steps = lineage(first, last, {"gauge-position:g2", "mains-hum"});
  EXPECT_EQ(ids_of(steps),
            (std::vector<std::string>{"", "gauge-position:g2", "temperature", "crosstalk:g3"}));
  EXPECT_EQ(steps[1].model.find("temperature"), nullptr);
  EXPECT_NE(steps[3].model.find("temperature"), nullptr);
}

TEST(Lineage, CountsAFiledNumberOnlyOnceItIsFreedOfItsPrior) {
  Model first = paper_with({"gauge-position:g2", "gauge-position:g3"});
  for (const char* id : {"gauge-position:g2", "gauge-position:g3"}) {
    first.find(id)->values[0].prior_sd = 2e-4;
  }
  Model last = first;
  last.find("gauge-position:g3")->values[0].prior_sd = 0.0;
  EXPECT_EQ(ids_of(lineage(first, last, {})), (std::vector<std::string>{"", "gauge-position:g3"}));
  EXPECT_EQ(ids_of(lineage(first, first, {"gauge-position:g2"})), (std::vector<std::string>{""}));
}

TEST(Lineage, CountsAHumThoughAPriorBoundsIt) {
  const Model first = paper_with({});
  Model last = paper_with({"mains-hum"});
  last.find("mains-hum")->values[0].prior_sd = 3e-5;
  last.find("mains-hum")->values[1].prior_sd = 3e-5;
  EXPECT_EQ(ids_of(lineage(first, last, {})), (std::vector<std::string>{"", "mains-hum"}));
  EXPECT_EQ(ids_of(lineage(last, first, {})), (std::vector<std::string>{"", "-mains-hum"}));
}

TEST(Lineage, TakesOutWhatTheLastModelNoLongerHolds) {
  const auto steps = lineage(paper_with({"crosstalk:g3"}), paper_with({"temperature"}), {});
  EXPECT_EQ(ids_of(steps), (std::vector<std::string>{"", "-crosstalk:g3", "temperature"}));
  EXPECT_EQ(steps.back().model.find("crosstalk:g3"), nullptr);
}

TEST(Waterfall, FallsToTheNoiseByWhatWasHiddenAndTheModuliComeRight) {
  const Made made = make(78, {"gauge-position:g3=0.003", "temperature=0.004"});
  Study study(made.campaign, 0.0, Workers{});
  const Waterfall fall = waterfall(
      study, lineage(paper_with({}), paper_with({"temperature", "gauge-position:g3"}), {}));
  ASSERT_EQ(fall.steps.size(), 3U);
  EXPECT_GT(fall.steps[0].held_out, fall.steps[1].held_out);
  EXPECT_GT(fall.steps[1].held_out, fall.steps[2].held_out);
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_GT(fall.steps[i].gain, 100.0);
    EXPECT_GE(fall.steps[i].better, 5U);
  }
  EXPECT_NEAR(fall.steps[2].held_out, fall.floor, 0.06);
  EXPECT_GT(fall.closed(), 0.95);
  EXPECT_LT(fall.repeats, 0.05 * fall.floor);
  const auto& truth = made.truth.world.material;
  const double moduli[] = {truth.E1_Pa, truth.E2_Pa, truth.eta2_Pa_s};
  double worst_before = 0.0;
  for (std::size_t p = 0; p < 3; ++p) {
    const MovedNumber& after = fall.steps[2].numbers[p];
    const MovedNumber& before = fall.steps[0].numbers[p];
    EXPECT_LT(std::abs(after.value - moduli[p]), 4.0 * after.sd) << after.name;
    worst_before = std::max(worst_before, std::abs(before.value - moduli[p]) / before.sd);
  }
  EXPECT_GT(worst_before, 5.0);
  EXPECT_NEAR(fall.steps[2].strengths.at(0).value, 0.003, 2e-4);
}

/// What a model lacks that depends on the shots differs between them, and passes for noise in the
/// levels.
TEST(Waterfall, TellsWhatThereIsBesideTheQuietOfAModelThatShotsFailDifferently) {
  const Made made = make(79, {"amplitude-dependence=6"});
  Study study(made.campaign, 0.0, Workers{});
  const Waterfall without = waterfall(study, lineage(paper_with({}), paper_with({}), {}));
  EXPECT_GT(without.last_beside_quiet.value(), 1.5 * without.steps.back().held_out);
  const Waterfall with =
      waterfall(study, lineage(paper_with({}), paper_with({"amplitude-dependence"}), {}));
  EXPECT_LT(with.last_beside_quiet.value(), 1.1 * with.steps.back().held_out);
}

TEST(Waterfall, CreditsAnEffectThatIsNotThereWithNothing) {
  const Made made = make(201, {});
  Study study(made.campaign, 0.0, Workers{});
  const Waterfall fall =
      waterfall(study, lineage(paper_with({}), paper_with({"gauge-factor:g2"}), {}));
  ASSERT_EQ(fall.steps.size(), 2U);
  EXPECT_LT(fall.steps[1].gain, 10.0);
  EXPECT_NEAR(fall.steps[0].held_out, fall.floor, 0.06);
  EXPECT_TRUE(fall.steps[0].curve.strain.empty());
}

double pull_of(const Model& model) {
  double pull = 0.0;
  for (const EffectUse& use : model.effects) {
    for (const ModelValue& value : use.values) {
      if (value.prior_sd > 0.0) {
        pull += std::pow((value.value - value.prior_mean) / value.prior_sd, 2);
      }
    }
  }
  return pull;
}

double sum_of(const std::vector<double>& squares) {
  return std::accumulate(squares.begin(), squares.end(), 0.0);
}

// A wrong gauge factor that a filed one takes up leaves no misfit, only a pull.
TEST(Waterfall, CountsAsTheDiagnosisDoesWhatFiledNumbersPull) {
  Made made = make(78, {"gauge-factor:g2=0.025"});
  for (Gauge& gauge : made.campaign.bench.gauges) {
    gauge.strain_per_V = Measured{5e-4, 0.002 * 5e-4};
  }
  Model with = paper_with({"gauge-factor:g2"});
  Study study(made.campaign, 0.0, Workers{});
  const Waterfall fall = waterfall(study, lineage(paper_with({}), with, {}));
  ASSERT_EQ(fall.steps.size(), 2U);
  Study again(made.campaign, 0.0, Workers{});
  const Studied after = again.fit(with);
  const Studied before = again.refit(again.fit(paper_with({}), LearnNoise::no));
  const double residuals = static_cast<double>(again.residuals().size());
  EXPECT_NEAR(fall.steps[0].held_out * residuals,
              sum_of(held_out_squares(before, again)) + pull_of(before.model),
              0.02 * pull_of(before.model));
  EXPECT_NEAR(fall.steps[1].held_out * residuals,
              sum_of(held_out_squares(after, again)) + pull_of(after.model), 2.0);
  // (0.025 / 0.002)^2, less what the other gauges' factors take on themselves.
  EXPECT_GT(fall.steps[1].relief, 50.0);
  EXPECT_GE(fall.steps[1].gain, fall.steps[1].relief - 5.0);
  EXPECT_EQ(fall.steps[1].better, 6U);
  Study third(made.campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(third, paper_with({}), {});
  ASSERT_EQ(diagnosis.effects, std::vector<std::string>{"gauge-factor:g2"});
  EXPECT_NEAR(fall.steps[0].held_out, diagnosis.held_out.before, 2e-3);
  EXPECT_NEAR(fall.steps[1].held_out, diagnosis.held_out.after, 2e-3);
}

// Numbers are those of the model's own fit, and uncertain by what it leaves.
TEST(Waterfall, GivesTheNumbersThatAFitGivesWidenedByWhatItLeaves) {
  const Made made = make(6, {"specimen-nonlinearity=2"}, true);
  const Model first = paper_with({}, BenchKind::shpb);
  Study study(made.campaign, 0.0, Workers{});
  const Waterfall fall =
      waterfall(study, lineage(first, paper_with({"specimen-nonlinearity"}, BenchKind::shpb), {}));
  Study fresh(made.campaign, 0.0, Workers{});
  const Studied fitted = fresh.fit(first);
  const auto& law = fitted.model.find("three-element-specimen")->values;
  const double left =
      std::sqrt(fitted.fit.chi2 / fitted.fit.degrees_of_freedom(fitted.composition));
  ASSERT_GT(left, 1.0);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(fall.steps[0].numbers[p].value, law[p].value, 0.1 * law[p].sd);
    EXPECT_NEAR(fall.steps[0].numbers[p].sd / (left * law[p].sd), 1.0, 0.02);
  }
  EXPECT_TRUE(far_from_fitting(fall.steps[0], fall));
  EXPECT_FALSE(far_from_fitting(fall.steps[1], fall));
}

/// The specimen's law stepped through time: a spring whose modulus grows with the strain, in series
/// with a spring and a dashpot side by side.
double stress_after(double rate, double time_s, const std::vector<ModelValue>& law, double b) {
  constexpr int kSteps = 200000;
  const double dt = time_s / kSteps;
  double q = 0.0;
  const auto stress = [&](double strain, double inner) {
    return law[0].value * (1.0 + b * strain) * (strain - inner);
  };
  for (int n = 0; n < kSteps; ++n) {
    const auto slope = [&](double at, double inner) {
      return (stress(rate * at, inner) - law[1].value * inner) / law[2].value;
    };
    const double t = dt * n;
    const double k1 = slope(t, q);
    const double k2 = slope(t + 0.5 * dt, q + 0.5 * dt * k1);
    q += dt * k2;
  }
  return stress(rate * time_s, q);
}

TEST(SpecimenCurve, IsThatOfTheLawSteppedThroughTime) {
  const Made made = make(31, {}, true);
  Study study(made.campaign, 0.0, Workers{});
  constexpr double kRate = 400.0;
  constexpr double kLoading_s = 100e-6;
  for (const double b : {0.0, 3.0}) {
    Model model = paper_with(
        b == 0.0 ? std::vector<std::string>{} : std::vector<std::string>{"specimen-nonlinearity"},
        BenchKind::shpb);
    auto& law = model.find("three-element-specimen")->values;
    law[0].value = 2e9;
    law[1].value = 5e9;
    law[2].value = 3e5;
    if (b != 0.0) {
      model.find("specimen-nonlinearity")->values[0].value = b;
    }
    const SpecimenCurve curve = specimen_curve(study.as_it_is(model), made.campaign, kRate);
    ASSERT_FALSE(curve.strain.empty());
    EXPECT_NEAR(curve.strain.back(), kRate * kLoading_s, 1e-12);
    const std::size_t last = curve.strain.size() - 1;
    for (std::size_t i = 1; i <= last; ++i) {
      const auto share = static_cast<double>(i) / static_cast<double>(last);
      EXPECT_NEAR(curve.strain[i], share * kRate * kLoading_s, 1e-12);
      const double truth = stress_after(kRate, curve.strain[i] / kRate, law, b);
      // A tenth of what such curves are known to.
      EXPECT_NEAR(curve.stress_Pa[i], truth, 1e-4 * truth) << "b = " << b << " at " << i;
    }
  }
}

// A fit may end where the spring in series is rigid: then stress is that of the other two from the
// first moment on.
TEST(SpecimenCurve, BeginsAtOnceWhereTheSpringInSeriesIsRigid) {
  const Made made = make(31, {}, true);
  Study study(made.campaign, 0.0, Workers{});
  constexpr double kRate = 2400.0;
  constexpr double kE2_Pa = 4e8;
  constexpr double kEta2_Pa_s = 3e5;
  Model model = paper_with({}, BenchKind::shpb);
  auto& law = model.find("three-element-specimen")->values;
  law[0].value = 1e13;
  law[1].value = kE2_Pa;
  law[2].value = kEta2_Pa_s;
  const SpecimenCurve curve = specimen_curve(study.as_it_is(model), made.campaign, kRate);
  for (std::size_t i = 1; i < curve.strain.size(); ++i) {
    const double truth = kE2_Pa * curve.strain[i] + kEta2_Pa_s * kRate;
    EXPECT_NEAR(curve.stress_Pa[i], truth, 2e-3 * truth) << i;
  }
}

}  // namespace
}  // namespace kolsky
