// Shots solved in the time domain, given to the identification as a whole.
#include "processing/identification/bar_identification.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <numbers>
#include <ranges>
#include <thread>

#include "processing/base/error.hpp"
#include "processing/identification/better_solid.hpp"
#include "processing/identification/foretold_shots.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/spectrum_coverage.hpp"
#include "tests/generators/table4.hpp"

namespace kolsky {
namespace {

using testing::BarShots;
using testing::kTable4;
using testing::NoiseColour;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

const BarShots& paper_bar() {
  static const BarShots shots([] {
    BarShots::Setup setup;
    setup.material = kTable4[0].material;
    return setup;
  }());
  return shots;
}

std::vector<Shot> draw(const BarShots& bar, std::size_t count, unsigned seed,
                       const BarShots::Recording& recording = {}) {
  std::mt19937_64 random(seed);
  return bar.draw(count, recording, random);
}

void expect_truth(const BarIdentification& result, const RodMaterial& truth) {
  const double values[3] = {truth.E1_Pa, truth.E2_Pa, truth.eta2_Pa_s};
  for (std::size_t i = 0; i < 3; ++i) {
    const FittedNumber& p = result.three_element.parameters[i];
    EXPECT_NEAR(p.value, values[i], 4.0 * p.sd) << p.name;
  }
}

BarShots elastic_bar(std::size_t post_samples) {
  BarShots::Setup setup;
  setup.material = {.density_kg_m3 = 2700.0, .E1_Pa = 70e9, .E2_Pa = 0.0, .eta2_Pa_s = 0.0};
  setup.post_samples = post_samples;
  return BarShots(setup);
}

bool says(const BarIdentification& result, const std::string& words) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [&](const auto& warning) { return warning.find(words) != std::string::npos; });
}

// A bar that loses nothing is found to lose nothing, whatever the noise makes of a search for a
// loss.
TEST(IdentifyBar, ElasticBarsAreFoundAsSuch) {
  testing::BarShots::Setup setup;
  setup.material = {.density_kg_m3 = 7850.0, .E1_Pa = 210e9};
  setup.position_m = {0.3, 0.7, 1.3};
  setup.poisson_ratio = 0.29;
  setup.post_samples = 3696;
  const testing::BarShots bar(setup);
  testing::BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  double chi2 = 0.0;
  constexpr unsigned kSeeds = 20;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937_64 random(seed);
    const BarIdentification result = identify_bar(bar.draw(5, recording, random), {});
    const FittedNumber& E1 = result.three_element.parameters[0];
    EXPECT_FALSE(result.three_element.misfit) << seed;
    EXPECT_LT(std::abs(E1.value - 210e9), 3.0 * E1.sd) << seed;
    const FittedNumber& E2 = result.three_element.parameters[1];
    EXPECT_GT(E2.sd, 0.3 * E2.value) << seed;
    EXPECT_FALSE(better_solid(result)) << seed;
    chi2 += result.three_element.chi2_reduced / kSeeds;
  }
  EXPECT_NEAR(chi2, 1.0, 0.025);  // three deviations of their mean
}

TEST(IdentifyBar, EveryRowOfTable4WithTolerances) {
  BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  for (const auto& row : kTable4) {
    SCOPED_TRACE(row.source);
    BarShots::Setup setup;
    setup.material = row.material;
    setup.poisson_ratio = row.poisson_ratio;
    const auto result =
        identify_bar(draw(BarShots(setup), 3, 11, recording), {.compare_solids = false});
    EXPECT_EQ(result.three_element.theory, WaveTheory::elementary);
    EXPECT_TRUE(result.wave_theory.told_apart);
    EXPECT_EQ(result.three_element.far_end, FarEndReturn::free);
    EXPECT_TRUE(result.far_end.told_apart);
    EXPECT_NEAR(result.three_element.chi2_reduced, 1.0, 0.12);
    expect_truth(result, row.material);
  }
}

// Pulses of many shapes, smooth ones among them, whose spectra are lost in the noise little by
// little: there all residuals hold the noise of gauge 0, by which the shots' waves were told, and
// three of these bars were said not to be what they are.
TEST(IdentifyBar, TrueModelsAreNotSaidToMisfit) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const testing::CampaignWishes wishes{
        .seed = seed, .noise_strain = 4e-6, .tolerances = testing::Tolerances::filed};
    const auto result =
        identify_bar(testing::shots_of(testing::draw_campaign(wishes)), {.compare_solids = false});
    EXPECT_FALSE(result.three_element.misfit.has_value()) << seed;
  }
}

TEST(IdentifyBar, ShotsOfSeveralTemperaturesAreSaidToBe) {
  std::vector<Shot> shots = draw(paper_bar(), 2, 5);
  for (Shot& shot : shots) {
    shot.bench.temperature_K = Measured{293.0};
  }
  shots[0].meta["temperature_K"] = "292.5";
  const auto alike = identify_bar(shots, {.compare_solids = false});
  EXPECT_FALSE(says(alike, "no one temperature"));
  ASSERT_TRUE(alike.temperature_K);
  EXPECT_DOUBLE_EQ(*alike.temperature_K, 292.75);
  shots[0].meta["temperature_K"] = "283";
  shots[1].meta["temperature_K"] = "303";
  EXPECT_TRUE(says(identify_bar(shots, {.compare_solids = false}), "no one temperature"));
  shots[1].meta["temperature_K"] = "warm";
  EXPECT_THROW((void)identify_bar(shots, {.compare_solids = false}), InputError);
}

