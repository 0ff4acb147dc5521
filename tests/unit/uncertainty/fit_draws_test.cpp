// Draws through the identification of a specimen, against what the fit states and what repeats of
// the whole experiment show.
#include "processing/uncertainty/fit_draws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <thread>

#include "processing/identification/bar_identification.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/linear_shpb.hpp"

namespace kolsky {
namespace {

using testing::LinearShpb;

/// Shots on a core whose bench and bars are filed as exact but for what `file` changes.
std::vector<Shot> shots_of(const LinearShpb& model, std::size_t count,
                           const std::function<void(Bench&)>& file) {
  Bench bench = model.bench();
  file(bench);
  const auto records = model.solve();
  std::vector<Shot> shots;
  for (unsigned i = 1; i <= count; ++i) {
    shots.push_back(testing::digitise(bench, records, 4e-6, 16, 0.005, i));
  }
  return shots;
}

SpecimenFitOptions massless() {
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::massless;
  return options;
}

FitDraws drawn(const std::vector<Shot>& shots, const BarPrior& bars, const SpecimenFit& fit,
               std::size_t draws, const Workers& workers = {}) {
  FitDrawOptions options;
  options.draws = draws;
  return draw_specimen_fits(shots, bars, fit, nullptr, options, workers);
}

double sd_of_an_sd(std::size_t draws) {
  return 1.0 / std::sqrt(2.0 * static_cast<double>(draws));
}

TEST(FitDraws, ScatterAsTheFitStates) {
  constexpr std::size_t kDraws = 80;
  const LinearShpb model;
  const auto shots = shots_of(model, 3, [](Bench& bench) {
    for (Gauge& gauge : bench.gauges) {
      gauge.strain_per_V = Measured{1.0, 0.01};
      gauge.unit = "V";
      gauge.position_m.sd = 0.2e-3;
    }
    bench.specimen->length_m.sd = 2e-3 * bench.specimen->length_m;
  });
  Material material = paper_pmma();
  material.E2_Pa().sd = 1e-3 * material.E2_Pa();
  const BarPrior bars(material);
  const SpecimenFit fit = fit_specimen(shots, bars, massless());
  const FitDraws draws = drawn(shots, bars, fit, kDraws);
  EXPECT_EQ(draws.fit.draws, kDraws);
  EXPECT_EQ(draws.fit.failed, 0U);
  ASSERT_EQ(draws.fit.figures.size(), fit.parameters.size());
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const UncertainFigure& figure = draws.fit.figures[i];
    SCOPED_TRACE(figure.name);
    EXPECT_EQ(figure.value, fit.parameters[i].value);
    EXPECT_NEAR(figure.sd, fit.parameters[i].sd, 3.5 * sd_of_an_sd(kDraws) * figure.sd);
    EXPECT_LT(figure.low, figure.value);
    EXPECT_GT(figure.high, figure.value);
    EXPECT_NEAR(figure.high - figure.low, 2 * 1.96 * figure.sd, 1.2 * figure.sd);
  }
}

TEST(FitDraws, TemperatureSoftensTheBars) {
  constexpr std::size_t kDraws = 60;
  const LinearShpb model;
  const auto at = [&](double temperature_sd_K) {
    return shots_of(model, 3, [&](Bench& bench) {
      bench.temperature_K = Measured{293.15, temperature_sd_K};
    });
  };
  const BarPrior bars(paper_pmma());
  const SpecimenFit known = fit_specimen(at(0.0), bars, massless());
  const auto shots = at(3.0);
  const SpecimenFit unknown = fit_specimen(shots, bars, massless());
  // By as much as bars that are softer by a deviation move it, as far as the shots leave that open.
  const double deviation = 3.0 * bars.softening_per_K;
  Material softer = paper_pmma();
  softer.E1_Pa().value *= 1.0 - 0.1 * deviation;
  softer.E2_Pa().value *= 1.0 - 0.1 * deviation;
  const SpecimenFit moved = fit_specimen(at(0.0), BarPrior(softer), massless());
  const auto temperature =
      std::find_if(unknown.bench.begin(), unknown.bench.end(),
                   [](const FittedNumber& n) { return n.name == "temperature"; });
  ASSERT_NE(temperature, unknown.bench.end());
  const double left_open = temperature->sd / deviation;
  EXPECT_LT(left_open, 0.99);
  const double shift = 10.0 * (moved.parameters[0].value - known.parameters[0].value);
  const double both = std::hypot(known.parameters[0].sd, left_open * shift);
  EXPECT_GT(both, 1.05 * known.parameters[0].sd);
  EXPECT_NEAR(unknown.parameters[0].sd, both, 0.05 * both);
  const FitDraws draws = drawn(shots, bars, unknown, kDraws);
  EXPECT_NEAR(draws.fit.figures[0].sd, unknown.parameters[0].sd,
              3.5 * sd_of_an_sd(kDraws) * unknown.parameters[0].sd);
  // The same noise without it: what is more is the temperature's.
  const FitDraws exact = drawn(at(0.0), bars, known, kDraws);
  EXPECT_NEAR(draws.fit.figures[0].sd / exact.fit.figures[0].sd, both / known.parameters[0].sd,
              0.15 * both / known.parameters[0].sd);
  BarPrior stiff = bars;
  stiff.softening_per_K = 0.0;
  EXPECT_NEAR(fit_specimen(shots, stiff, massless()).parameters[0].sd, known.parameters[0].sd,
              1e-6 * known.parameters[0].sd);
}

TEST(FitDraws, AreTheSameHoweverTheyAreShared) {
  const LinearShpb model;
  const auto shots = shots_of(model, 2, [](Bench&) {});
  const BarPrior bars(paper_pmma());
  const SpecimenFit fit = fit_specimen(shots, bars, massless());
  Workers two;
  two.workers = 2;
  two.run = [](std::size_t count, const auto& work) {
    std::thread odd([&] {
      for (std::size_t i = 1; i < count; i += 2) {
        work(i, 1);
      }
    });
    for (std::size_t i = 0; i < count; i += 2) {
      work(i, 0);
    }
    odd.join();
  };
  const FitDraws alone = drawn(shots, bars, fit, 20);
  const FitDraws shared = drawn(shots, bars, fit, 20, two);
  for (std::size_t i = 0; i < alone.fit.figures.size(); ++i) {
    EXPECT_EQ(alone.fit.figures[i].sd, shared.fit.figures[i].sd);
    EXPECT_EQ(alone.fit.figures[i].low, shared.fit.figures[i].low);
  }
}

// Strain over stress takes the bench as exact: its own deviations are too small, those of draws are
// not.
TEST(FitDraws, GiveStrainOverStressTheBenchsShare) {
  const LinearShpb model;
  const auto shots = shots_of(model, 3, [](Bench& bench) {
    for (Gauge& gauge : bench.gauges) {
      gauge.strain_per_V = Measured{1.0, 0.02};
      gauge.unit = "V";
    }
  });
  const BarPrior bars(paper_pmma());
  const SpecimenFit fit = fit_specimen(shots, bars, massless());
  const SpectralEstimate spectral = estimate_spectrum(shots, bars.material, {});
  FitDrawOptions options;
  options.draws = 40;
  const FitDraws draws = draw_specimen_fits(shots, bars, fit, &spectral, options, Workers{});
  ASSERT_EQ(draws.spectral->figures.size(), 3U);
  const double truth[] = {model.specimen.E1_Pa, model.specimen.E2_Pa, model.specimen.eta2_Pa_s};
  for (std::size_t i = 0; i < 3; ++i) {
    SCOPED_TRACE(draws.spectral->figures[i].name);
    EXPECT_GT(draws.spectral->figures[i].sd, 1.2 * spectral.parameters[i].sd);
    EXPECT_LT(std::abs(draws.spectral->figures[i].value - truth[i]),
              3.0 * draws.spectral->figures[i].sd);
  }
}

// Of one shot how far points lie off the fit stated a quarter of the errors. The mean square of
// twelve deviations exceeds 2.74 by chance once in a thousand times.
TEST(NoiseOfStrainOverStress, IsInTheDeviationsOfFewShots) {
  const LinearShpb model;
  const auto all = shots_of(model, 24, [](Bench&) {});
  const double truth[] = {model.specimen.E1_Pa, model.specimen.E2_Pa, model.specimen.eta2_Pa_s};
  for (const std::size_t count : {1U, 2U}) {
    double squares[3] = {};
    for (std::size_t i = 0; i < 12; ++i) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(count * i);
      const std::vector<Shot> shots(begin, begin + static_cast<std::ptrdiff_t>(count));
      SpectralEstimate estimate = estimate_spectrum(shots, paper_pmma(), {});
      take_in_noise(shots, paper_pmma(), WaveTheory::elementary, estimate, Workers{});
      for (std::size_t p = 0; p < 3; ++p) {
        squares[p] +=
            std::pow((estimate.parameters[p].value - truth[p]) / estimate.parameters[p].sd, 2) /
            12.0;
      }
    }
    for (const double square : squares) {
      EXPECT_LT(square, 2.74) << count;
      EXPECT_GT(square, 0.2) << count;
    }
  }
}

