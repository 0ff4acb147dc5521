#include "clients/cli/reports/reduced_shot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace kolsky::cli {
namespace {

// Strain rises at 1000 1/s for 100 us and stays; stress is 1 GPa times it, then falls away.
Reduction ramp() {
  Reduction reduction;
  for (int i = 0; i <= 200; ++i) {
    const double strain = 1e-3 * std::min(i, 100);
    reduction.time_s.push_back(1e-6 * i);
    reduction.strain.push_back(strain);
    reduction.stress_Pa.push_back(i <= 100 ? 1e9 * strain : 1e8 * (1.0 - 0.01 * (i - 100)));
  }
  reduction.quality.reducible = true;
  return reduction;
}

TEST(LoopSummary, DescribesALoop) {
  const LoopSummary loop = summarise(ramp());
  EXPECT_DOUBLE_EQ(loop.peak_stress_Pa, 1e8);
  EXPECT_DOUBLE_EQ(loop.strain_at_peak, 0.1);
  EXPECT_DOUBLE_EQ(loop.peak_strain, 0.1);
  EXPECT_NEAR(loop.mean_strain_rate_per_s, 1000.0, 1e-6);
  // From 5 % of the stress, at 5 us, to 98 % of the strain, at 98 us.
  EXPECT_NEAR(loop.loading_s, 93e-6, 2e-6);
  EXPECT_EQ(loop.no_loading, "");
}

TEST(LoopSummary, IsNotTurnedRoundByASpikeAtTheStart) {
  Reduction spiked = ramp();
  spiked.stress_Pa[0] = -5e7;
  spiked.stress_Pa[1] = -3e7;
  const LoopSummary loop = summarise(spiked);
  EXPECT_DOUBLE_EQ(loop.peak_stress_Pa, 1e8);
  EXPECT_DOUBLE_EQ(loop.peak_strain, 0.1);
  EXPECT_EQ(loop.no_loading, "");
}

/// As bars leave it that are too short for the pulse.
TEST(LoopSummary, IsNoneWhereThereIsNoLoading) {
  const auto summary_of = [](const Reduction& reduction) {
    ReducedShot reduced;
    reduced.reduction = reduction;
    const std::string text = report(reduced, Terminal{});
    EXPECT_NE(text.find("no loading: " + summarise(reduction).no_loading), std::string::npos)
        << text;
    EXPECT_EQ(text.find("mean strain rate"), std::string::npos) << text;
    return nlohmann::json::parse(to_text(describe(reduced)))["summary"];
  };
  Reduction pulled = ramp();
  for (double& strain : pulled.strain) {
    strain = -strain - 1e-3;
  }
  const auto pulled_told = summary_of(pulled);
  for (const char* name :
       {"peak_stress_Pa", "strain_at_peak", "peak_strain", "mean_strain_rate_per_s", "loading_s"}) {
    EXPECT_TRUE(pulled_told.at(name).is_null()) << name;
  }
  const std::string why = pulled_told["no_loading"];
  EXPECT_NE(why.find("nowhere shortened"), std::string::npos) << why;
  EXPECT_EQ(why.find("window_overlap"), std::string::npos) << why;

  Reduction begun = ramp();
  for (auto* history : {&begun.time_s, &begun.strain, &begun.stress_Pa}) {
    history->erase(history->begin(), history->begin() + 40);
  }
  EXPECT_EQ(summarise(begun).no_loading, "");
  begun.quality.checks.push_back({.name = "window_overlap", .verdict = Verdict::fail});
  const std::string midway = summary_of(begun)["no_loading"];
  EXPECT_NE(midway.find("begin at 40 % of the largest stress"), std::string::npos) << midway;
  EXPECT_NE(midway.find("window_overlap"), std::string::npos) << midway;
}

TEST(LoopSummary, IsZeroWhereThereIsNoLoop) {
  const LoopSummary loop = summarise({});
  EXPECT_EQ(loop.peak_stress_Pa, 0.0);
  EXPECT_EQ(loop.loading_s, 0.0);
  EXPECT_FALSE(loop.no_loading.empty());
}

TEST(TrueValues, AreNullWhereTheSpecimenWouldHaveNoLengthLeft) {
  ReducedShot reduced;
  reduced.reduction = ramp();
  reduced.request.with_true = true;
  reduced.reduction.strain.back() = 1.0;
  reduced.reduction.strain.front() = -0.1;
  const auto json = nlohmann::json::parse(to_text(describe(reduced)));
  EXPECT_TRUE(json["strain_true"].back().is_null());
  EXPECT_TRUE(json["stress_true_Pa"].back().is_null());
  EXPECT_NEAR(json["strain_true"].front().get<double>(), -std::log(1.1), 1e-15);
}

TEST(BarModel, IsAssumedOnlyWhereNobodySaysWhatTheBarsAre) {
  Shot shot;
  shot.bench.output = Bar{};
  EXPECT_TRUE(assumes_bar_model(shot, {}));
  ReductionOptions told;
  told.bar_model = paper_pmma();
  EXPECT_FALSE(assumes_bar_model(shot, told));
  shot.bar_model = paper_pmma();
  EXPECT_FALSE(assumes_bar_model(shot, {}));
  shot.bar_model.reset();
  shot.bench.input.youngs_modulus_Pa = {210e9, 0.0};
  EXPECT_TRUE(assumes_bar_model(shot, {})) << "the output bar is not elastic";
  shot.bench.output->youngs_modulus_Pa = {210e9, 0.0};
  EXPECT_FALSE(assumes_bar_model(shot, {}));
}

}  // namespace
}  // namespace kolsky::cli
