// Linear specimens between viscoelastic and elastic bars, solved in the time domain, given to the
// fit.
#include "processing/specimen/specimen_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/specimen/specimen_spectrum.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/specimen_repeats.hpp"
#include "tests/generators/spectrum_coverage.hpp"

namespace kolsky {
namespace {

using testing::LinearShpb;

constexpr RodMaterial kCover{960.0, 987e6, 452e6, 6020.0};

std::vector<Shot> noisy(const LinearShpb& model, const std::vector<std::vector<double>>& records,
                        std::size_t count, double noise = 4e-6) {
  std::vector<Shot> shots;
  for (unsigned i = 1; i <= count; ++i) {
    shots.push_back(testing::digitise(model.bench(), records, noise, 16, 0.005, i));
  }
  return shots;
}

std::vector<Shot> shots_of(const LinearShpb& model, std::size_t count) {
  return noisy(model, model.solve(), count);
}

void expect_material(const SpecimenFit& fit, const RodMaterial& truth, double deviations = 4.0) {
  const std::vector<double> values = {truth.E1_Pa, truth.E2_Pa, truth.eta2_Pa_s};
  ASSERT_EQ(fit.parameters.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(fit.parameters[i].value, values[i], deviations * fit.parameters[i].sd)
        << fit.parameters[i].name;
  }
}

bool says_widened_deviations_do_not_cover(const SpecimenFit& fit) {
  return std::ranges::any_of(fit.warnings, [](const std::string& warning) {
    return warning.find("does not cover what the model lacks") != std::string::npos;
  });
}

Complex compliance(const RodMaterial& m, double frequency_Hz) {
  const Complex s(0.0, 2.0 * std::numbers::pi * frequency_Hz);
  return 1.0 / m.E1_Pa + 1.0 / (m.E2_Pa + s * m.eta2_Pa_s);
}

TEST(FitSpecimen, FindsCoreAndCoverNearTheInformationLimit) {
  // physics.md, ten shots: core 0.5 / 0.6 / 1.2 %, cover 0.8 / 0.35 / 0.8 %; three times that is
  // asked for.
  LinearShpb core;
  const SpecimenFit soft = fit_specimen(shots_of(core, 10), BarPrior(paper_pmma()), {});
  expect_material(soft, core.specimen);
  EXPECT_LT(soft.parameters[0].sd, 1.5 * 0.005 * soft.parameters[0].value);
  EXPECT_LT(soft.parameters[1].sd, 1.5 * 0.006 * soft.parameters[1].value);
  EXPECT_LT(soft.parameters[2].sd, 1.5 * 0.012 * soft.parameters[2].value);
  EXPECT_NEAR(soft.chi2_reduced, 1.0, 0.15);
  EXPECT_TRUE(soft.warnings.empty());
  LinearShpb cover;
  cover.specimen = kCover;
  const SpecimenFit hard = fit_specimen(shots_of(cover, 10), BarPrior(paper_pmma()), {});
  expect_material(hard, kCover);
  EXPECT_LT(hard.parameters[0].sd, 1.5 * 0.008 * hard.parameters[0].value);
  EXPECT_LT(hard.parameters[1].sd, 1.5 * 0.0035 * hard.parameters[1].value);
  EXPECT_LT(hard.parameters[2].sd, 1.5 * 0.008 * hard.parameters[2].value);
}

TEST(FitSpecimen, TheDataTellWhetherTheSpecimensMassMatters) {
  LinearShpb model;
  const SpecimenFit without = fit_specimen(shots_of(model, 2), BarPrior(paper_pmma()), {});
  EXPECT_EQ(without.theory.specimen, SpecimenWaves::massless);
  EXPECT_EQ(without.theory.bars, WaveTheory::elementary);
  model.massless = false;
  const auto shots = shots_of(model, 2);
  const SpecimenFit with = fit_specimen(shots, BarPrior(paper_pmma()), {});
  EXPECT_EQ(with.theory.specimen, SpecimenWaves::rod);
  expect_material(with, model.specimen);
  // Whoever insists on no mass is told that it does not describe the data.
  SpecimenFitOptions insist;
  insist.bars = WaveTheory::elementary;
  insist.specimen = SpecimenWaves::massless;
  const SpecimenFit wrong = fit_specimen(shots, BarPrior(paper_pmma()), insist);
  EXPECT_GT(wrong.chi2_reduced, 1.5);
  EXPECT_TRUE(says_widened_deviations_do_not_cover(wrong));
}

/// What a place that is filed wrong costs lies along the moduli: the widened interval misses it.
TEST(FitSpecimen, WidenedDeviationsAreNotSaidToHoldTheTruth) {
  const LinearShpb model;
  auto shots = shots_of(model, 10);
  EXPECT_FALSE(
      says_widened_deviations_do_not_cover(fit_specimen(shots, BarPrior(paper_pmma()), {})));
  for (Shot& shot : shots) {
    shot.bench.gauges[1].position_m.value += 2e-3;
  }
  const SpecimenFit off = fit_specimen(shots, BarPrior(paper_pmma()), {});
  const FittedNumber& E1 = off.parameters[0];
  std::printf("output gauge 2 mm off: E1 by %.1f deviations, chi2 %.2f\n",
              (E1.value - model.specimen.E1_Pa) / E1.sd, off.chi2_reduced);
  EXPECT_GT(std::abs(E1.value - model.specimen.E1_Pa), 4.0 * E1.sd);
  EXPECT_TRUE(says_widened_deviations_do_not_cover(off));
}

// Benches on which the grid's best place by plain misfit leads nowhere; 102's with mass runs away
// to an infinitely stiff E1.
TEST(FitSpecimen, TheSearchDoesNotHangOnOneStart) {
  for (const std::uint64_t seed : {102U, 213U, 214U}) {
    SCOPED_TRACE(seed);
    testing::CampaignWishes wishes{.seed = seed,
                                   .shots = 5,
                                   .gauges = 2,
                                   .tolerances = testing::Tolerances::filed,
                                   .split = true};
    const testing::Campaign campaign = testing::draw_campaign(wishes);
    const SpecimenFit fit =
        fit_specimen(testing::shots_of(campaign), BarPrior(*campaign.filed_bars), {});
    const testing::TrueSpecimen& truth = campaign.split->specimen;
    expect_material(fit, {truth.density_kg_m3, truth.E1_Pa, truth.E2_Pa, truth.eta2_Pa_s});
    EXPECT_EQ(fit.theory.specimen, SpecimenWaves::massless);
    EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
    for (const FittedNumber& number : fit.parameters) {
      EXPECT_GT(number.sd, 0.0);
    }
    // Both masses are on the list, fitted or with the reason why not.
    EXPECT_GE(fit.tried.size(), 4U);
    for (const TriedTheory& tried : fit.tried) {
      EXPECT_EQ(std::isfinite(tried.chi2), tried.refused.empty());
    }
  }
}

TEST(FitSpecimen, ElasticBarsOfTwoKinds) {
  LinearShpb model;
  model.input = {4430.0, 113e9, 0.0, 0.0};
  model.output = {2700.0, 70e9, 0.0, 0.0};
  model.specimen = kCover;
  model.input_length_m = 1.2;
  model.output_length_m = 0.9;
  model.gauge_in_m = 0.6;
  model.gauge_out_m = 0.3;
  model.output_diameter_m = 0.012;
  const SpecimenFit fit = fit_specimen(shots_of(model, 4), BarPrior(paper_pmma()), {});
  expect_material(fit, kCover);
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
}

TEST(FitSpecimen, AWindowThatEndsWhileThePulseRingsCostsNoTruth) {
  LinearShpb model;
  const auto whole = model.solve();
  auto cut = whole;
  for (auto& record : cut) {
    record.resize(900);  // the pulse's front is at g1 after 480 us, its answer from 750 us on
  }
  expect_material(fit_specimen(noisy(model, cut, 4), BarPrior(paper_pmma()), {}), model.specimen);
}

TEST(FitSpecimen, FacesThatPartAfterTheFirstLoadingEndWhatIsJudged) {
  // The simulated bench's contacts pass no tension, the fit's do.
  LinearShpb nominal;
  const auto circle = [](double d) { return std::numbers::pi * d * d / 4.0; };
  BenchModel model;
  model.input = {0.7, circle(0.015), nominal.input};
  model.output = model.input;
  model.specimen = RodShape{0.004, circle(0.012), nominal.specimen};
  model.pulse.peak_force_N = nominal.input.E1_Pa * circle(0.015) * 1e-3;
  model.gauges = {{RodId::input, 0.4}, {RodId::output, 0.05}};
  const BenchHistory history = run_bench(model, 0.125e-6, 24'000);
  std::vector<std::vector<double>> records;
  for (const auto& strain : history.gauge_strain) {
    records.emplace_back(300, 0.0);
    for (std::size_t n = 0; n < strain.size(); n += 8) {
      records.back().push_back(strain[n]);
    }
  }
  const SpecimenFit fit = fit_specimen(noisy(nominal, records, 4), BarPrior(paper_pmma()), {});
  EXPECT_FALSE(fit.to_the_end);
  EXPECT_EQ(fit.theory.specimen, SpecimenWaves::rod);
  expect_material(fit, nominal.specimen);
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
}

TEST(FitSpecimen, TheBarsDeviationIsCarried) {
  // physics.md: 0.1 % of the bars' E1 moves the core's eta2 by 3.7 %.
  LinearShpb model;
  const auto shots = shots_of(model, 10);
  Material bars = paper_pmma();
  bars.E1_Pa().value *= 1.001;
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::massless;
  const SpecimenFit held = fit_specimen(shots, BarPrior(bars), options);
  bars.E1_Pa().sd = 1e-3 * bars.E1_Pa();
  const SpecimenFit carried = fit_specimen(shots, BarPrior(bars), options);
  expect_material(carried, model.specimen);
  EXPECT_NEAR(carried.chi2_reduced, 1.0, 0.15);
  EXPECT_GT(std::abs(held.parameters[2].value / model.specimen.eta2_Pa_s - 1.0), 0.02);
  EXPECT_GT(held.chi2_reduced, carried.chi2_reduced + 0.02);
  // Even the first passage tells more of the bars than that.
  options.after_foot_s = 500e-6;
  const SpecimenFit once = fit_specimen(shots, BarPrior(bars), options);
  ASSERT_EQ(once.bench.size(), 1U);
  EXPECT_LT(once.bench.front().sd, 0.7);
  expect_material(once, model.specimen);
}

/// An output bar of another viscoelastic material, with what is not known of it.
TEST(FitSpecimen, AnOutputBarOfItsOwnMaterialIsGoneByAndItsDeviationCarried) {
  LinearShpb model;
  model.output = {1180.0, 5.0e9, 30.0e9, 2.0e6};
  std::vector<Shot> shots = shots_of(model, 4);
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::massless;
  const SpecimenFit alike = fit_specimen(shots, BarPrior(paper_pmma()), options);
  EXPECT_GT(alike.chi2_reduced, 2.0);
  const auto with_own = [&](double E1_Pa, double sd_Pa) {
    for (Shot& shot : shots) {
      shot.bench.output->material = three_element_material({1180.0}, {0.36}, {E1_Pa, sd_Pa},
                                                           {30.0e9}, {2.0e6}, "the output rod");
    }
    return fit_specimen(shots, BarPrior(paper_pmma()), options);
  };
  const SpecimenFit fit = with_own(5.0e9, 0.0);
  expect_material(fit, model.specimen);
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
  EXPECT_TRUE(fit.bench.empty());
  const SpecimenFit carried = with_own(5.0e9 * 1.002, 5.0e9 * 0.002);
  expect_material(carried, model.specimen);
  ASSERT_EQ(carried.bench.size(), 1U);
  EXPECT_TRUE(carried.bench.front().name.starts_with("output-bar-model:"));
  EXPECT_NEAR(std::abs(carried.bench.front().value), 1.0, 4.0 * carried.bench.front().sd + 0.1);
}

// What two specimens on the same bars share: a bar that is filed higher by its deviation moves the
// material by just that covariance.
TEST(FitSpecimen, TheCovarianceWithTheBarsIsWhatMovingTheirPriorDoes) {
  LinearShpb model;
  const auto shots = shots_of(model, 4);
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::massless;
  options.after_foot_s = 500e-6;
  const double sd_Pa = 3e-4 * paper_pmma().E1_Pa();
  const auto fit_at = [&](double deviations) {
    Material bars = paper_pmma();
    bars.E1_Pa().value += deviations * sd_Pa;
    bars.E1_Pa().sd = sd_Pa;
    return fit_specimen(shots, BarPrior(bars), options);
  };
  const SpecimenFit fit = fit_at(0.0);
  const SpecimenFit above = fit_at(1.0);
  const SpecimenFit below = fit_at(-1.0);
  ASSERT_EQ(fit.bench.size(), 1U);
  ASSERT_EQ(fit.by_bench.size(), 3U);
  const auto moved = [&](std::size_t p) {
    return (above.parameters[p].value - below.parameters[p].value) / 2.0;
  };
  const double sign = moved(2) * fit.by_bench[2][0] > 0.0 ? 1.0 : -1.0;
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(sign * fit.by_bench[p][0], moved(p),
                0.1 * std::abs(moved(p)) + 0.02 * fit.parameters[p].sd)
        << fit.parameters[p].name;
  }
  EXPECT_GT(std::abs(fit.by_bench[2][0]), 0.1 * fit.parameters[2].sd);
}

TEST(FitSpecimen, CorrelatedModuliMoveTogether) {
  Material bars = paper_pmma();
  BarPrior prior(bars);
  const double sd1 = 1e-3 * bars.E1_Pa();
  const double sd2 = 1e-2 * bars.E2_Pa();
  prior.covariance = {{sd1 * sd1, -sd1 * sd2, 0.0}, {-sd1 * sd2, sd2 * sd2, 0.0}, {0, 0, 0}};
  const LinearShpb model;
  const Bench bench = model.bench();
  const auto stations = shpb_stations(bench);
  const auto unknowns = shpb_unknowns(bench, stations, prior);
  std::vector<double> moves(unknowns.size(), 0.0);
  double largest = 0.0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    moves.assign(unknowns.size(), 0.0);
    moves[i] = 1.0;
    const MovedShpb moved(bench, stations, prior, unknowns, moves);
    const double by1 = moved.material.E1_Pa() / bars.E1_Pa() - 1.0;
    const double by2 = moved.material.E2_Pa() / bars.E2_Pa() - 1.0;
    EXPECT_NEAR(by2, -10.0 * by1, 1e-6);
    largest = std::max(largest, std::abs(by1));
  }
  EXPECT_NEAR(largest, 1e-3, 1e-6);
}

TEST(FitSpecimen, ModuliFromWavesMoveWithTheInputBarsDensity) {
  BarPrior prior(paper_pmma());
  prior.from_waves = true;
  Bench bench = LinearShpb{}.bench();
  bench.input.density_kg_m3.sd = 0.01 * bench.input.density_kg_m3;
  const auto stations = shpb_stations(bench);
  const auto unknowns = shpb_unknowns(bench, stations, prior);
  ASSERT_EQ(unknowns.size(), 1U);
  const MovedShpb moved(bench, stations, prior, unknowns, std::vector<double>{1.0});
  EXPECT_NEAR(moved.bars[0].density_kg_m3 / bench.input.density_kg_m3, 1.01, 1e-12);
  EXPECT_NEAR(moved.material.E1_Pa() / prior.material.E1_Pa(), 1.01, 1e-12);
  EXPECT_NEAR(moved.material.eta2_Pa_s() / prior.material.eta2_Pa_s(), 1.01, 1e-12);
}

TEST(FitSpecimen, TheSpectrumHoldsTheTruthTo15kHz) {
  for (const bool massless : {true, false}) {
    LinearShpb model;
    model.massless = massless;
    const SpecimenFit fit = fit_specimen(shots_of(model, 10), BarPrior(paper_pmma()), {});
    std::size_t inside = 0;
    std::size_t count = 0;
    for (const CompliancePoint& point : fit.spectrum) {
      if (point.frequency_Hz > 15e3) {
        break;
      }
      const Complex J = compliance(model.specimen, point.frequency_Hz);
      EXPECT_NEAR(point.J1_per_Pa, J.real(), 4.5 * point.J1_sd_of_mean) << point.frequency_Hz;
      EXPECT_NEAR(point.J2_per_Pa, -J.imag(), 4.5 * point.J2_sd_of_mean) << point.frequency_Hz;
      inside += std::abs(point.J1_per_Pa - J.real()) < point.J1_sd ? 1U : 0U;
      inside += std::abs(point.J2_per_Pa + J.imag()) < point.J2_sd ? 1U : 0U;
      count += 2;
    }
    ASSERT_GT(count, 20U);
    EXPECT_GT(inside, count * 9 / 10);
  }
}

// The short form of tests/bench/specimen_coverage: gains, positions, length and bars are off
// within their deviations.
void expect_to_cover(const LinearShpb& model) {
  const testing::SpecimenRepeats experiment(model, {}, 4, 8e-6);
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::massless;
  constexpr int kRepeats = 40;
  std::array<int, 3> inside{};
  std::array<double, 3> squares{};
  testing::SpectrumCoverage spectrum;
  for (unsigned repeat = 0; repeat < kRepeats; ++repeat) {
    const SpecimenFit fit = experiment.fit(repeat, options);
    spectrum.take(fit.spectrum, model.specimen, 15e3);
    const auto off = experiment.deviations(fit);
    for (std::size_t i = 0; i < off.size(); ++i) {
      inside[i] += std::abs(off[i]) < 1.96 ? 1 : 0;
      squares[i] += off[i] * off[i] / kRepeats;
    }
  }
  for (std::size_t i = 0; i < inside.size(); ++i) {
    EXPECT_GE(inside[i], 33);  // 38 expected; fewer than 33 once in 150 runs
    EXPECT_GT(squares[i], 0.4);
    EXPECT_LT(squares[i], 1.8);
  }
  // What bench and bars move, they move at all frequencies: few of so many numbers are independent.
  EXPECT_GT(spectrum.count(), 2000U);
  EXPECT_GE(spectrum.inside_share(), 0.90);
  EXPECT_LE(spectrum.inside_share(), 0.985);
  EXPECT_GT(spectrum.mean_square(), 0.6);
  EXPECT_LT(spectrum.mean_square(), 1.4);
}

// Noise that hangs together over the record does to a soft specimen's returns what no white noise
// of the same power at each frequency does: taken for that, E2 was off by three deviations (rms).
TEST(FitSpecimen, IntervalsHoldTheTruthOfRubberWithMassInSlowNoise) {
  LinearShpb rubber;
  rubber.specimen = {1100.0, 20e6, 30e6, 1800.0};
  rubber.massless = false;
  const testing::SpecimenRepeats experiment(rubber, {}, 5, 8e-6, testing::NoiseColour::coloured);
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::rod;
  constexpr int kRepeats = 30;
  std::array<double, 3> squares{};
  for (unsigned repeat = 0; repeat < kRepeats; ++repeat) {
    const auto off = experiment.deviations(experiment.fit(repeat, options));
    for (std::size_t i = 0; i < off.size(); ++i) {
      squares[i] += off[i] * off[i] / kRepeats;
    }
  }
  std::printf("rubber with mass in slow noise: mean squares %.2f %.2f %.2f\n", squares[0],
              squares[1], squares[2]);
  for (const double square : squares) {
    EXPECT_LT(square, 2.0);
  }
}

TEST(FitSpecimen, NinetyFivePercentIntervalsHoldTheTruthOfACore) {
  expect_to_cover({});
}

TEST(FitSpecimen, NinetyFivePercentIntervalsHoldTheTruthOfACover) {
  LinearShpb cover;
  cover.specimen = {960.0, 987e6, 452e6, 6020.0};
  expect_to_cover(cover);
}

SpecimenFitOptions of_family(SolidKind solid) {
  SpecimenFitOptions options;
  options.solid = solid;
  return options;
}

void expect_numbers(const SpecimenFit& fit, const std::vector<double>& truth) {
  ASSERT_EQ(fit.parameters.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(fit.parameters[i].value, truth[i], 4.0 * fit.parameters[i].sd)
        << fit.parameters[i].name;
    EXPECT_LT(fit.parameters[i].sd, 0.3 * truth[i]) << fit.parameters[i].name;
  }
}

bool says(const std::vector<std::string>& warnings, const std::string& part) {
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.find(part) != std::string::npos;
  });
}