/// Ten shots' mean by what is stated of the mean, over several sets (of forty, 95.0 % were inside):
/// neighbouring frequencies share their noise and are out together.
TEST(IdentifyBar, TheSpectrumHoldsTheTruthTo15kHz) {
  const RodMaterial& m = paper_bar().setup().material;
  testing::SpectrumCoverage coverage;
  for (const unsigned seed : std::views::iota(3U, 23U)) {
    const auto shots = draw(paper_bar(), 10, seed);
    coverage.take(identify_bar(shots, {.compare_solids = false}).spectrum, m, 15e3);
  }
  std::printf("J1, J2 to 15 kHz: %.1f %% of %zu inside 1.96 deviations, mean square %.2f\n",
              100.0 * coverage.inside_share(), coverage.count(), coverage.mean_square());
  EXPECT_GT(coverage.count(), 2000U);
  EXPECT_GE(coverage.inside_share(), 0.92);
  EXPECT_LE(coverage.inside_share(), 0.98);
  EXPECT_GT(coverage.mean_square(), 0.8);
  EXPECT_LT(coverage.mean_square(), 1.25);
}

TEST(IdentifyBar, ThePapersAnalysisComesOutBesideIt) {
  const auto result = identify_bar(draw(paper_bar(), 5, 4), {.compare_solids = false});
  ASSERT_EQ(result.paper.size(), 3U);
  EXPECT_NEAR(result.paper[0].value / 5.66e9, 1.0, 0.01);
  EXPECT_NEAR(result.paper[1].value / 37.0e9, 1.0, 0.1);
  EXPECT_NEAR(result.paper[2].value / 1.81e6, 1.0, 0.1);
}

TEST(IdentifyBar, WhatTheRecordsDoNotShowIsSaid) {
  BarShots::Setup setup;
  setup.material = kTable4[0].material;
  setup.length_m = 6.0;  // nothing comes back within the record
  setup.post_samples = 1500;
  const auto result = identify_bar(draw(BarShots(setup), 2, 5), {.compare_solids = false});
  EXPECT_FALSE(result.far_end.told_apart);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.front().find("far end"), std::string::npos);
  expect_truth(result, setup.material);
}

/// What holds three elements within it can fit no worse than they do, but for where searches end:
/// at 0.1 of chi2 each.
TEST(IdentifyBar, WhatHoldsThreeElementsFitsNoWorse) {
  constexpr double kEnds = 0.2;
  BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  recording.noise_correlation = 0.95;
  for (const std::size_t row : {std::size_t{0}, std::size_t{3}}) {
    BarShots::Setup setup;
    setup.material = kTable4[row].material;
    setup.poisson_ratio = kTable4[row].poisson_ratio;
    const BarShots bar(setup);
    for (const unsigned seed : {1U, 2U, 3U}) {
      SCOPED_TRACE(std::to_string(row) + " " + std::to_string(seed));
      const auto result = identify_bar(draw(bar, 10, seed, recording), {});
      const auto more_than_three = [](const Alternative& other) {
        return static_cast<double>(parameters_of(other.theory.solid).size()) - 3.0 +
               (other.theory.far_end == FarEndReturn::partial ? 1.0 : 0.0);
      };
      const auto chi2 = [&](const Alternative& other) {
        return other.chi2_reduced * (static_cast<double>(result.three_element.degrees_of_freedom) -
                                     more_than_three(other));
      };
      const auto searched = [&](const Alternative& other) {
        return other.theory.waves == result.three_element.theory && other.failed.empty() &&
               !other.left_behind;
      };
      const auto three = std::find_if(
          result.alternatives.begin(), result.alternatives.end(),
          [&](const auto& other) { return searched(other) && more_than_three(other) == 0.0; });
      ASSERT_NE(three, result.alternatives.end());
      std::size_t holding = 0;
      for (const Alternative& other : result.alternatives) {
        if (!searched(other) || more_than_three(other) <= 0.0) {
          continue;
        }
        EXPECT_LT(chi2(other), chi2(*three) + kEnds)
            << name_of(other.theory.solid) << " " << name_of(other.theory.far_end);
        ++holding;
      }
      EXPECT_EQ(holding, 3U);
    }
  }
}

TEST(IdentifyBar, TheoriesThatAreFarBehindAreLeftThere) {
  const auto result = identify_bar(draw(paper_bar(), 10, 5), {});
  std::size_t left = 0;
  for (const Alternative& other : result.alternatives) {
    const bool wrong =
        other.theory.waves != WaveTheory::elementary || other.theory.far_end == FarEndReturn::none;
    const bool needless = other.theory.far_end == FarEndReturn::partial;
    EXPECT_EQ(other.left_behind, wrong || needless) << name_of(other.theory.waves);
    EXPECT_EQ(other.log_evidence < result.fit.log_evidence - 1000.0, wrong);
    left += other.left_behind ? 1 : 0;
  }
  EXPECT_EQ(left, 4U);
}

/// An end that may return anything is not searched closely where a rough search finds it no better
/// than a free one: what is said of it then is what its search would have come to.
TEST(IdentifyBar, AnEndThatIsLeftRoughlyIsAsFarBehindAsItsSearchFindsIt) {
  const auto shots = draw(paper_bar(), 10, 5);
  const auto result = identify_bar(shots, {});
  const BarFit searched =
      fit_bar(shots, {.theory = WaveTheory::elementary, .far_end = FarEndReturn::partial});
  std::size_t said = 0;
  for (const Alternative& other : result.alternatives) {
    if (other.theory.far_end == FarEndReturn::partial) {
      ++said;
      EXPECT_NEAR(other.log_evidence, searched.log_evidence, 2.0);
      EXPECT_NEAR(other.chi2_reduced, searched.chi2_reduced, 1e-3);
    }
  }
  EXPECT_EQ(said, 1U);
}

