// Corrections to the stress, against the formulas by hand and against a specimen with mass solved
// in the time domain.
#include "processing/reduction/corrections.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/reduction/reducer.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

Specimen disc() {
  Specimen specimen;
  specimen.length_m = {0.004};
  specimen.diameter_m = {0.012};
  specimen.density_kg_m3 = Measured{1000.0};
  return specimen;
}

/// The rate grows by 1e7 1/s2; front and back differ.
Reduction growing() {
  Reduction r;
  for (int n = 0; n < 100; ++n) {
    const double t = 1e-6 * n;
    r.time_s.push_back(t);
    r.strain_rate_per_s.push_back(1e7 * t);
    r.strain.push_back(0.5e7 * t * t);
    r.force_front_N.push_back(120.0);
    r.force_back_N.push_back(100.0);
    r.stress_Pa.push_back(0.0);
  }
  return r;
}

/// The front face's velocity over the length where the back face stands still.
std::vector<double> at_rest(const Reduction& r) {
  return r.strain_rate_per_s;
}

TEST(SetStress, TakesOneTwoOrThreeWaves) {
  const double area_m2 = std::numbers::pi * 0.006 * 0.006;
  Reduction r = growing();
  set_stress(StressFrom::both_faces, {}, disc(), at_rest(r), r);
  EXPECT_NEAR(r.stress_Pa[50], 110.0 / area_m2, 1e-6);
  set_stress(StressFrom::back, {}, disc(), at_rest(r), r);
  EXPECT_NEAR(r.stress_Pa[50], 100.0 / area_m2, 1e-6);
  set_stress(StressFrom::front, {}, disc(), at_rest(r), r);
  EXPECT_NEAR(r.stress_Pa[50], 120.0 / area_m2, 1e-6);
  EXPECT_THROW((void)stress_from("four-wave"), InputError);
}

/// A strain that grows to a third, with its rate, every microsecond.
double strain_at(double t_s) {
  return 0.3 * std::sin(1.2e4 * t_s);
}

Reduction squeezed() {
  Reduction r;
  for (int n = 0; n < 100; ++n) {
    const double t = 1e-6 * n;
    r.time_s.push_back(t);
    r.strain.push_back(strain_at(t));
    r.strain_rate_per_s.push_back(3.6e3 * std::cos(1.2e4 * t));
    r.force_front_N.push_back(0.0);
    r.force_back_N.push_back(0.0);
    r.stress_Pa.push_back(0.0);
  }
  return r;
}

/// By the rate at which the energy of motion of a volume grows, over the strain's rate: what a
/// specimen without strength would be pressed with.
/// @param energy_J_m3  by time
template <typename Energy>
double pressed_by(const Energy& energy_J_m3, double t_s) {
  constexpr double kStep_s = 1e-8;
  return (energy_J_m3(t_s + kStep_s) - energy_J_m3(t_s - kStep_s)) /
         (strain_at(t_s + kStep_s) - strain_at(t_s - kStep_s));
}

double slope(const auto& function, double t_s) {
  constexpr double kStep_s = 1e-8;
  return (function(t_s + kStep_s) - function(t_s - kStep_s)) / (2.0 * kStep_s);
}

class RadialInertia : public ::testing::TestWithParam<double> {};