/// By three elements' own choice, and no worse than they are; what the family has more is nothing.
void expect_three_elements_within(const SpecimenFit& fit, const SpecimenFit& three,
                                  const RodMaterial& truth) {
  const auto chi2 = [](const SpecimenFit& of) {
    return of.chi2_reduced * static_cast<double>(of.degrees_of_freedom);
  };
  EXPECT_LT(chi2(fit), chi2(three) + 0.05);
  EXPECT_EQ(fit.theory, three.theory);
  EXPECT_EQ(fit.judged_s, three.judged_s);
  EXPECT_EQ(fit.tried.size(), three.tried.size());
  ASSERT_TRUE(fit.three_element.has_value());
  EXPECT_LT(fit.three_element->chi2_gain, 10.0);
  EXPECT_TRUE(says(fit.warnings, "off the chi2 of three elements"));
  for (const double frequency_Hz : {1e3, 5e3, 15e3}) {
    const auto at = std::min_element(fit.spectrum.begin(), fit.spectrum.end(),
                                     [&](const CompliancePoint& a, const CompliancePoint& b) {
                                       return std::abs(a.frequency_Hz - frequency_Hz) <
                                              std::abs(b.frequency_Hz - frequency_Hz);
                                     });
    const Complex J = compliance(truth, at->frequency_Hz);
    EXPECT_NEAR(at->J1_per_Pa, J.real(), 4.5 * at->J1_sd_of_mean);
    EXPECT_NEAR(at->J2_per_Pa, -J.imag(), 4.5 * at->J2_sd_of_mean);
  }
}