TEST(IdentifyBar, ThreadsShareTheSearchWithoutMovingIt) {
  Workers backwards;
  std::size_t most_at_once = 0;
  backwards.run = [&](std::size_t count,
                      const std::function<void(std::size_t, std::size_t)>& work) {
    most_at_once = std::max(most_at_once, count);
    std::vector<std::jthread> threads;
    for (std::size_t index = count; index-- > 0;) {
      threads.emplace_back([&work, index] { work(index, 0); });
    }
  };
  const auto shots = draw(paper_bar(), 3, 6);
  const auto one = identify_bar(shots, {});
  const auto several = identify_bar(shots, {}, backwards);
  EXPECT_GE(most_at_once, 4U);
  EXPECT_EQ(one.fit.at, several.fit.at);
  EXPECT_EQ(one.spectrum.J1_per_Pa.mean, several.spectrum.J1_per_Pa.mean);
  ASSERT_EQ(one.alternatives.size(), several.alternatives.size());
  for (std::size_t i = 0; i < one.alternatives.size(); ++i) {
    EXPECT_EQ(one.alternatives[i].theory, several.alternatives[i].theory);
    EXPECT_EQ(one.alternatives[i].log_evidence, several.alternatives[i].log_evidence);
  }
}

TEST(IdentifyBar, AnElasticBarHasNoLossToFind) {
  const auto result = identify_bar(draw(elastic_bar(1200), 2, 6), {.compare_solids = false});
  const FittedNumber& E1 = result.three_element.parameters[0];
  EXPECT_NEAR(E1.value, 70e9, 5.0 * E1.sd);
  EXPECT_NEAR(E1.value / 70e9, 1.0, 1e-3);
  EXPECT_TRUE(says(result, "as good as elastic"));
}

/// Ten times the noise: a search from the pulses' own speed ends where no wave is, and a loss too
/// quick to show stood for the elastic bar, E1 41 % uncertain and 18 % off.
TEST(IdentifyBar, AnElasticBarIsFoundFromWeakPulses) {
  const BarShots bar = elastic_bar(3600);
  for (const auto& [noise_rms, seed] :
       {std::pair{100e-6, 17U}, {100e-6, 22U}, {100e-6, 25U}, {150e-6, 7U}, {150e-6, 16U}}) {
    BarShots::Recording recording;
    recording.noise_rms = noise_rms;
    const auto result = identify_bar(draw(bar, 3, seed, recording), {.compare_solids = false});
    const FittedNumber& E1 = result.three_element.parameters[0];
    EXPECT_LT(E1.sd, 0.01 * E1.value) << noise_rms << " " << seed;
    EXPECT_NEAR(E1.value, 70e9, 4.0 * E1.sd) << noise_rms << " " << seed;
  }
}

/// Where a pulse is hidden its inverted return is found first.
TEST(IdentifyBar, AHiddenPulseIsNoGaugeOfTheOtherSign) {
  const BarShots bar = elastic_bar(3600);
  BarShots::Recording recording;
  recording.noise_rms = 150e-6;
  for (const unsigned seed : {4U, 5U, 6U, 14U, 20U, 23U}) {
    try {
      (void)identify_bar(draw(bar, 3, seed, recording), {.compare_solids = false});
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find("other sign"), std::string::npos) << error.what();
    }
  }
}

TEST(IdentifyBar, AGaugeOfTheOtherSignIsNamed) {
  std::vector<Shot> shots = draw(paper_bar(), 2, 5);
  for (Shot& shot : shots) {
    for (std::int32_t& code : shot.channels[2].codes) {
      code = -code;
    }
  }
  try {
    (void)identify_bar(shots, {});
    FAIL() << "fitted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("g3 seems to read with the other sign"),
              std::string::npos)
        << error.what();
  }
}

/// Nothing but noise tells E2 and eta2 then: searches run along valleys, which must not end in no
/// answer, nor in a far end that would not be free.
TEST(IdentifyBar, ElasticBarsInLoudNoiseHaveFreeEndsAndTheirModulus) {
  BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  recording.noise_rms = 20e-6;
  for (const std::size_t row : {std::size_t{0}, std::size_t{2}}) {
    BarShots::Setup setup;
    setup.material = kTable4[row].material;
    setup.poisson_ratio = kTable4[row].poisson_ratio;
    setup.material.E2_Pa *= 1000.0;
    setup.material.eta2_Pa_s *= 1000.0;
    const BarShots bar(setup);
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(std::to_string(row) + " " + std::to_string(seed));
      const auto result =
          identify_bar(draw(bar, 3, 500 + 10 * static_cast<unsigned>(row) + seed, recording), {});
      EXPECT_EQ(result.three_element.far_end, FarEndReturn::free);
      const FittedNumber& E1 = result.three_element.parameters[0];
      EXPECT_NEAR(E1.value, setup.material.E1_Pa, 4.0 * E1.sd);
    }
  }
}

/// Each gauge reads more than the one before it, by a factor.
void let_waves_grow(std::vector<Shot>& shots, double factor) {
  for (Shot& shot : shots) {
    double gain = 1.0;
    for (ChannelRecord& channel : shot.channels) {
      for (std::int32_t& code : channel.codes) {
        code = static_cast<std::int32_t>(std::lround(gain * code));
      }
      gain *= factor;
    }
  }
}

/// The misfit that growth leaves must not excuse it, however short the records are.
TEST(IdentifyBar, GrowingWavesAreFlagged) {
  for (const std::size_t post_samples : {500U, 3600U}) {
    for (const double growth : {1.004, 1.05, 1.25}) {
      SCOPED_TRACE(std::to_string(post_samples) + " " + std::to_string(growth));
      auto shots = draw(elastic_bar(post_samples), 2, 7);
      let_waves_grow(shots, growth);
      const auto result = identify_bar(shots, {.compare_solids = false});
      EXPECT_TRUE(says(result, "not passive: J2 is negative"));
      EXPECT_FALSE(says(result, "not passive: J2 is negative, by -")) << "twice negative";
      EXPECT_TRUE(says(result, "deviations on average over the band"));
      EXPECT_FALSE(says(result, "as good as elastic"));
    }
  }
  auto lossy = draw(paper_bar(), 2, 7);
  let_waves_grow(lossy, 1.25);
  EXPECT_TRUE(says(identify_bar(lossy, {.compare_solids = false}), "not passive"));
}

