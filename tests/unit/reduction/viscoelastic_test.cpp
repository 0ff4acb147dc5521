// The paper's bench solved in the time domain against the reduction.
#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "processing/reduction/reducer.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::BenchRecords;
using testing::check_of;
using testing::kCore;
using testing::kCover;
using testing::kPmma;
using testing::SolvedShot;
using testing::worst;

BenchModel paper_bench(const RodMaterial& specimen, double specimen_length_m) {
  BenchModel model;
  model.input = {0.7, testing::circle_m2(0.015), kPmma};
  model.specimen = RodShape{specimen_length_m, testing::circle_m2(0.012), specimen};
  model.output = model.input;
  model.pulse.peak_force_N = kPmma.E1_Pa * model.input.area_m2 * 1e-3;
  model.gauges = {{RodId::input, 0.4}, {RodId::output, 0.05}};
  return model;
}

/// Each specimen is solved once. Its density is not filed.
SolvedShot solve(const RodMaterial& material, double length_m, double noise_rms = 0.0) {
  static std::map<std::pair<double, double>, BenchRecords> solved;
  const BenchModel model = paper_bench(material, length_m);
  BenchRecords& records = solved[{material.E1_Pa, length_m}];
  if (records.strains.empty()) {
    records = testing::records_of(model, 3.7e-3);
  }
  SolvedShot made = testing::shot_of(model, records, noise_rms);
  made.shot.bench.specimen->density_kg_m3.reset();
  return made;
}

class PaperSpecimens : public ::testing::TestWithParam<std::pair<RodMaterial, double>> {};

TEST_P(PaperSpecimens, AreReducedToTheTimeDomainSolutionUntilTheFirstReturn) {
  const auto& [material, length_m] = GetParam();
  const SolvedShot solved = solve(material, length_m);
  const Reduction r = Reducer().reduce(solved.shot);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  // The answer of these specimens outlasts the 364 us until the impacted end sends it back to the
  // gauge.
  EXPECT_GT(r.time_s.back(), 630e-6);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), 5e-4);
  EXPECT_LT(worst(r, r.force_back_N, solved, solved.truth.force_back_N), 2e-4);
  // One sample's worth of the incident pulse is uncertain where the specimen's answer begins to
  // hide it.
  EXPECT_LT(worst(r, r.force_front_N, solved, solved.truth.force_front_N), 5e-3);
  EXPECT_LT(worst(r, r.strain_rate_per_s, solved, solved.truth.strain_rate_per_s), 5e-3);
}

INSTANTIATE_TEST_SUITE_P(CoreAndCover, PaperSpecimens,
                         ::testing::Values(std::pair{kCore, 0.004}, std::pair{kCore, 0.006},
                                           std::pair{kCover, 0.004}, std::pair{kCover, 0.006}));

TEST(PaperBench, FourMillimetresOfRubberAreInEquilibriumAndSixAreNot) {
  // physics.md: 4.5 to 5 %, 9 to 11 %, cover 3.4 %, for another pulse of the same length.
  const Reduction four = Reducer().reduce(solve(kCore, 0.004, 4e-6).shot);
  const Reduction six = Reducer().reduce(solve(kCore, 0.006, 4e-6).shot);
  const Reduction cover = Reducer().reduce(solve(kCover, 0.006, 4e-6).shot);
  EXPECT_NEAR(check_of(four, "equilibrium").value, 0.05, 0.015);
  EXPECT_NEAR(check_of(six, "equilibrium").value, 0.105, 0.02);
  EXPECT_NEAR(check_of(cover, "equilibrium").value, 0.034, 0.01);
  EXPECT_EQ(four.quality.verdict(), Verdict::pass);
  EXPECT_EQ(six.quality.verdict(), Verdict::warn);
}

TEST(PaperBench, ABarModelThatIsOffShows) {
  const Shot shot = solve(kCore, 0.004).shot;
  ReductionOptions options;
  options.bar_model = paper_pmma();
  options.bar_model->E1_Pa().value *= 0.95;
  const Reduction right = Reducer().reduce(shot);
  const Reduction off = Reducer(options).reduce(shot);
  EXPECT_LT(check_of(right, "equilibrium").value, 0.07);
  EXPECT_GT(check_of(off, "equilibrium").value, 0.10);
}

TEST(PaperBench, SaysWhichBarModelWasAssumed) {
  Shot shot = solve(kCore, 0.004).shot;
  EXPECT_NE(Reducer().reduce(shot).bar_model.find("assumed"), std::string::npos);
  shot.bar_model = paper_pmma();
  shot.bar_model->source = "identified in May";
  EXPECT_EQ(Reducer().reduce(shot).bar_model, "identified in May");
}

// A pulse that is over before the core is in equilibrium: waves run to and fro in it, and the back
// passes half of its own peak early. It is nobody's misfiled position.
TEST(ShortPulse, DoesNotPutTheBackBeforeTheFront) {
  BenchModel model = paper_bench(kCore, 0.004);
  model.pulse.duration_s = 43e-6;
  model.pulse.ramp_s = 7e-6;
  const SolvedShot solved = testing::shot_of(model, testing::records_of(model, 2e-3));
  const Reduction r = Reducer().reduce(solved.shot);
  EXPECT_EQ(check_of(r, "equilibrium").verdict, Verdict::warn);
  EXPECT_EQ(check_of(r, "front_back_lag").verdict, Verdict::pass)
      << check_of(r, "front_back_lag").text;
}

}  // namespace
}  // namespace kolsky