TEST(SpecimenFamilies, HoldThreeElementsWithinThem) {
  for (const bool massless : {true, false}) {
    for (const double noise : {0.3e-6, 20e-6}) {
      LinearShpb model;
      model.massless = massless;
      const auto shots = noisy(model, model.solve(), 2, noise);
      const SpecimenFit three = fit_specimen(shots, BarPrior(paper_pmma()), {});
      EXPECT_FALSE(three.three_element.has_value());
      for (const SolidKind solid :
           {SolidKind::fractional, SolidKind::two_kelvin, SolidKind::four_element_fluid}) {
        SCOPED_TRACE(name_of(solid) + (massless ? ", massless, " : ", rod, ") +
                     std::to_string(1e6 * noise));
        const SpecimenFit fit = fit_specimen(shots, BarPrior(paper_pmma()), of_family(solid));
        expect_three_elements_within(fit, three, model.specimen);
        if (solid == SolidKind::fractional) {
          EXPECT_LE(fit.parameters[3].value, 1.0);
          EXPECT_NEAR(fit.parameters[3].value, 1.0, 4.0 * fit.parameters[3].sd);
        }
      }
    }
  }
}

TEST(SpecimenFamilies, AFractionalSpecimenIsFound) {
  for (const double beta : {0.9, 0.6}) {
    LinearShpb model;
    model.chain = testing::fractional_three_element(400e6, 143e6, 2860.0, beta);
    const SpecimenFit fit =
        fit_specimen(shots_of(model, 4), BarPrior(paper_pmma()), of_family(SolidKind::fractional));
    expect_numbers(fit, {400e6, 143e6, 2860.0, beta});
    EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
    EXPECT_EQ(fit.theory, ShpbTheory{});
    EXPECT_GT(fit.three_element->chi2_gain, 10.0);
    EXPECT_FALSE(says(fit.warnings, "off the chi2 of three elements"));
    EXPECT_EQ(fit.tried.front().solid, SolidKind::fractional);
  }
}