TEST(IdentifyBar, AnElasticBarIsNotSaidToLetWavesGrow) {
  BarShots::Recording filed;
  filed.gain_sd = 0.01;
  filed.position_sd_m = 0.2e-3;
  for (const std::size_t post_samples : {500U, 3600U}) {
    const BarShots bar = elastic_bar(post_samples);
    for (const auto& recording : {BarShots::Recording{}, filed}) {
      for (unsigned seed = 0; seed < 8; ++seed) {
        SCOPED_TRACE(seed);
        const auto result =
            identify_bar(draw(bar, 2, 70 + seed, recording), {.compare_solids = false});
        EXPECT_FALSE(says(result, "not passive"));
      }
    }
  }
}

TEST(IdentifyBar, WhatCannotServeIsRefusedWithWhatWouldBeNeeded) {
  auto one_gauge = draw(paper_bar(), 1, 8);
  one_gauge[0].bench.gauges.resize(1);
  one_gauge[0].channels.resize(1);
  EXPECT_THROW((void)identify_bar(one_gauge, {}), InputError);
  auto no_pulse = draw(paper_bar(), 1, 8);
  for (std::int32_t& code : no_pulse[0].channels[2].codes) {
    code %= 3;
  }
  try {
    (void)identify_bar(no_pulse, {});
    FAIL() << "took a gauge without a pulse";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("g3"), std::string::npos);
  }
  auto one_place = draw(paper_bar(), 1, 8);
  for (Gauge& gauge : one_place[0].bench.gauges) {
    gauge.position_m = {0.3};
  }
  EXPECT_THROW((void)identify_bar(one_place, {}), InputError);
  EXPECT_THROW((void)identify_bar(draw(paper_bar(), 1, 8), {.band_limit_Hz = 400e3}), InputError);
}

