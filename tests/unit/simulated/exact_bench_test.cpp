// The time-domain bench against facts that need no simulation. The frequency-domain theory of the
// viscoelastic bar appears here, as an oracle, and nowhere in the simulator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "drivers/simulated/bench_model.hpp"
#include "drivers/simulated/scenario.hpp"

namespace kolsky {
namespace {

constexpr double kMicro = 1e-6;
const RodMaterial kSteel{7800.0, 210e9, 0.0, 0.0};
const RodMaterial kPmma{1180.0, 5.66e9, 37.0e9, 1.81e6};

double circle_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

std::vector<double> run_gauge(const BenchModel& model, double step_s, double duration_s,
                              std::size_t gauge = 0) {
  return run_bench(model, step_s, static_cast<std::size_t>(duration_s / step_s))
      .gauge_strain[gauge];
}

double largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

double smallest(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

double centroid_s(const std::vector<double>& values, double step_s) {
  double sum = 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    moment += values[i] * static_cast<double>(i) * step_s;
  }
  return moment / sum;
}

TEST(ElasticBar, PulseTravelsAtTheBarSpeedWithItsShape) {
  BenchModel model;
  model.input = {5.0, circle_m2(0.02), kSteel};
  model.pulse.peak_force_N = 20e3;
  model.gauges = {{RodId::input, 0.7}, {RodId::input, 2.1}};
  const double step_s = 0.1 * kMicro;
  const BenchHistory shot = run_bench(model, step_s, 8000);  // 0.8 ms: before the far end answers
  const double flight_s =
      centroid_s(shot.gauge_strain[1], step_s) - centroid_s(shot.gauge_strain[0], step_s);
  EXPECT_NEAR(flight_s, 1.4 / std::sqrt(210e9 / 7800.0), 1e-9);
  const double strain = 20e3 / (circle_m2(0.02) * 210e9);
  EXPECT_NEAR(largest(shot.gauge_strain[0]), strain, 0.01 * kMicro);
  EXPECT_NEAR(largest(shot.gauge_strain[1]), strain, 0.01 * kMicro);
}

TEST(ElasticBar, FreeEndTurnsPressureIntoTension) {
  BenchModel model;
  model.input = {2.0, circle_m2(0.02), kSteel};
  model.pulse.peak_force_N = 20e3;
  model.gauges = {{RodId::input, 1.0}};
  const std::vector<double> strain = run_gauge(model, 0.1 * kMicro, 760e-6);
  const double incident = 20e3 / (circle_m2(0.02) * 210e9);
  EXPECT_NEAR(largest(strain), incident, 0.01 * kMicro);
  EXPECT_NEAR(smallest(strain), -incident, 0.01 * kMicro);
}

struct Step {
  double output_diameter_m;
  RodMaterial output;
};

class ImpedanceStep : public ::testing::TestWithParam<Step> {};

TEST_P(ImpedanceStep, ReflectsAndTransmitsAsImpedancesSay) {
  BenchModel model;
  model.input = {4.0, circle_m2(0.02), kSteel};
  model.output = RodShape{4.0, circle_m2(GetParam().output_diameter_m), GetParam().output};
  model.pulse.peak_force_N = 20e3;
  model.gauges = {{RodId::input, 2.0}, {RodId::output, 0.5}};
  const double step_s = 0.1 * kMicro;
  const BenchHistory shot = run_bench(model, step_s, 14000);
  const auto impedance = [](const RodShape& rod) {
    return rod.area_m2 * std::sqrt(rod.material.E1_Pa * rod.material.density_kg_m3);
  };
  const double z1 = impedance(model.input);
  const double z2 = impedance(*model.output);
  const double incident = 20e3 / (model.input.area_m2 * model.input.material.E1_Pa);
  const double reflected = incident * (z2 - z1) / (z2 + z1);
  const double transmitted =
      20e3 * 2.0 * z2 / (z1 + z2) / (model.output->area_m2 * model.output->material.E1_Pa);
  // The plateau of the reflected pulse passes the input gauge 3 transit halves after the impact.
  const auto at = static_cast<std::size_t>((6.0 / std::sqrt(210e9 / 7800.0) + 85e-6) / step_s);
  EXPECT_NEAR(shot.gauge_strain[0][at], reflected, 0.02 * kMicro);
  EXPECT_NEAR(largest(shot.gauge_strain[1]), transmitted, 0.02 * kMicro);
}

INSTANTIATE_TEST_SUITE_P(Steps, ImpedanceStep,
                         ::testing::Values(Step{0.02, kSteel}, Step{0.03, kSteel},
                                           Step{0.01, kSteel},
                                           Step{0.02, {2700.0, 70e9, 0.0, 0.0}}));

TEST(Contact, PassesPressureAndNoTension) {
  // Equal elastic bars, the pulse shorter than twice the second: it leaves with all the momentum
  // and the first one is left at rest and unstrained.
  BenchModel model;
  model.input = {3.0, circle_m2(0.02), kSteel};
  model.output = RodShape{1.5, circle_m2(0.02), kSteel};
  model.pulse.peak_force_N = 20e3;
  model.gauges = {{RodId::input, 1.5}, {RodId::output, 0.75}};
  const BenchHistory shot = run_bench(model, 0.1 * kMicro, 40000);
  double after = 0.0;
  for (std::size_t i = 10000; i < 40000; ++i) {
    after = std::max(after, std::abs(shot.gauge_strain[0][i]));
  }
  EXPECT_LT(after, 0.1 * kMicro);
  EXPECT_NEAR(smallest(shot.gauge_strain[1]), -20e3 / (circle_m2(0.02) * 210e9), 0.1 * kMicro);
}

TEST(Contact, BarsTogetherTransmitFully) {
  Scenario together = find_scenario("bars-together");
  together.model.specimen.reset();
  const BenchHistory apart = run_bench(together.model, 0.125 * kMicro, 7200);
  BenchModel one = together.model;
  one.input.length_m = 1.4;
  one.output.reset();
  one.gauges = {{RodId::input, 0.4}, {RodId::input, 0.75}};
  const BenchHistory whole = run_bench(one, 0.125 * kMicro, 7200);
  for (std::size_t gauge = 0; gauge < 2; ++gauge) {
    double difference = 0.0;
    for (std::size_t i = 0; i < 7200; ++i) {
      difference = std::max(difference,
                            std::abs(apart.gauge_strain[gauge][i] - whole.gauge_strain[gauge][i]));
    }
    EXPECT_LT(difference, 0.05 * kMicro) << "gauge " << gauge;
  }
}

TEST(Contact, KeepsMomentum) {
  for (const char* name : {"core", "cover", "steel"}) {
    const Scenario scenario = find_scenario(name);
    const ImpactPulse& pulse = scenario.model.pulse;
    // A raised-cosine ramp brings half of what the plateau would.
    const double impulse = pulse.peak_force_N * (pulse.duration_s - pulse.ramp_s);
    const BenchHistory shot = run_bench(scenario.model, 0.25 * kMicro, 16000);
    EXPECT_NEAR(shot.momentum_kg_m_per_s, impulse, 1e-9 * impulse) << name;
  }
}

std::complex<double> spectrum(const std::vector<double>& values, double step_s, double omega) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i] * std::polar(1.0, -omega * static_cast<double>(i) * step_s);
  }
  return sum * step_s;
}