TEST(SpecimenFamilies, TwoKelvinBranchesAreFound) {
  LinearShpb model;
  model.chain = testing::KelvinChain{300e6, {{200e6, 1500.0}, {300e6, 60e3}}};
  const SpecimenFit fit =
      fit_specimen(shots_of(model, 10), BarPrior(paper_pmma()), of_family(SolidKind::two_kelvin));
  expect_numbers(fit, {300e6, 200e6, 1500.0, 300e6, 60e3});
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
  EXPECT_EQ(fit.theory, ShpbTheory{});
}

// A fifth and a twentieth of the pulse's length, and longer than it: the third needs quiet gauges.
TEST(SpecimenFamilies, ThreeKelvinBranchesAreFound) {
  LinearShpb model;
  model.chain = testing::KelvinChain{400e6, {{500e6, 4e3}, {400e6, 16e3}, {300e6, 90e3}}};
  const auto shots = noisy(model, model.solve(), 6, 0.2e-6);
  const SpecimenFit fit =
      fit_specimen(shots, BarPrior(paper_pmma()), of_family(SolidKind::three_kelvin));
  expect_numbers(fit, {400e6, 500e6, 4e3, 400e6, 16e3, 300e6, 90e3});
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
  EXPECT_EQ(fit.theory, ShpbTheory{});
}