// A table does not tell its converter's range: the record does, where it stays at an end.
TEST(IdentifyBar, ARecordThatWasCutOffIsRefusedAtEitherEnd) {
  for (const bool top : {true, false}) {
    std::vector<Shot> shots = draw(paper_bar(), 2, 8);
    std::vector<std::int32_t>& codes = shots[1].channels[2].codes;
    const auto [least, most] = std::ranges::minmax(codes);
    for (std::int32_t& code : codes) {
      code = top ? std::min(code, most / 10 * 7) : std::max(code, least / 10 * 7);
    }
    try {
      (void)identify_bar(shots, {});
      ADD_FAILURE() << "a record that was cut off is none of the bar's, top: " << top;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("capture " + shots[1].id), std::string::npos);
      EXPECT_NE(std::string(error.what())
                    .find("gauge " + shots[1].channels[2].gauge + " stays at its extreme"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(IdentifyBar, ARecordThatBeginsWithinItsPulseHasNoQuietPart) {
  std::vector<Shot> shots = draw(paper_bar(), 2, 8);
  const auto& codes = shots[0].channels[0].codes;
  const auto most = *std::ranges::max_element(codes);
  const auto risen =
      std::ranges::find_if(codes, [&](std::int32_t code) { return 3 * code > most; });
  const auto late = risen - codes.begin();
  for (Shot& shot : shots) {
    for (ChannelRecord& channel : shot.channels) {
      channel.codes.erase(channel.codes.begin(), channel.codes.begin() + late);
    }
  }
  try {
    (void)identify_bar(shots, {});
    ADD_FAILURE() << "what begins within a pulse has no baseline";
  } catch (const InputError& error) {
    EXPECT_NE(error.problem().find("has no quiet part"), std::string::npos) << error.what();
  }
}

TEST(IdentifyBar, ExchangedGaugesAreSaidFirst) {
  std::vector<Shot> shots = draw(paper_bar(), 3, 8);
  for (Shot& shot : shots) {
    std::swap(shot.channels[1].codes, shot.channels[2].codes);
  }
  const BarIdentification result = identify_bar(shots, {.compare_solids = false});
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.front().find("were the two exchanged"), std::string::npos)
      << result.warnings.front();
}

/// Codes of a file that are finer than those of the converter that it was made from, which has
/// steps of so many of the finer ones, and an offset of less than one.
void coarsen(ChannelRecord& channel, double step, double offset) {
  constexpr std::int32_t kFiner = 1000;
  for (std::int32_t& code : channel.codes) {
    code = static_cast<std::int32_t>(
        std::lround(kFiner * step * std::round(static_cast<double>(code) / step + offset)));
  }
  channel.scale /= kFiner;
  channel.code_min = std::numeric_limits<std::int32_t>::min();
  channel.code_max = std::numeric_limits<std::int32_t>::max();
}

// While nothing moves such a converter stays at one code: that is neither a record without noise
// nor a baseline without a deviation.
TEST(IdentifyBar, AQuietConverterOfCoarseStepsHasTheNoiseOfItsSteps) {
  constexpr double kStep_codes = 100.0;  // of 0.3 microstrain
  const double truth[3] = {paper_bar().setup().material.E1_Pa, paper_bar().setup().material.E2_Pa,
                           paper_bar().setup().material.eta2_Pa_s};
  unsigned within = 0;
  constexpr unsigned kSets = 6;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    std::vector<Shot> shots = draw(paper_bar(), 5, 40 + seed, {.noise_rms = 2e-6});
    for (std::size_t n = 0; n < shots.size(); ++n) {
      for (std::size_t j = 0; j < shots[n].channels.size(); ++j) {
        coarsen(shots[n].channels[j], kStep_codes,
                0.07 * static_cast<double>((7 * n + 3 * j + seed) % 10) - 0.32);
      }
    }
    const BarIdentification result = identify_bar(shots, {.compare_solids = false});
    // Smooth pulses leave more of their rounding in the band than noise would; without a step: 6e4.
    EXPECT_LT(result.three_element.chi2_reduced, 10.0) << seed;
    EXPECT_TRUE(says(result, "reads in steps of 30.5176 microstrain")) << seed;
    for (std::size_t i = 0; i < 3; ++i) {
      const FittedNumber& number = result.three_element.parameters[i];
      EXPECT_TRUE(number.sd > 0.0 && number.sd < 0.2 * number.value) << number.name << seed;
      within += std::abs(number.value - truth[i]) < 2.0 * number.sd ? 1 : 0;
    }
  }
  EXPECT_GE(within, 14U) << "of 18 within two deviations";
}

// A channel that is filed on time and is late leaves what one number more takes up; what it then
// says of the end is that all comes back.
TEST(IdentifyBar, AnEndThatReturnsAllIsFreeWhateverElseIsOff) {
  std::vector<Shot> shots = draw(paper_bar(), 5, 12);
  for (Shot& shot : shots) {
    auto& codes = shot.channels[1].codes;
    std::rotate(codes.begin(), codes.end() - 2, codes.end());
  }
  const BarIdentification result = identify_bar(shots, {.compare_solids = false});
  EXPECT_EQ(result.fit.far_end, FarEndReturn::free);
  EXPECT_FALSE(says(result, "neither free"));
}

/// Cramer and Rao: information on the logarithms of E1, E2, eta2 from whole records with the source
/// unknown at every frequency, gains and positions exact, by finite differences of the elementary
/// wave on the imaginary axis. Shares nothing with the fit.
std::vector<double> cramer_rao(const BarShots& bar, std::size_t shots, double noise_rms) {
  using C = std::complex<double>;
  const auto& setup = bar.setup();
  const double length = setup.length_m;
  const auto h = [&](const Eigen::Vector3d& p, double w, double x) {
    const C J = std::exp(-p[0]) + 1.0 / C(std::exp(p[1]), w * std::exp(p[2]));
    const C gamma = C(0.0, w) * std::sqrt(setup.material.density_kg_m3 * J);
    return std::exp(-gamma * x) - std::exp(-gamma * (2.0 * length - x));
  };
  const Eigen::Vector3d truth(std::log(setup.material.E1_Pa), std::log(setup.material.E2_Pa),
                              std::log(setup.material.eta2_Pa_s));
  const std::size_t samples = bar.strain(0).size();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const auto gauges = static_cast<Eigen::Index>(setup.position_m.size());
  for (std::size_t k = 1; k < samples / 16; ++k) {
    const double w = kTwoPi * 1e6 * static_cast<double>(k) / static_cast<double>(samples);
    C first = 0.0;
    for (std::size_t n = 0; n < samples; ++n) {
      first += bar.strain(0)[n] * std::polar(1.0, -w * 1e-6 * static_cast<double>(n));
    }
    Eigen::VectorXcd at(gauges);
    Eigen::MatrixXcd slope(gauges, 3);
    for (Eigen::Index j = 0; j < gauges; ++j) {
      const double x = setup.position_m[static_cast<std::size_t>(j)];
      at[j] = h(truth, w, x);
      for (Eigen::Index m = 0; m < 3; ++m) {
        Eigen::Vector3d up = truth;
        Eigen::Vector3d down = truth;
        up[m] += 1e-5;
        down[m] -= 1e-5;
        slope(j, m) = (h(up, w, x) - h(down, w, x)) / 2e-5;
      }
    }
    const Eigen::MatrixXcd free = slope - at * (at.adjoint() * slope) / at.squaredNorm();
    const double source = std::norm(first / at[0]);
    for (std::size_t shot = 0; shot < shots; ++shot) {
      const double peak = 1e-3 + 2e-3 * static_cast<double>(shot) / static_cast<double>(shots - 1);
      information +=
          (2.0 * source * peak * peak / (noise_rms * noise_rms * static_cast<double>(samples))) *
          (free.adjoint() * free).real();
    }
  }
  const Eigen::Matrix3d covariance = information.inverse();
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

TEST(FitBar, IsNearlyAsGoodAsCanBe) {
  constexpr int kRepeats = 100;
  const std::vector<double> bound = cramer_rao(paper_bar(), 10, 4e-6);
  const RodMaterial& m = paper_bar().setup().material;
  const double truth[3] = {m.E1_Pa, m.E2_Pa, m.eta2_Pa_s};
  double squares[3] = {};
  for (unsigned seed = 0; seed < kRepeats; ++seed) {
    const BarFit fit =
        fit_bar(draw(paper_bar(), 10, 100 + seed), {.theory = WaveTheory::elementary});
    for (std::size_t i = 0; i < 3; ++i) {
      squares[i] += std::pow(fit.parameters[i].value / truth[i] - 1.0, 2) / kRepeats;
      // What is stated lies between the bound and 1.3 times it.
      EXPECT_GT(fit.parameters[i].sd / truth[i], 0.95 * bound[i]);
      EXPECT_LT(fit.parameters[i].sd / truth[i], 1.3 * bound[i]);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    // 100 repeats: the rms itself is known to 7 %.
    EXPECT_LT(std::sqrt(squares[i]), 1.3 * bound[i]) << i;
    RecordProperty("rms_over_bound_" + std::to_string(i),
                   std::to_string(std::sqrt(squares[i]) / bound[i]));
    std::printf("parameter %zu: rms %.5f %%, bound %.5f %%\n", i, 100.0 * std::sqrt(squares[i]),
                100.0 * bound[i]);
  }
}

void expect_to_cover(const BarShots::Recording& recording) {
  constexpr int kRepeats = 40;
  const RodMaterial& m = paper_bar().setup().material;
  const double truth[3] = {m.E1_Pa, m.E2_Pa, m.eta2_Pa_s};
  int inside = 0;
  int said_not_to_fit = 0;
  for (unsigned seed = 0; seed < kRepeats; ++seed) {
    const BarFit fit =
        fit_bar(draw(paper_bar(), 4, 300 + seed, recording), {.theory = WaveTheory::elementary});
    said_not_to_fit += fit.misfit ? 1 : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      inside += std::abs(fit.parameters[i].value - truth[i]) < 1.96 * fit.parameters[i].sd ? 1 : 0;
    }
  }
  // 120 intervals of 95 %: fewer than 105 inside would happen once in ten thousand.
  EXPECT_GE(inside, 105);
  // Once in a thousand each: three of forty would happen once in a hundred thousand times.
  EXPECT_LE(said_not_to_fit, 2);
}

TEST(FitBar, CoversWhatItStatesInAShortRun) {
  BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  for (const double correlation : {0.0, 0.99}) {
    SCOPED_TRACE(correlation);
    recording.noise_correlation = correlation;
    expect_to_cover(recording);
  }
  SCOPED_TRACE("pink");
  recording.colour = NoiseColour::pink;
  expect_to_cover(recording);
}

/// By the noise of a theory that carries less of it, an elastic bar looked lossy, 95 and more
/// ahead.
// A stiff bar that hardly loses anything rings for as long as is recorded. Each pulse that is
// unlike the others lets noise pull once more: eta2 came out more than a deviation low.
TEST(IdentifyBar, NoiseDoesNotPullAtTheLossOfABarThatRings) {
  BarShots::Setup setup;
  setup.material = {.density_kg_m3 = 1800.0, .E1_Pa = 43e9, .E2_Pa = 2.1e12, .eta2_Pa_s = 2.1e8};
  setup.position_m = {0.1, 0.5, 0.9, 1.3};
  setup.post_samples = 3696;
  std::vector<BarShots> pulses;
  for (const double pulse_s : {60e-6, 70e-6, 80e-6, 90e-6, 100e-6, 110e-6, 120e-6}) {
    setup.pulse_s = pulse_s;
    pulses.emplace_back(setup);
  }
  BarShots::Recording recording;
  recording.noise_rms = 16e-6;
  constexpr unsigned kSeeds = 16;
  double mean = 0.0;
  double squares = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::vector<Shot> shots;
    for (const BarShots& bar : pulses) {
      const auto seed_of_pulse = static_cast<unsigned>(100 * seed + shots.size());
      shots.push_back(draw(bar, 1, seed_of_pulse, recording).front());
    }
    const BarIdentification result = identify_bar(
        shots,
        {.theory = WaveTheory::elementary, .far_end = FarEndReturn::free, .compare_solids = false});
    const FittedNumber& eta2 = result.three_element.parameters[2];
    const double off = (eta2.value - setup.material.eta2_Pa_s) / eta2.sd;
    mean += off / kSeeds;
    squares += off * off / kSeeds;
  }
  std::printf("eta2 of a bar that rings: mean %.2f, mean square %.2f deviations\n", mean, squares);
  EXPECT_LT(std::abs(mean), 0.75);
  EXPECT_LT(squares, 2.0);
}

TEST(IdentifyBar, AnElasticBarInPinkNoiseIsNotLossy) {
  testing::CampaignWishes wishes{.seed = 6005,
                                 .shots = 2,
                                 .gauges = 2,
                                 .noise_strain = 50e-6,
                                 .colour = testing::NoiseColour::pink,
                                 .tolerances = testing::Tolerances::filed,
                                 .elastic = true};
  const BarIdentification result =
      identify_bar(testing::shots_of(testing::draw_campaign(wishes)), {});
  EXPECT_TRUE(result.three_element.lossless);
}

// What a few hundred quiet samples do not show of slow noise, the residuals do. The mean square of
// twenty deviations exceeds 2.27 by chance once in a thousand times.
TEST(IdentifyBar, DeviationsHoldInPinkNoise) {
  constexpr int kRepeats = 20;
  double squares = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    testing::CampaignWishes wishes{.seed = 9000U + static_cast<unsigned>(repeat),
                                   .shots = 4,
                                   .gauges = 4,
                                   .noise_strain = 4e-6,
                                   .colour = testing::NoiseColour::pink,
                                   .tolerances = testing::Tolerances::filed};
    const testing::Campaign made = testing::draw_campaign(wishes);
    const auto result = identify_bar(testing::shots_of(made), {.compare_solids = false});
    const FittedNumber& E2 = result.three_element.parameters[1];
    squares += std::pow((E2.value - made.world.material.E2_Pa) / E2.sd, 2);
  }
  std::printf("E2 in pink noise: mean square of deviations %.2f\n", squares / kRepeats);
  EXPECT_LT(squares / kRepeats, 2.27);
}

/// A bar whose creep is spread over many times, solved in the time domain with 14 of them.
std::vector<Shot> spread_creep(const std::string& effect) {
  testing::CampaignWishes wishes{.seed = 71, .noise_strain = 1e-6};
  testing::Campaign campaign = testing::draw_campaign(wishes);
  testing::plant(campaign.world, testing::parse_effect(effect));
  return testing::shots_of(campaign);
}

TEST(IdentifyBar, EachFurtherBranchComesNearerToASpreadSpectrum) {
  const std::vector<Shot> shots = spread_creep("fractional-damping=0.8");
  std::vector<double> chi2;
  for (const SolidKind solid :
       {SolidKind::three_element, SolidKind::two_kelvin, SolidKind::three_kelvin}) {
    const BarFit fit = identify_bar(shots, {.solid = solid, .compare_solids = false}).fit;
    EXPECT_EQ(fit.solid, solid);
    chi2.push_back(fit.chi2_reduced * static_cast<double>(fit.degrees_of_freedom));
    std::printf("%s: chi2 %.1f, reduced %.3f\n", name_of(solid).c_str(), chi2.back(),
                fit.chi2_reduced);
  }
  EXPECT_LT(chi2[1], chi2[0] - 20.0);
  EXPECT_LT(chi2[2], chi2[1] - 20.0);
}

TEST(IdentifyBar, TwoBranchesAreNotTakenForThree) {
  const std::vector<Shot> shots = spread_creep("second-relaxation=6e-12,tau=3e-4");
  const BarIdentification result = identify_bar(shots, {.solid = std::nullopt});
  EXPECT_EQ(result.fit.solid, SolidKind::two_kelvin);
  EXPECT_FALSE(says(result, "is ahead of the"));
  EXPECT_EQ(&fit_to_file(result), &result.fit);
  const BarIdentification three = identify_bar(shots, {});
  EXPECT_EQ(fit_to_file(three).solid, SolidKind::three_element);
  EXPECT_TRUE(says(three, "a two-kelvin solid is ahead of the three-element one"));
}

/// A bar of more than two branches is nearer to a fractional solid than to two: a third was not
/// even tried then, and E1 was 10 and 19 % off.
class ManyBranches : public ::testing::TestWithParam<std::pair<SolidKind, std::vector<double>>> {};

TEST_P(ManyBranches, AreFoundWhereAFractionalSolidIsNearerThanTwo) {
  const auto& [kind, times_s] = GetParam();
  constexpr double kBranch_Pa = 60e9;
  testing::Campaign made = testing::draw_campaign(
      {.seed = 91, .shots = 6, .gauges = 4, .noise_strain = 4e-6, .tolerances = {}});
  testing::TrueMaterial& bar = made.world.material;
  bar.E2_Pa = kBranch_Pa;
  bar.eta2_Pa_s = kBranch_Pa * times_s.front();
  for (const double time_s : times_s | std::views::drop(1)) {
    bar.further_branches.push_back({kBranch_Pa, kBranch_Pa * time_s});
  }
  testing::plant(made.world, testing::parse_effect("end-reflection=0"));
  const std::vector<Shot> shots = testing::shots_of(made);
  const BarIdentification result = identify_bar(shots, {.solid = std::nullopt});
  ASSERT_EQ(result.fit.solid, kind) << name_of(result.fit.solid);
  EXPECT_EQ(result.fit.far_end, FarEndReturn::free);
  EXPECT_LT(result.fit.chi2_reduced, 1.2);
  EXPECT_NEAR(result.fit.parameters[0].value, bar.E1_Pa, 4.0 * result.fit.parameters[0].sd);
  EXPECT_LT(result.fit.parameters[0].sd, 5e-3 * bar.E1_Pa);
  const auto evidence = [&](SolidKind solid) {
    const auto other = std::ranges::find_if(result.alternatives, [&](const Alternative& a) {
      return a.theory.solid == solid && a.failed.empty();
    });
    return other->log_evidence;
  };
  EXPECT_GT(evidence(SolidKind::fractional), evidence(SolidKind::two_kelvin));
  EXPECT_TRUE(says(identify_bar(shots, {}), "a " + name_of(kind) + " solid is ahead of the three"));
}

INSTANTIATE_TEST_SUITE_P(
    OfBars, ManyBranches,
    ::testing::Values(std::pair{SolidKind::three_kelvin, std::vector{10e-6, 70e-6, 400e-6}},
                      std::pair{SolidKind::four_kelvin, std::vector{4e-6, 20e-6, 100e-6, 500e-6}}));

/// Two branches, on a bar that ends.
testing::Campaign bar_of_two_branches(const std::string& end, unsigned seed) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = 6, .gauges = 4, .noise_strain = 3e-6, .tolerances = {}};
  testing::Campaign campaign = testing::draw_campaign(wishes);
  for (const std::string& effect : {std::string("second-relaxation=8e-12,tau=3e-4"), end}) {
    testing::plant(campaign.world, testing::parse_effect(effect));
  }
  return campaign;
}