TEST(ViscoelasticBar, AttenuatesAndDelaysAsItsComplianceSays) {
  BenchModel model;
  model.input = {8.0, circle_m2(0.02), kPmma};
  model.pulse = {1500.0, 60e-6, 30e-6};
  model.gauges = {{RodId::input, 0.5}, {RodId::input, 1.5}};
  const double step_s = 0.25 * kMicro;
  const BenchHistory shot = run_bench(model, step_s, 24000);  // 6 ms: the far end answers at 6.6 ms
  for (const double kHz : {0.2, 1.0, 3.0, 6.0, 10.0, 15.0, 20.0}) {
    const double omega = 2.0 * std::numbers::pi * kHz * 1e3;
    const std::complex<double> ratio = spectrum(shot.gauge_strain[1], step_s, omega) /
                                       spectrum(shot.gauge_strain[0], step_s, omega);
    const std::complex<double> i_omega(0.0, omega);
    const std::complex<double> compliance =
        1.0 / kPmma.E1_Pa + 1.0 / (kPmma.E2_Pa + i_omega * kPmma.eta2_Pa_s);
    std::complex<double> gamma = i_omega * std::sqrt(kPmma.density_kg_m3 * compliance);
    if (gamma.real() < 0.0) {
      gamma = -gamma;
    }
    const std::complex<double> expected = std::exp(-gamma * 1.0);
    EXPECT_NEAR(std::abs(ratio) / std::abs(expected), 1.0, 1e-5) << kHz << " kHz";
    EXPECT_NEAR(std::arg(ratio / expected), 0.0, 1e-5) << kHz << " kHz";
  }
}

TEST(ViscoelasticBar, SettlesAtTheRelaxedModulus) {
  // Pushed steadily from one end a free bar accelerates as a whole: at x the force is that part of
  // the push that moves what lies behind, (1 - x/L) F, and the strain that over area and relaxed
  // modulus.
  BenchModel model;
  model.input = {0.2, circle_m2(0.02), kPmma};
  model.pulse = {100.0, 40e-3, 2e-3};
  model.gauges = {{RodId::input, 0.05}};
  const std::vector<double> strain = run_gauge(model, 0.5 * kMicro, 20e-3);
  const double relaxed_Pa = 5.66e9 * 37.0e9 / (5.66e9 + 37.0e9);
  EXPECT_NEAR(strain.back(), 0.75 * 100.0 / (circle_m2(0.02) * relaxed_Pa), 0.01 * kMicro);
}