TEST(SpecimenFamilies, AFluidIsFound) {
  LinearShpb model;
  model.chain = testing::three_element(121e6, 143e6, 2860.0);
  model.chain->add_flow(1.0 / 100e3);
  const SpecimenFit fit = fit_specimen(shots_of(model, 4), BarPrior(paper_pmma()),
                                       of_family(SolidKind::four_element_fluid));
  expect_numbers(fit, {121e6, 100e3, 143e6, 2860.0});
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.2);
  EXPECT_EQ(fit.theory, ShpbTheory{});
}

// A loss that is not there is sought without end: another theory was taken then, and E1 was 18 %
// too high.
TEST(FitSpecimen, AnElasticSpecimenIsFoundAsSuch) {
  LinearShpb model;
  model.massless = false;
  model.specimen = {1140.0, 3e9, 3e15, 3e10};
  const auto records = model.solve();
  double squares = 0.0;
  std::size_t lossless = 0;
  constexpr std::size_t kCampaigns = 4;
  for (std::size_t i = 0; i < kCampaigns; ++i) {
    std::vector<Shot> shots;
    for (unsigned n = 0; n < 5; ++n) {
      shots.push_back(testing::digitise(model.bench(), records, 4e-6, 16, 0.005,
                                        1U + 5U * static_cast<unsigned>(i) + n));
    }
    const SpecimenFit fit = fit_specimen(shots, BarPrior(paper_pmma()), {});
    lossless += fit.lossless ? 1 : 0;
    EXPECT_EQ(fit.theory.specimen, SpecimenWaves::rod);
    EXPECT_EQ(fit.theory.bars, WaveTheory::elementary);
    EXPECT_LT(fit.parameters[0].sd, 0.01 * fit.parameters[0].value);
    squares += std::pow((fit.parameters[0].value - 3e9) / fit.parameters[0].sd, 2);
  }
  EXPECT_LT(squares, 18.5);  // by chance once in a thousand times
  EXPECT_GE(lossless, kCampaigns / 2) << "noise looks like a loss of three deviations now and then";
}