/// Asked for three elements, which do not fit. An end that returns an unknown share took up a part
/// of what they lack: 12 bars of 12 were said not to end freely, and a third of the spectrum lay
/// within its deviations.
TEST(IdentifyBar, OfABarOfTwoBranchesEndAndSpectrumAreRightThoughThreeElementsAreAskedFor) {
  std::size_t inside = 0;
  std::size_t count = 0;
  for (const unsigned seed : {81U, 82U, 83U, 84U}) {
    const testing::Campaign made = bar_of_two_branches("end-reflection=0", seed);
    const BarIdentification result = identify_bar(testing::shots_of(made), {});
    EXPECT_EQ(result.fit.solid, SolidKind::three_element);
    EXPECT_EQ(result.fit.far_end, FarEndReturn::free) << seed;
    EXPECT_FALSE(says(result, "neither free nor silent")) << seed;
    const testing::TrueMaterial& m = made.world.material;
    const BarSpectrum& spectrum = result.spectrum;
    for (std::size_t k = 0; k < spectrum.frequency_Hz.size(); ++k) {
      if (spectrum.frequency_Hz[k] > 15e3) {
        break;
      }
      const Complex s(0.0, kTwoPi * spectrum.frequency_Hz[k]);
      const Complex J =
          1.0 / m.E1_Pa + 1.0 / (m.E2_Pa + s * m.eta2_Pa_s) + 8e-12 / (1.0 + 3e-4 * s);
      const double off = (spectrum.J2_per_Pa.mean[k] + J.imag()) / spectrum.J2_per_Pa.sd_of_mean[k];
      inside += std::abs(off) < 1.96 ? 1U : 0U;
      ++count;
    }
  }
  const double share = static_cast<double>(inside) / static_cast<double>(count);
  std::printf("J2 of two branches: %.0f %% of %zu inside\n", 100.0 * share, count);
  EXPECT_GE(share, 0.9);
}