TEST(FitDraws, OfABarScatterAsItsFitStates) {
  constexpr std::size_t kDraws = 100;
  testing::BarShots::Setup setup;
  setup.material = {1180.0, 5.66e9, 37.0e9, 1.81e6};
  const testing::BarShots bar(setup);
  std::mt19937_64 random(7);
  testing::BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  const auto shots = bar.draw(3, recording, random);
  const BarFit fit = fit_bar(shots, {.theory = WaveTheory::elementary});
  FitDrawOptions options;
  options.draws = kDraws;
  const FitDraws draws = draw_bar_fits(shots, fit, options, Workers{});
  EXPECT_EQ(draws.fit.draws, kDraws);
  EXPECT_FALSE(draws.spectral.has_value());
  EXPECT_TRUE(draws.fit.warnings.empty()) << draws.fit.warnings.front();
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    SCOPED_TRACE(fit.parameters[i].name);
    EXPECT_NEAR(draws.fit.figures[i].sd, fit.parameters[i].sd,
                3.5 * sd_of_an_sd(kDraws) * fit.parameters[i].sd);
  }
}

// An elastic bar: E2 and eta2 stand for a loss that is not there, and nothing is known of them.
TEST(FitDraws, OfABarWithoutLossAreOfItsModulusAlone) {
  const testing::Campaign made = testing::draw_campaign({.seed = 6005,
                                                         .shots = 2,
                                                         .gauges = 2,
                                                         .tolerances = testing::Tolerances::filed,
                                                         .elastic = true});
  const std::vector<Shot> shots = testing::shots_of(made);
  const BarIdentification found = identify_bar(shots, {}, Workers{});
  ASSERT_TRUE(found.three_element.lossless);
  FitDrawOptions options;
  options.draws = 20;
  const FitDraws draws = draw_bar_fits(shots, found.three_element, options, Workers{});
  ASSERT_EQ(draws.fit.figures.size(), 1U);
  EXPECT_EQ(draws.fit.figures[0].name, "E1_Pa");
}