TEST(SpectralEstimate, IsStrainOverStressOfAMasslessSpecimen) {
  LinearShpb model;
  const SpectralEstimate estimate = estimate_spectrum(shots_of(model, 10), paper_pmma(), {});
  const std::vector<double> truth = {model.specimen.E1_Pa, model.specimen.E2_Pa,
                                     model.specimen.eta2_Pa_s};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(estimate.parameters[i].value, truth[i], 0.06 * truth[i]);
  }
  ASSERT_GT(estimate.spectrum.size(), 5U);
  for (const CompliancePoint& point : estimate.spectrum) {
    const Complex J = compliance(model.specimen, point.frequency_Hz);
    EXPECT_NEAR(point.J1_per_Pa, J.real(), 5.0 * point.J1_sd_of_mean + 0.02 * std::abs(J));
    EXPECT_NEAR(point.J2_per_Pa, -J.imag(), 5.0 * point.J2_sd_of_mean + 0.02 * std::abs(J));
  }
}

// The striker still pushes when the core's answer is back at the only gauge of the input bar.
TEST(SpectralEstimate, OfAPulseThatOutlastsTheWindowIsTheSpecimensToo) {
  LinearShpb model;
  model.pulse_s = 340e-6;
  model.record_s = 2.4e-3;
  const SpectralEstimate estimate = estimate_spectrum(shots_of(model, 5), paper_pmma(), {});
  EXPECT_EQ(estimate.separation, Separation::equilibrium);
  EXPECT_TRUE(estimate.warnings.empty());
  const std::vector<double> truth = {model.specimen.E1_Pa, model.specimen.E2_Pa,
                                     model.specimen.eta2_Pa_s};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(estimate.parameters[i].value, truth[i],
                3.0 * estimate.parameters[i].sd + 0.05 * truth[i]);
  }
}

