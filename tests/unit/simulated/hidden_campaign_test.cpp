#include "drivers/simulated/hidden_campaign.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "processing/base/bench.hpp"

namespace kolsky {
namespace {

/// Columns of a table, the first is time.
std::vector<std::vector<double>> columns_of(const std::string& table) {
  std::istringstream in(table);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> columns;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      columns.resize(std::max(columns.size(), column + 1));
      columns[column].push_back(std::stod(cell));
    }
  }
  return columns;
}

/// A campaign that hides nothing, with everything else as drawn.
HiddenCampaign plain() {
  HiddenCampaign campaign = draw_hidden_campaign(7, 2);
  EXPECT_EQ(campaign.truth.id, "") << "the draw has changed: take another seed";
  campaign.noise_microstrain = 0.0;
  return campaign;
}

TEST(HiddenCampaign, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const HiddenCampaign campaign = draw_hidden_campaign(11, 2);
  EXPECT_EQ(shot_table(campaign, 1, 2e6), shot_table(draw_hidden_campaign(11, 2), 1, 2e6));
  EXPECT_EQ(bench_toml(campaign), bench_toml(draw_hidden_campaign(11, 2)));
  EXPECT_NE(bench_toml(campaign), bench_toml(draw_hidden_campaign(12, 2)));
}

TEST(HiddenCampaign, DrawsEveryKindOfCaseNothingAndTheUnknownIncluded) {
  std::map<std::string, int> kinds;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const HiddenTruth truth = draw_hidden_campaign(seed, 1).truth;
    ++kinds[truth.id.substr(0, truth.id.find(':'))];
    EXPECT_EQ(truth.id.empty() || truth.strength != 0.0 || truth.id == "end-reflection", true);
  }
  EXPECT_EQ(kinds.size(), 12U);
  for (const auto& [id, count] : kinds) {
    EXPECT_GT(count, 8) << id;
  }
}

TEST(HiddenCampaign, FilesNothingOfWhatItHides) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    HiddenCampaign campaign = draw_hidden_campaign(seed, 2);
    const std::string told = bench_toml(campaign);
    EXPECT_EQ(told.find("g5"), std::string::npos);
    campaign.truth = {};
    campaign.true_position_m = campaign.filed_position_m;
    EXPECT_EQ(bench_toml(campaign), told);
  }
}

TEST(HiddenCampaign, ItsGridIsFineEnough) {
  // A grid twice as fine moves no reading by a tenth of the least noise that is drawn.
  const HiddenCampaign campaign = plain();
  const auto once = columns_of(shot_table(campaign, 0, 8e6));
  const auto fine = columns_of(shot_table(campaign, 0, 16e6));
  double worst_V = 0.0;
  for (std::size_t g = 1; g < once.size(); ++g) {
    for (std::size_t n = 0; n < once[g].size(); ++n) {
      worst_V = std::max(worst_V, std::abs(once[g][n] - fine[g][n]));
    }
  }
  constexpr double kStrainPerVolt = 1e-3;
  const double step = 5e-3 / 8192.0;  // of the converter, 14 bits over 5000 microstrain
  EXPECT_LE(worst_V * kStrainPerVolt, 0.2e-6 + step);
}

TEST(HiddenCampaign, AWaveTravelsWithTheSpeedOfTheMaterial) {
  // At frequency zero a pulse's momentum is kept, so that its area is the same at every gauge, and
  // its delay is that of J1(0).
  const HiddenCampaign campaign = plain();
  const auto columns = columns_of(shot_table(campaign, 0, 8e6));
  std::vector<double> area;
  std::vector<double> centre;
  for (std::size_t g = 1; g < columns.size(); ++g) {
    double baseline = 0.0;
    for (std::size_t n = 0; n < 200; ++n) {
      baseline += columns[g][n] / 200.0;
    }
    double sum = 0.0;
    double moment = 0.0;
    for (std::size_t n = 0; n < columns[g].size(); ++n) {
      const double value = (columns[g][n] - baseline) / campaign.gain[g - 1];
      sum += value;
      moment += value * columns[0][n];
    }
    area.push_back(sum);
    centre.push_back(moment / sum);
  }
  const auto& m = campaign.material;
  const double slow = std::sqrt(m.density_kg_m3 * (1.0 / m.E1_Pa + 1.0 / m.E2_Pa));
  const double way = campaign.true_position_m[2] - campaign.true_position_m[0];
  EXPECT_NEAR(area[2] / area[0], 1.0, 2e-3);
  EXPECT_NEAR((centre[2] - centre[0]) / (way * slow), 1.0, 5e-3);
}

TEST(HiddenCampaign, ChangesOnlyTheGaugeAtFault) {
  HiddenCampaign campaign = plain();
  const auto before = columns_of(shot_table(campaign, 0, 4e6));
  campaign.truth.id = "channel-delay:g3";
  campaign.truth.gauge = 2;
  campaign.truth.strength = 3.0 / campaign.sample_rate_Hz;
  const auto after = columns_of(shot_table(campaign, 0, 4e6));
  EXPECT_EQ(before[1], after[1]);
  EXPECT_EQ(before[2], after[2]);
  EXPECT_EQ(before[4], after[4]);
  const double step_V = 5.0 / 8192.0;
  for (std::size_t n = 303; n + 3 < before[3].size(); ++n) {
    ASSERT_NEAR(after[3][n], before[3][n - 3], 1.01 * step_V) << n;
  }
}

/// A rod as a creep test: a slow push, and the strain it settles at.
TEST(RodChain, CreepsAsItsElementsSay) {
  constexpr double kForce_N = 100.0;
  constexpr double kArea_m2 = 1e-4;
  RodMaterial material{1200.0, 5e9, 3e10, 1.5e6, {{2e-11, 5e-5}}, 3e-8};
  BenchModel model;
  model.input = {4.0, kArea_m2, material};
  model.pulse = {kForce_N, 1e-2, 3e-4};
  model.gauges = {{RodId::input, 0.01}};
  const double step_s = 0.25e-6;
  const auto strain = run_bench(model, step_s, 6000).gauge_strain.front();
  // Near the struck end stress is the force's over the area, to a small part: the integral of
  // creep over the force's rise.
  const double time_s = 1.4e-3;
  double expected = 0.0;
  const int parts = 4000;
  double before = 0.0;
  for (int i = 1; i <= parts; ++i) {
    const double t = time_s * i / parts;
    const double stress = model.pulse.force_N(t) / kArea_m2;
    const double since = time_s - time_s * (i - 0.5) / parts;
    const double creep =
        1.0 / material.E1_Pa +
        (1.0 - std::exp(-since * material.E2_Pa / material.eta2_Pa_s)) / material.E2_Pa +
        2e-11 * (1.0 - std::exp(-since / 5e-5)) + 3e-8 * since;
    expected += creep * (stress - before);
    before = stress;
  }
  EXPECT_NEAR(strain[static_cast<std::size_t>(time_s / step_s)], expected, 5e-3 * expected);
}

}  // namespace
}  // namespace kolsky