TEST_P(RadialInertia, IsTheWorkThatWideningTakes) {
  const double nu = GetParam();
  const auto radius_m = [&](double t) { return 0.006 * std::pow(1.0 - strain_at(t), -nu); };
  // The mean square of the distance from the axis is half the radius's.
  const auto energy = [&](double t) { return 0.25 * 1000.0 * std::pow(slope(radius_m, t), 2); };
  Specimen specimen = disc();
  specimen.poisson_ratio = Measured{nu};
  Reduction r = squeezed();
  set_stress(StressFrom::both_faces, {.radial_inertia = true, .friction = {}}, specimen, at_rest(r),
             r);
  for (const int n : {5, 40, 80}) {
    const double expected = pressed_by(energy, 1e-6 * n);
    EXPECT_NEAR(-r.stress_Pa[n], expected, 1e-3 * std::abs(expected)) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Poisson, RadialInertia, ::testing::Values(0.5, 0.3, 0.1));

TEST(SetStress, TakesASpecimenForOneThatKeepsItsVolumeUnlessItsPoissonRatioIsFiled) {
  Specimen filed = disc();
  filed.poisson_ratio = Measured{0.5};
  const Corrections radial{.radial_inertia = true, .friction = {}};
  Reduction r = squeezed();
  set_stress(StressFrom::both_faces, radial, disc(), at_rest(r), r);
  const std::vector<double> unfiled = r.stress_Pa;
  set_stress(StressFrom::both_faces, radial, filed, at_rest(r), r);
  EXPECT_EQ(r.stress_Pa, unfiled);
}

/// A back face at rest does no work: the front face alone moves what moves.
TEST(SetStress, AxialInertiaIsTheWorkThatShorteningTakes) {
  const auto front_m_per_s = [](double t) { return 0.004 * slope(strain_at, t); };
  const auto energy = [&](double t) { return 1000.0 * std::pow(front_m_per_s(t), 2) / 6.0; };
  const Corrections axial{.axial_inertia = true, .friction = {}};
  Reduction r = squeezed();
  for (const int n : {5, 40, 80}) {
    const double all = pressed_by(energy, 1e-6 * n);
    const double tolerance = 1e-3 * std::abs(all);
    // Force grows from the back face to the front as the square of the distance.
    set_stress(StressFrom::front, axial, disc(), at_rest(r), r);
    EXPECT_NEAR(-r.stress_Pa[n], all, tolerance);
    set_stress(StressFrom::back, axial, disc(), at_rest(r), r);
    EXPECT_NEAR(-r.stress_Pa[n], -all / 2.0, tolerance);
    set_stress(StressFrom::both_faces, axial, disc(), at_rest(r), r);
    EXPECT_NEAR(-r.stress_Pa[n], all / 4.0, tolerance);
  }
}

TEST(SetStress, ABackFaceThatMovesCostsHalfTheSpecimensMassPerFace) {
  // The back face gathers speed by 5e6 x 4 mm each second: 1000 x 16e-6 x 5e6 / 2.
  Reduction r = growing();
  std::vector<double> front(at_rest(r));
  for (std::size_t n = 0; n < front.size(); ++n) {
    front[n] += 5e6 * r.time_s[n];
  }
  const Corrections axial{.axial_inertia = true, .friction = {}};
  const auto moved = [&](StressFrom from) {
    set_stress(from, axial, disc(), at_rest(r), r);
    const double before = r.stress_Pa[50];
    set_stress(from, axial, disc(), front, r);
    return r.stress_Pa[50] - before;
  };
  EXPECT_NEAR(moved(StressFrom::back), 40000.0, 1.0);
  EXPECT_NEAR(moved(StressFrom::front), -40000.0, 1.0);
  EXPECT_NEAR(moved(StressFrom::both_faces), 0.0, 1e-6);
}

/// The force that stands for the front face's is the back face's, and lacks what that lacks: the
/// mean over a specimen whose faces gather speed by a and b is rho h (a / 6 + b / 3) above it.
TEST(SetStress, EquilibriumAssumedLeavesTheBackFacesInertia) {
  Reduction r = growing();
  r.force_front_N = r.force_back_N;
  r.separation = Separation::equilibrium;
  std::vector<double> front(at_rest(r));
  for (std::size_t n = 0; n < front.size(); ++n) {
    front[n] += 5e6 * r.time_s[n];
    r.strain_rate_per_s[n] *= 1e-3;
  }
  const double back_growth = 5e6 + 1e7 - 1e4;
  const double front_growth = 5e6 + 1e7;
  for (const StressFrom from : {StressFrom::both_faces, StressFrom::front, StressFrom::back}) {
    set_stress(from, {}, disc(), front, r);
    const double plain = r.stress_Pa[50];
    set_stress(from, {.axial_inertia = true, .friction = {}}, disc(), front, r);
    EXPECT_NEAR(r.stress_Pa[50] - plain, 1000.0 * 16e-6 * (front_growth / 6.0 + back_growth / 3.0),
                1.0);
  }
}

TEST(SetStress, TakesFrictionOff) {
  Reduction r = growing();
  set_stress(StressFrom::both_faces, {}, disc(), at_rest(r), r);
  const double plain = r.stress_Pa[0];
  Corrections corrections;
  corrections.friction = 0.1;
  set_stress(StressFrom::both_faces, corrections, disc(), at_rest(r), r);
  EXPECT_NEAR(plain / r.stress_Pa[0], 1.0 + 0.1 * 0.012 / (3.0 * 0.004), 1e-12);
}

TEST(SetStress, FrictionIsOfFacesThatArePressed) {
  Reduction r = growing();
  r.force_front_N.assign(r.force_front_N.size(), -120.0);
  r.force_back_N.assign(r.force_back_N.size(), -100.0);
  set_stress(StressFrom::both_faces, {}, disc(), at_rest(r), r);
  const std::vector<double> plain = r.stress_Pa;
  Corrections corrections;
  corrections.friction = 0.1;
  set_stress(StressFrom::both_faces, corrections, disc(), at_rest(r), r);
  EXPECT_EQ(r.stress_Pa, plain);
}

TEST(SetStress, InertiaNeedsTheSpecimensDensity) {
  Reduction r = growing();
  Specimen unknown = disc();
  unknown.density_kg_m3.reset();
  EXPECT_THROW(set_stress(StressFrom::both_faces, {.axial_inertia = true, .friction = {}}, unknown,
                          at_rest(r), r),
               InputError);
  EXPECT_NO_THROW(set_stress(StressFrom::both_faces, {}, unknown, at_rest(r), r));
}

using testing::kAluminium;
using testing::kPmma;
using testing::kRubber;
using testing::kTitanium;
using testing::SolvedShot;
using testing::worst;

/// A specimen rod between two bars that differ, gauges half a metre and a quarter from it.
SolvedShot solve(const RodMaterial& input, const RodMaterial& output, double specimen_length_m) {
  BenchModel model;
  model.input = {1.0, testing::circle_m2(0.015), input};
  model.output = RodShape{0.8, testing::circle_m2(0.012), output};
  model.specimen = RodShape{specimen_length_m, testing::circle_m2(0.010), kRubber};
  model.pulse = {.peak_force_N = input.E1_Pa * model.input.area_m2 * 1e-3,
                 .duration_s = 170e-6,
                 .ramp_s = 60e-6};
  model.gauges = {{RodId::input, 0.5}, {RodId::output, 0.25}};
  return testing::shot_of(model, testing::records_of(model, 2e-3));
}

/// An elastic specimen's mean stress is its modulus times its mean strain, whatever its mass does:
/// each way to take the stress against that, before the inertia is taken off and after.
struct OwnStress {
  double before, after;  ///< rms over the loading
};

OwnStress against_own(const SolvedShot& solved, StressFrom from, std::vector<double>& corrected) {
  ReductionOptions options;
  options.stress = from;
  const Reduction plain = Reducer(options).reduce(solved.shot);
  options.corrections.axial_inertia = true;
  corrected = Reducer(options).reduce(solved.shot).stress_Pa;
  OwnStress off{0.0, 0.0};
  constexpr std::size_t kLoading = 150;
  for (std::size_t n = 0; n < kLoading; ++n) {
    const double own = kRubber.E1_Pa * plain.strain[n];
    off.before += std::pow(plain.stress_Pa[n] - own, 2) / kLoading;
    off.after += std::pow(corrected[n] - own, 2) / kLoading;
  }
  corrected.resize(kLoading);
  return {std::sqrt(off.before), std::sqrt(off.after)};
}

TEST(AxialInertia, TakenOffLeavesTheMaterialsOwnStressFromEitherFace) {
  const SolvedShot solved = solve(kPmma, kPmma, 0.006);
  std::vector<double> both;
  std::vector<double> back;
  std::vector<double> front;
  const OwnStress of_both = against_own(solved, StressFrom::both_faces, both);
  const OwnStress of_back = against_own(solved, StressFrom::back, back);
  const OwnStress of_front = against_own(solved, StressFrom::front, front);
  std::printf(
      "rms off [Pa]: three-wave %.0f to %.0f, one-wave %.0f to %.0f, two-wave %.0f to %.0f\n",
      of_both.before, of_both.after, of_back.before, of_back.after, of_front.before,
      of_front.after);
  EXPECT_LT(of_both.after, 0.35 * of_both.before);
  EXPECT_LT(of_back.after, 0.35 * of_back.before);
  EXPECT_LT(of_front.after, 0.35 * of_front.before);
}

class UnlikeBars : public ::testing::TestWithParam<std::pair<RodMaterial, RodMaterial>> {};

TEST_P(UnlikeBars, AreReducedToTheTimeDomainSolution) {
  const auto& [input, output] = GetParam();
  const SolvedShot solved = solve(input, output, 0.004);
  const Reduction r = Reducer().reduce(solved.shot);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  EXPECT_LT(worst(r, r.force_back_N, solved, solved.truth.force_back_N), 3e-3);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), 3e-3);
}