// Chance's own deviation of chi2 is 10 % at 200 degrees of freedom, 2 % at 5000.
TEST(SpecimenWarnings, MoreThanNoiseIsWhatChanceDoesNotLeave) {
  const auto more = [](double chi2_reduced, std::size_t degrees_of_freedom) {
    SpecimenFit fit;
    fit.chi2_reduced = chi2_reduced;
    fit.degrees_of_freedom = degrees_of_freedom;
    return leaves_more_than_noise(fit);
  };
  EXPECT_FALSE(more(1.39, 200));
  EXPECT_TRUE(more(1.41, 200));
  EXPECT_FALSE(more(1.07, 5000));
  EXPECT_TRUE(more(1.09, 5000));
  EXPECT_FALSE(more(1.49, 20));
  EXPECT_TRUE(more(1.51, 20));
}

TEST(SpecimenWarnings, NameWhatIsHardlyDetermined) {
  const std::vector<FittedNumber> parameters = {{"E1_Pa", 1e20, 2.6e20}, {"E2_Pa", 7e7, 3e5}};
  const auto warnings = warnings_of(parameters);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("E1_Pa is hardly determined"), std::string::npos);
}

// Where nothing changes with a number any more it has no curvature to take a deviation from.
TEST(SpecimenWarnings, NameWhatIsNotDeterminedAtAll) {
  for (const double sd : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    const auto warnings = warnings_of(std::vector<FittedNumber>{{"E1_Pa", 1.8e23, sd}});
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings.front().find("E1_Pa is not determined"), std::string::npos);
  }
}