TEST(IdentifyBar, AnEndThatReturnsAShareIsFoundOnABarOfTwoBranchesToo) {
  const testing::Campaign made = bar_of_two_branches("end-reflection=0.1", 81);
  const BarIdentification result = identify_bar(testing::shots_of(made), {.solid = std::nullopt});
  ASSERT_EQ(result.fit.far_end, FarEndReturn::partial);
  EXPECT_NEAR(result.fit.reflection->value, -0.9, 4.0 * result.fit.reflection->sd);
  EXPECT_LT(result.fit.reflection->sd, 0.02);
}

/// Of four that were compared: under other waves, without a fit, behind, and ahead by 40 and by 12.
TEST(BetterSolid, IsTheOneFurthestAheadUnderTheSameWaves) {
  BarIdentification result;
  result.three_element.log_evidence = -100.0;
  result.three_element.chi2_reduced = 3.0;
  const auto compare = [&](WaveTheory waves, SolidKind solid, double log_evidence, double chi2) {
    Alternative other;
    other.theory = {waves, solid, result.three_element.far_end};
    other.log_evidence = log_evidence;
    other.chi2_reduced = chi2;
    result.alternatives.push_back(other);
  };
  const WaveTheory same = result.three_element.theory;
  const WaveTheory another = same == WaveTheory::exact ? WaveTheory::love : WaveTheory::exact;
  compare(another, SolidKind::fractional, 0.0, 1.0);
  compare(same, SolidKind::three_kelvin, 0.0, 1.0);
  result.alternatives.back().failed = "does not converge";
  compare(same, SolidKind::four_element_fluid, -91.0, 2.9);
  EXPECT_FALSE(better_solid(result));
  compare(same, SolidKind::fractional, -60.0, 1.2);
  compare(same, SolidKind::two_kelvin, -88.0, 2.8);
  const auto better = better_solid(result);
  ASSERT_TRUE(better);
  EXPECT_EQ(better->solid, SolidKind::fractional);
  EXPECT_EQ(better->log_evidence_ahead, 40.0);
  const std::string cost = cost_of_filing(result.three_element, *better);
  EXPECT_NE(cost.find("a fractional solid is ahead of the three-element one"), std::string::npos)
      << cost;
  EXPECT_NE(cost.find("by a log evidence of 40: that leaves a reduced chi2 of 3, it 1.2; --solid "
                      "fractional files it"),
            std::string::npos)
      << cost;
  // Asked for by name, two branches are filed, and another is ahead of these.
  result.fit.solid = SolidKind::two_kelvin;
  result.fit.theory = result.three_element.theory;
  result.fit.far_end = result.three_element.far_end;
  result.fit.log_evidence = -88.0;
  EXPECT_EQ(better_solid(result)->log_evidence_ahead, 28.0);
  result.fit.solid = SolidKind::fractional;
  result.fit.log_evidence = -60.0;
  EXPECT_FALSE(better_solid(result));
}

