#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "processing/impact/filter.hpp"
#include "processing/impact/impact.hpp"
#include "tests/unit/impact/fine_meshes.hpp"
#include "tests/unit/impact/paper_ball.hpp"
#include "tests/unit/trigger/counted_allocations.hpp"

namespace kolsky::impact {
namespace {

using kolsky::testing::paper_impact;

ImpactHistory with_elements(ImpactModel model, std::size_t elements) {
  model.elements = elements;
  return simulate(model);
}

TEST(PaperBall, ImpulseIsTheChangeOfMomentum) {
  for (const TargetKind target : {TargetKind::rigid, TargetKind::dashpot}) {
    const ImpactModel model = paper_impact(40.3, target);
    const ImpactHistory history = with_elements(model, 512);
    const double sum = std::accumulate(history.force_N.begin(), history.force_N.end(), 0.0) *
                       model.output_interval_s;
    const double change = history.mass_kg * (40.3 + history.rebound_speed_m_per_s);
    EXPECT_NEAR(sum, change, 1e-3 * change);
    EXPECT_NEAR(history.mass_kg, 0.0434, 1e-5);
  }
}

TEST(PaperBall, EnergyCloses) {
  for (const Reading reading :
       {Reading::full, Reading::bulk_E1, Reading::bulk_Einf, Reading::exact}) {
    for (const double speed : {31.1, 51.0}) {
      const ImpactHistory history =
          with_elements(paper_impact(speed, TargetKind::dashpot, reading), 512);
      EXPECT_LT(std::abs(history.energy.worst_closure), 2e-3) << name_of(reading);
      EXPECT_GT(history.energy.dissipated_J, 0.1 * history.energy.initial_J);
      EXPECT_GT(history.energy.friction_J, 0.0);
      EXPECT_FALSE(history.energy.dissipated_by_difference);
    }
  }
}

TEST(PaperBall, CutIntoFiveShellsStaysTheSameBall) {
  ImpactModel model = paper_impact(51.0);
  const ImpactHistory two = with_elements(model, 2048);
  const Layer core = model.layers[0];
  const Layer cover = model.layers[1];
  model.layers = {core, core, core, cover, cover};
  model.layers[0].outer_diameter_m = 0.018;
  model.layers[1].outer_diameter_m = 0.027;
  model.layers[3].outer_diameter_m = 0.0392;
  const ImpactHistory five = with_elements(model, 4096);
  EXPECT_NEAR(five.mass_kg, two.mass_kg, 1e-6);
  EXPECT_NEAR(five.restitution, two.restitution, 2e-3);
  EXPECT_NEAR(five.peak_force_N, two.peak_force_N, 0.01 * two.peak_force_N);
  EXPECT_EQ(five.strained_share.size(), 5U);
}

TEST(PaperBall, ConvergesInTheMesh) {
  const ImpactModel model = paper_impact(51.0);
  const ImpactHistory coarse = with_elements(model, 512);
  const ImpactHistory usual = with_elements(model, 2048);
  const ImpactHistory fine = with_elements(model, testing::fine_meshes() ? 32768 : 8192);
  for (const ImpactHistory* history : {&coarse, &usual}) {
    EXPECT_NEAR(history->restitution, fine.restitution, 2e-3);
    EXPECT_NEAR(history->peak_force_N, fine.peak_force_N, 0.01 * fine.peak_force_N);
    EXPECT_NEAR(history->contact_time_s, fine.contact_time_s, 0.01 * fine.contact_time_s);
  }
}

TEST(PaperBall, DoesNotDependOnTheStep) {
  ImpactModel model = paper_impact(51.0);
  model.elements = 512;
  const ImpactHistory usual = simulate(model);
  model.time_step_s = 0.25 * usual.first_step_s;
  const ImpactHistory fine = simulate(model);
  EXPECT_GT(fine.steps, 3 * usual.steps);
  EXPECT_NEAR(usual.restitution, fine.restitution, 2e-4);
  EXPECT_NEAR(usual.peak_force_N, fine.peak_force_N, 1e-3 * fine.peak_force_N);
}

// The dashpot stands for the bar; behind the contact the gauge sees the force one delay later.
TEST(MeshedBar, AgreesWithTheDashpotAndItsGaugeWithTheForce) {
  ImpactModel model = paper_impact(40.3, TargetKind::bar);
  model.elements = 512;
  model.bar_elements_across = 4;
  model.gauge_positions_m = {0.250};
  const ImpactHistory bar = simulate(model);
  const ImpactHistory dashpot = with_elements(paper_impact(40.3), 512);
  EXPECT_NEAR(bar.peak_force_N, dashpot.peak_force_N, 5e-3 * dashpot.peak_force_N);
  EXPECT_NEAR(bar.restitution, dashpot.restitution, 5e-3 * dashpot.restitution);
  EXPECT_LT(std::abs(bar.energy.worst_closure), 2e-3);

  const double interval_s = model.output_interval_s;
  const double delay_s = 0.250 / model.target.wave_speed_m_per_s();
  EXPECT_NEAR(delay_s, 49.4e-6, 0.1e-6);
  const std::vector<double> strain = low_passed(bar.gauge_strain[0], interval_s, 50e3);
  const std::vector<double> force = low_passed(bar.force_N, interval_s, 50e3);
  const double newton_per_strain = model.target.youngs_modulus_Pa * model.target.area_m2();
  double worst_N = 0.0;
  for (std::size_t k = 0; k < 440; ++k) {
    const double at = static_cast<double>(k) + delay_s / interval_s;
    const auto low = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(low);
    const double seen_N =
        newton_per_strain * ((1.0 - share) * strain.at(low) + share * strain.at(low + 1));
    worst_N = std::max(worst_N, std::abs(seen_N - force[k]));
  }
  // Head and tail of the contact hold frequencies that disperse; the bulk agrees far better.
  EXPECT_LT(worst_N, 0.02 * bar.peak_force_N);
  const double impulse_seen =
      newton_per_strain * interval_s *
      std::accumulate(bar.gauge_strain[0].begin(), bar.gauge_strain[0].end(), 0.0);
  EXPECT_NEAR(impulse_seen, bar.impulse_N_s, 1e-3 * bar.impulse_N_s);
  const double peak_seen_N = newton_per_strain * *std::max_element(strain.begin(), strain.end());
  const double peak_N = *std::max_element(force.begin(), force.end());
  EXPECT_NEAR(peak_seen_N, peak_N, 1e-3 * peak_N);
}

// The paper's findings that both prototypes and this solver share.
TEST(PaperBall, RestitutionFallsWithSpeed) {
  double before = 1.0;
  for (const double speed : {31.1, 40.3, 51.0}) {
    const double e = with_elements(paper_impact(speed), 512).restitution;
    EXPECT_LT(e, before - 0.01);
    before = e;
  }
}

// The paper's figure 12: 1500 to 4000 /s. Behind the centre ours, a mean over 20 us, stays below.
TEST(PaperBall, CoreStrainRatesAreOfThePapersSize) {
  ImpactModel model = paper_impact(40.3);
  model.elements = 2048;
  model.probes = {{0.0, 0.010}, {0.0, 0.0}, {0.0, -0.010}};
  const ImpactHistory history = simulate(model);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> rate =
        mean_rate(history.probe_strain[i], model.output_interval_s, 20e-6);
    const double largest = *std::max_element(rate.begin(), rate.end());
    EXPECT_GT(largest, i < 2 ? 1500.0 : 1000.0) << i;
    EXPECT_LT(largest, i < 2 ? 4000.0 : 1500.0) << i;
  }
}

TEST(PaperBall, SameModelSameBits) {
  ImpactModel model = paper_impact(40.3);
  model.elements = 300;
  const ImpactHistory first = simulate(model);
  const ImpactHistory second = simulate(model);
  EXPECT_EQ(first.force_N, second.force_N);
  EXPECT_EQ(first.restitution, second.restitution);
}

TEST(PaperBall, AllocatesNothingWhileItRuns) {
  ImpactModel model = paper_impact(40.3);
  model.elements = 256;
  long at_first = 0;
  long at_last = 0;
  (void)simulate(model, [&](const Progress&) {
    at_last = counted_allocations();
    at_first = at_first == 0 ? at_last : at_first;
  });
  EXPECT_GT(at_first, 0);
  EXPECT_EQ(at_last, at_first);
}

// Axial stress in the elements on the wall, over the patch, carries the force.
TEST(PaperBall, StressOnThePatchCarriesTheForce) {
  ImpactModel model = paper_impact(40.3, TargetKind::rigid);
  model.elements = 2048;
  model.field_times_s = {2e-4, 1e-4};
  model.field_at_turn = true;
  const ImpactHistory history = simulate(model);
  ASSERT_EQ(history.fields.size(), 3U);
  for (const Field& field : history.fields) {
    double load_N = 0.0;
    for (const FieldElement& element : field.elements) {
      if (std::max(element.z_m[2], element.z_m[3]) < 0.1e-3) {
        load_N += element.axial_stress_Pa * std::numbers::pi *
                  std::abs(element.r_m[2] * element.r_m[2] - element.r_m[3] * element.r_m[3]);
      }
    }
    const auto sample =
        static_cast<std::size_t>(std::lround(field.time_s / model.output_interval_s));
    EXPECT_NEAR(load_N, history.force_N.at(sample), 0.05 * history.force_N.at(sample))
        << field.time_s;
  }
}

}  // namespace
}  // namespace kolsky::impact