// Where the records hold more than the model has, the fit widens its deviations and draws do not.
TEST(FitDraws, SayWhatTheyDoNotHold) {
  LinearShpb model;
  model.massless = false;
  const auto shots = shots_of(model, 2, [](Bench&) {});
  const BarPrior bars(paper_pmma());
  const SpecimenFit fit = fit_specimen(shots, bars, massless());
  ASSERT_GT(fit.chi2_reduced, 3.0);
  const FitDraws draws = drawn(shots, bars, fit, 20);
  ASSERT_FALSE(draws.fit.warnings.empty());
  EXPECT_NE(draws.fit.warnings.front().find("the fit states"), std::string::npos);
}

// Bars ten times as uncertain as they ever are: many draws of strain over stress find nothing,
// which costs the direct fit none of its own.
TEST(FitDraws, CountThoseThatFoundNothing) {
  LinearShpb model;
  model.pulse_s = 340e-6;
  model.record_s = 2.4e-3;
  const auto shots = shots_of(model, 1, [](Bench& bench) {
    bench.temperature_K = Measured{293.15, 10.0};
  });
  BarPrior bars(paper_pmma());
  bars.softening_per_K = 0.01;
  const SpecimenFit fit = fit_specimen(shots, bars, massless());
  const SpectralEstimate spectral = estimate_spectrum(shots, bars.material, {});
  FitDrawOptions options;
  options.draws = 40;
  const FitDraws draws = draw_specimen_fits(shots, bars, fit, &spectral, options, Workers{});
  EXPECT_EQ(draws.fit.draws + draws.fit.failed, 40U);
  EXPECT_EQ(draws.spectral->draws + draws.spectral->failed, 40U);
  EXPECT_GT(draws.spectral->failed, draws.fit.failed);
  EXPECT_FALSE(draws.spectral->warnings.empty());
  for (const UncertainFigure& figure : draws.spectral->figures) {
    EXPECT_LT(figure.sd, 100.0 * figure.value);
  }
}

}  // namespace
}  // namespace kolsky