INSTANTIATE_TEST_SUITE_P(ElasticAndViscoelastic, UnlikeBars,
                         ::testing::Values(std::pair{kPmma, kPmma}, std::pair{kAluminium, kPmma},
                                           std::pair{kPmma, kAluminium},
                                           std::pair{kTitanium, kAluminium}));

constexpr RodMaterial kAged{
    .density_kg_m3 = 1180, .E1_Pa = 5.0e9, .E2_Pa = 30.0e9, .eta2_Pa_s = 2.0e6};

Material aged() {
  return three_element_material({1180.0}, {0.36}, {5.0e9}, {30.0e9}, {2.0e6}, "the aged rod");
}

/// Two viscoelastic rods that differ: the output bar's own is in the bench, the bar model is the
/// input bar's.
TEST(UnlikeRods, AreReducedToTheTimeDomainSolution) {
  SolvedShot solved = solve(kPmma, kAged, 0.004);
  Reducer reducer;
  const Reduction alike = reducer.reduce(solved.shot);
  EXPECT_GT(worst(alike, alike.force_back_N, solved, solved.truth.force_back_N), 0.05);
  solved.shot.bench.output->material = aged();
  const Reduction r = reducer.reduce(solved.shot);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  EXPECT_LT(worst(r, r.force_back_N, solved, solved.truth.force_back_N), 3e-3);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), 3e-3);
  EXPECT_NE(r.bar_model.find("output bar by itself: the aged rod"), std::string::npos)
      << r.bar_model;
  EXPECT_EQ(r.stress_Pa, Reducer().reduce(solved.shot).stress_Pa) << "by the tables of others";
}

TEST(UnlikeRods, AreHeldToWhatTheOutputBarWasIdentifiedIn) {
  SolvedShot solved = solve(kPmma, kAged, 0.004);
  Material own = aged();
  own.identified = Material::Identified{.band_limit_Hz = 12e3, .temperature_K = 293.0};
  solved.shot.bench.output->material = own;
  EXPECT_EQ(Reducer().reduce(solved.shot).band_limit_Hz, 12e3);
  solved.shot.meta["temperature_K"] = "296.5";
  try {
    (void)Reducer().reduce(solved.shot);
    ADD_FAILURE() << "at another temperature";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "bars.output.material");
    EXPECT_NE(error.problem().find("296.5 K"), std::string::npos) << error.problem();
  }
}

}  // namespace
}  // namespace kolsky
