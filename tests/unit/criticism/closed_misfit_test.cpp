#include <gtest/gtest.h>

#include <cmath>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr double kOff_m = 0.004;
constexpr std::size_t kAtFault = 1;

void set(Model& model, const std::string& id, std::size_t parameter, double value) {
  EffectUse* use = model.find(id);
  ASSERT_NE(use, nullptr) << id;
  use->values[parameter].value = value;
}

class Floor : public ::testing::TestWithParam<std::uint64_t> {};

// Of the same records, noise and all: closure is a share of what an effect could close.
TEST_P(Floor, IsWhatTheTrueModelLeaves) {
  testing::CampaignWishes wishes{
      .seed = GetParam(), .shots = 5, .gauges = 4, .samples = 1500, .rate_Hz = 1e6};
  testing::Campaign drawn = testing::draw_campaign(wishes);
  const std::string id = "gauge-position:" + drawn.bench.gauges[kAtFault].name;
  testing::hide(drawn, testing::parse_effect(id + "=" + std::to_string(kOff_m)));
  const std::vector<Shot> shots = testing::shots_of(drawn);
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, paper_model(BenchKind::bar, false), {});
  ASSERT_EQ(diagnosis.effects, std::vector<std::string>{id});

  Model truth = *diagnosis.model;
  set(truth, "three-element-bar", 0, drawn.world.material.E1_Pa);
  set(truth, "three-element-bar", 1, drawn.world.material.E2_Pa);
  set(truth, "three-element-bar", 2, drawn.world.material.eta2_Pa_s);
  set(truth, id, 0, kOff_m);
  const Composition composition(truth, campaign);
  const Eigen::VectorXd residual = study.residuals().evaluate(composition, composition.start(), 0);
  const auto numbers = static_cast<double>(composition.numbers().size());
  // What a fit takes up of noise is a chi-square of as many degrees of freedom.
  EXPECT_NEAR(diagnosis.held_out.floor * static_cast<double>(residual.size()),
              residual.squaredNorm(), 3.0 * std::sqrt(2.0 * numbers));
  EXPECT_GT(diagnosis.held_out.before, diagnosis.held_out.after);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Floor, ::testing::Range<std::uint64_t>(921, 927));

}  // namespace
}  // namespace kolsky
