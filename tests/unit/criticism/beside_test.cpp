#include "processing/criticism/search/beside.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <Eigen/Dense>
#include <random>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr Eigen::Index kResiduals = 60;

/// A linear model at its best, and what two additions to it do.
struct Linear {
  Eigen::MatrixXd model;
  Eigen::MatrixXd own;
  Eigen::MatrixXd other;
  Eigen::VectorXd residual;
  Eigen::MatrixXd covariance;

  explicit Linear(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto drawn = [&](Eigen::Index columns) {
      return Eigen::MatrixXd::NullaryExpr(kResiduals, columns, [&] { return normal(random); })
          .eval();
    };
    model = drawn(2);
    other = drawn(3);
    own = other.col(0) + 0.7 * drawn(1);
    covariance = (model.transpose() * model).inverse();
    const Eigen::MatrixXd records = drawn(1) - 1.5 * own + other * Eigen::Vector3d(1.0, -2.0, 0.5);
    residual = rest(model, records);
  }

  static Eigen::VectorXd rest(const Eigen::MatrixXd& columns, const Eigen::VectorXd& of) {
    return of - columns * columns.colPivHouseholderQr().solve(of);
  }

  [[nodiscard]] Direction direction_of(const Eigen::MatrixXd& columns) const {
    Direction direction;
    direction.columns = columns;
    direction.model_share = model.transpose() * columns;
    direction.unprojected = columns.transpose() * columns;
    direction.information = direction.unprojected -
                            direction.model_share.transpose() * covariance * direction.model_share;
    direction.pull = -columns.transpose() * residual;
    direction.step = direction.information.ldlt().solve(direction.pull);
    direction.gain = direction.pull.dot(direction.step);
    return direction;
  }
};

Candidate no_prior() {
  const Effect* drift = find_effect("baseline-drift");
  return {.use = null_use(*drift, "g1")};
}

TEST(ShareBeside, IsWhatALeastSquaresFitOfBothStillGains) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Linear made(seed);
    const Direction own = made.direction_of(made.own);
    Eigen::MatrixXd without(kResiduals, 5);
    without << made.model, made.other;
    Eigen::MatrixXd with(kResiduals, 6);
    with << without, made.own;
    const double gained = Linear::rest(without, made.residual).squaredNorm() -
                          Linear::rest(with, made.residual).squaredNorm();
    const double share =
        share_beside(own, no_prior(), made.direction_of(made.other), made.covariance);
    EXPECT_NEAR(share, std::min(1.0, gained / own.gain), 1e-6) << seed;
  }
}

/// Columns are in deviations of the prior, so that it weighs one each.
TEST(ShareBeside, OfBoundedStrengthsIsWhatAFitUnderTheirPriorStillGains) {
  EffectUse hum = use_named("mains-hum");
  hum.values.front().prior_sd = 30.0 * hum.effect->about().parameters.front().typical;
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    Linear made(seed);
    made.other *= 0.1;
    const Direction own = made.direction_of(made.own);
    Eigen::MatrixXd with = Eigen::MatrixXd::Zero(kResiduals + 3, 6);
    with.topRows(kResiduals) << made.model, made.other, made.own;
    with.bottomRows(3).middleCols(2, 3).setIdentity();
    Eigen::VectorXd records = Eigen::VectorXd::Zero(kResiduals + 3);
    records.head(kResiduals) = made.residual;
    const double gained = Linear::rest(with.leftCols(5), records).squaredNorm() -
                          Linear::rest(with, records).squaredNorm();
    EXPECT_NEAR(share_beside(own, {.use = hum}, made.direction_of(made.other), made.covariance),
                std::min(1.0, gained / own.gain), 1e-6)
        << seed;
  }
}

TEST(ShareBeside, IsNothingOfWhatAnotherExplainsAlone) {
  Linear made(3);
  made.residual = Linear::rest(made.model, made.other.col(0));
  EXPECT_LT(share_beside(made.direction_of(made.own), no_prior(), made.direction_of(made.other),
                         made.covariance),
            1e-6);
}

Diagnosis diagnosed(const testing::CampaignWishes& wishes, const std::string& hidden) {
  testing::Campaign truth = testing::draw_campaign(wishes);
  testing::hide(truth, testing::parse_effect(hidden));
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

// Mains of 40 microstrain under slow noise. An end that returns waves explains a twentieth as much;
// it was named.
TEST(ShareBeside, KeepsWhatAHumExplainsFromBeingNamedAsSomethingElse) {
  const Diagnosis diagnosis = diagnosed({.seed = 21,
                                         .shots = 8,
                                         .gauges = 4,
                                         .noise_strain = 4e-6,
                                         .colour = testing::NoiseColour::coloured},
                                        "mains-hum=4e-5");
  EXPECT_EQ(diagnosis.effects, std::vector<std::string>{"mains-hum"});
  const auto hum = std::ranges::find(diagnosis.candidates, "mains-hum", &CandidateResult::effect);
  ASSERT_NE(hum, diagnosis.candidates.end());
  // First order said a fiftieth of the deviation.
  // That its frequency is not known for certain makes it no harder to see.
  EXPECT_LE(hum->detectable, 6.0 * hum->sd * (1.0 + 1e-9));
  EXPECT_GT(hum->detectable, 2.0 * hum->sd);
  EXPECT_GE(hum->identifiable, hum->detectable);
}

// Under noise that wanders a hum with a phase of its own in every shot gains by that, and by what
// is a drift of one gauge in all of them: by more than the drift does, which was dismissed for it.
TEST(ShareBeside, LeavesADriftThatIsMostOfWhatAHumExplains) {
  int found = 0;
  for (std::uint64_t seed = 31; seed < 37; ++seed) {
    const Diagnosis diagnosis = diagnosed({.seed = seed,
                                           .shots = 6,
                                           .gauges = 6,
                                           .noise_strain = 8e-6,
                                           .colour = testing::NoiseColour::pink},
                                          "baseline-drift:g3=-0.025");
    found += diagnosis.effects == std::vector<std::string>{"baseline-drift:g3"} ? 1 : 0;
  }
  EXPECT_GE(found, 5);
}

}  // namespace
}  // namespace kolsky