TEST(SpecimenWarnings, NameALossThatIsNegative) {
  CompliancePoint passive;
  passive.frequency_Hz = 1e3;
  passive.J2_per_Pa = -1e-10;  // within its deviation
  passive.J2_sd_of_mean = 1e-10;
  CompliancePoint active = passive;
  active.frequency_Hz = 2e3;
  active.J2_per_Pa = -1e-9;
  EXPECT_EQ(gives_energy_back({passive, active}).find("strain over stress has a negative J2 at 2"),
            0U);
  CompliancePoint lossy;
  lossy.J2_per_Pa = 1e-10;
  EXPECT_TRUE(gives_energy_back({lossy, lossy, active}).empty()) << "one frequency of three";
  EXPECT_TRUE(gives_energy_back({}).empty());
  EXPECT_TRUE(warnings_of({passive}).empty());
  const auto warnings = warnings_of({passive, active});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("J2 is negative at 2000 Hz"), std::string::npos);
}

TEST(SpecimenWarnings, NameASpectralEstimateThatContradictsTheDirectFit) {
  SpecimenFit fit;
  fit.chi2_reduced = 1.0;
  fit.parameters = {{"E1_Pa", 121e6, 1.5e6}, {"E2_Pa", 143e6, 2e6}, {"eta2_Pa_s", 2800.0, 80.0}};
  const std::vector<FittedNumber> near = {
      {"E1_Pa", 130e6, 4e6}, {"E2_Pa", 140e6, 4e6}, {"eta2_Pa_s", 2600.0, 90.0}};
  EXPECT_TRUE(contradiction(fit, near).empty());
  auto far = near;
  far[0] = {"E1_Pa", 154.5e6, 6.3e6};
  const auto warnings = contradiction(fit, far);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(says(warnings, "E1_Pa is 1.545e+08, 5 deviations from"));
  EXPECT_TRUE(says(warnings, "biased"));
  EXPECT_TRUE(says(warnings, "quote the direct fit"));
  // A direct fit that leaves more than noise is no better to quote.
  fit.chi2_reduced = 6.5;
  EXPECT_TRUE(says(contradiction(fit, far), "quote neither"));
  EXPECT_FALSE(says(contradiction(fit, far), "quote the direct fit"));
  // Another family's numbers are not those of three elements.
  fit.solid = SolidKind::fractional;
  EXPECT_TRUE(contradiction(fit, far).empty());
  fit.three_element = ThreeElementsBeside{fit.parameters, 0.0};
  EXPECT_EQ(contradiction(fit, far).size(), 1U);
}

TEST(FitSpecimen, RefusesWhatCannotServe) {
  LinearShpb model;
  auto shots = shots_of(model, 2);
  const BarPrior bars(paper_pmma());
  EXPECT_THROW((void)fit_specimen({}, bars, {}), InputError);
  auto other = shots;
  other[1].bench_toml = "another";
  EXPECT_THROW((void)fit_specimen(other, bars, {}), InputError);
  auto one_bar = shots;
  for (Shot& shot : one_bar) {
    shot.bench.gauges[1].bar = "input";
    shot.bench.gauges[1].position_m = {0.2};
  }
  EXPECT_THROW((void)fit_specimen(one_bar, bars, {}), InputError);
  auto bar = shots;
  bar[0].bench.kind = BenchKind::bar;
  EXPECT_THROW((void)fit_specimen(bar, bars, {}), InputError);
  auto clipped = shots;
  clipped[1].channels[0].codes[700] = clipped[1].channels[0].code_max;
  EXPECT_THROW((void)fit_specimen(clipped, bars, {}), InputError);
  // At a range that a table does not tell.
  auto cut = shots;
  std::vector<std::int32_t>& codes = cut[1].channels[0].codes;
  const auto [least, most] = std::ranges::minmax(codes);
  for (std::int32_t& code : codes) {
    code = std::clamp(code, least / 10 * 7, most / 10 * 7);
  }
  try {
    (void)fit_specimen(cut, bars, {});
    ADD_FAILURE() << "a record that was cut off is none of the specimen's";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "capture " + cut[1].id);
    EXPECT_NE(error.problem().find("it was cut off there"), std::string::npos) << error.what();
  }
  auto silent = shots;
  for (ChannelRecord& channel : silent[0].channels) {
    std::fill(channel.codes.begin(), channel.codes.end(), 0);
  }
  EXPECT_THROW((void)fit_specimen(silent, bars, {}), InputError);
  SpecimenFitOptions nothing;
  nothing.after_foot_s = 1e-6;
  EXPECT_THROW((void)fit_specimen(shots, bars, nothing), InputError);
  auto unknown_mass = shots;
  for (Shot& shot : unknown_mass) {
    shot.bench.specimen->density_kg_m3.reset();
  }
  SpecimenFitOptions rod;
  rod.specimen = SpecimenWaves::rod;
  EXPECT_THROW((void)fit_specimen(unknown_mass, bars, rod), InputError);
}

}  // namespace
}  // namespace kolsky