/// Each is what makes the records, and has two numbers fewer than two Kelvin branches or none more.
TEST(IdentifyBar, AFluidAndAFractionalSolidWinWhereTheyAreTrue) {
  EXPECT_EQ(identify_bar(spread_creep("series-dashpot=5e-9"), {.solid = std::nullopt}).fit.solid,
            SolidKind::four_element_fluid);
  EXPECT_EQ(identify_bar(spread_creep("fractional-damping=0.8"), {.solid = std::nullopt}).fit.solid,
            SolidKind::fractional);
}

/// What gauge 0 foretells for the others (Fig. 21) is off by the noise of both, low-passed.
TEST(Foretell, LeavesNoise) {
  constexpr double kNoise = 4e-6;
  const auto shots = draw(paper_bar(), 3, 9);
  const BarIdentification result = identify_bar(shots, {.compare_solids = false});
  const std::vector<ForetoldShot> foretold = foretell(shots, result.fit);
  ASSERT_EQ(foretold.size(), shots.size());
  const double share = std::sqrt(result.fit.band_limit_Hz / 0.5e6);
  for (const ForetoldShot& shot : foretold) {
    ASSERT_EQ(shot.gauges.size(), 3U);
    for (const ForetoldGauge& gauge : shot.gauges) {
      double squares = 0.0;
      for (std::size_t n = 0; n < gauge.measured.size(); ++n) {
        squares += std::pow(gauge.measured[n] - gauge.foretold[n], 2);
      }
      const double rms = std::sqrt(squares / static_cast<double>(gauge.measured.size()));
      std::printf("%s %s: residual %.2f microstrain, noise in the band %.2f\n", shot.id.c_str(),
                  gauge.name.c_str(), 1e6 * rms, 1e6 * kNoise * share);
      // Its own, and gauge 0's carried there and back from the end, hardly less.
      EXPECT_GT(rms, kNoise * share);
      EXPECT_LT(rms, 2.5 * kNoise * share);
    }
  }
}

/// Two loud shots of a bar from whose end nothing comes back. Where that end was sought only from
/// where a free one had led, it was left thousands behind one that returned 0.2 %.
TEST(IdentifyBar, AWrongFarEndDoesNotLeadAstray) {
  for (const auto& [seed, noise_strain] : {std::pair{374943U, 50e-6}, {370001U, 30e-6}}) {
    testing::CampaignWishes wishes{.seed = seed,
                                   .shots = 2,
                                   .gauges = 2,
                                   .noise_strain = noise_strain,
                                   .tolerances = testing::Tolerances::filed};
    const BarIdentification result =
        identify_bar(testing::shots_of(testing::draw_campaign(wishes)), {});
    EXPECT_EQ(result.fit.far_end, FarEndReturn::none) << seed;
    EXPECT_LT(result.fit.chi2_reduced, 1.1) << seed;
  }
}

}  // namespace
}  // namespace kolsky