double difference(const std::vector<double>& coarse, const std::vector<double>& fine, double end_s,
                  double coarse_step_s) {
  double most = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(end_s / coarse_step_s); ++i) {
    most = std::max(most, std::abs(coarse[i] - fine[2 * i]));
  }
  return most;
}

struct Window {
  const char* scenario;
  double end_s;  ///< of a shpb: before faces that have parted meet again, which no grid resolves
};

class Grid : public ::testing::TestWithParam<Window> {};

TEST_P(Grid, ErrorIsBelowATenthOfAMicrostrainAndFallsWithTheSquare) {
#ifdef KOLSKY_SANITIZED
  GTEST_SKIP() << "numbers, and slow ones: no sanitizer finds more in them than in the other tests";
#endif
  const Scenario scenario = find_scenario(GetParam().scenario);
  const double step_s = 1.0 / kStepsPerSecond;
  std::vector<BenchHistory> shots;
  for (const double factor : {2.0, 1.0, 0.5}) {
    shots.push_back(
        run_bench(scenario.model, factor * step_s,
                  static_cast<std::size_t>(std::llround(GetParam().end_s / (factor * step_s)))));
  }
  for (std::size_t g = 0; g < scenario.model.gauges.size(); ++g) {
    const double coarse = difference(shots[0].gauge_strain[g], shots[1].gauge_strain[g],
                                     GetParam().end_s, 2.0 * step_s);
    const double fine =
        difference(shots[1].gauge_strain[g], shots[2].gauge_strain[g], GetParam().end_s, step_s);
    RecordProperty("gauge " + std::to_string(g) + " halving, microstrain",
                   std::to_string(fine / kMicro));
    // Second order: the error of the grid in use is 4/3 of what halving it changes.
    EXPECT_LT(fine * 4.0 / 3.0, 0.1 * kMicro) << "gauge " << g;
    EXPECT_LT(fine, 0.5 * coarse + 0.002 * kMicro) << "gauge " << g;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Grid,
                         ::testing::Values(Window{"bar", 4e-3}, Window{"core", 0.95e-3},
                                           Window{"cover", 0.95e-3}, Window{"core-6mm", 0.95e-3},
                                           Window{"bars-together", 0.95e-3},
                                           Window{"steel", 0.9e-3}));

TEST(Specimen, HistoryHangsTogether) {
  const Scenario scenario = find_scenario("core");
  const BenchHistory shot = run_shot(scenario);
  const SpecimenHistory& s = *shot.specimen;
  const double step_s = shot.step_s;
  double strain = 0.0;
  double worst = 0.0;
  for (std::size_t i = 1; s.time_s[i] < 600e-6; ++i) {  // before faces meet again: no jumps
    strain += 0.5 * (s.strain_rate_per_s[i - 1] + s.strain_rate_per_s[i]) * step_s;
    worst = std::max(worst, std::abs(strain - s.strain[i]));
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(strain, 1e-3);
}

TEST(Specimen, TimeBeginsWithTheFrontAtInterfaceA) {
  const BenchHistory shot = run_shot(find_scenario("core"));
  const SpecimenHistory& s = *shot.specimen;
  const auto arrival = std::lower_bound(s.time_s.begin(), s.time_s.end(), 0.0) - s.time_s.begin();
  EXPECT_NEAR(s.time_s.front(), -0.7 / std::sqrt(5.66e9 / 1180.0), 1e-9);
  const double before =
      *std::max_element(s.force_front_N.begin(), s.force_front_N.begin() + arrival - 2);
  EXPECT_DOUBLE_EQ(before, 0.0);
  EXPECT_GT(s.force_front_N[static_cast<std::size_t>(arrival) + 80], 0.1);
}

TEST(Specimen, SoftOneIsNearEquilibriumAndFollowsItsOwnLaw) {
  // A slow pulse, so that the specimen is in equilibrium: then stress and strain obey the
  // three-element solid by themselves, integrated here by small explicit steps.
  Scenario scenario = find_scenario("core");
  scenario.model.pulse = {300.0, 2000e-6, 900e-6};
  const BenchHistory shot = run_bench(scenario.model, 0.125 * kMicro, 9000);
  const SpecimenHistory& s = *shot.specimen;
  const RodMaterial& m = scenario.model.specimen->material;
  double internal = 0.0;
  double worst = 0.0;
  double most = 0.0;
  for (std::size_t i = 0; i < s.time_s.size(); ++i) {
    const double stress = m.E1_Pa * (s.strain[i] - internal);
    internal += (stress - m.E2_Pa * internal) / m.eta2_Pa_s * shot.step_s;
    worst = std::max(worst, std::abs(stress - s.stress_Pa[i]));
    most = std::max(most, s.stress_Pa[i]);
  }
  EXPECT_GT(most, 1e5);
  EXPECT_LT(worst, 0.01 * most);
}

TEST(Rod, RefusesAStepLongerThanItself) {
  BenchModel model;
  model.input = {0.001, 1e-4, kSteel};
  EXPECT_THROW((void)run_bench(model, 1e-6, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kolsky
