// What is not known of a bar of two branches, carried from its own shots to a specimen's numbers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "processing/identification/bar_identification.hpp"
#include "processing/specimen/specimen_fit.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/linear_shpb.hpp"

namespace kolsky {
namespace {

const RodMaterial kBar{1180.0, 5.66e9, 37.0e9, 1.81e6, {{6e-12, 3e-4}}};

/// As `identify bar --solid two-kelvin --model-out` files it, from two noisy shots.
Material identified_bar(const testing::BarShots& bar, std::mt19937_64& random) {
  testing::BarShots::Recording recording;
  recording.noise_rms = 30e-6;
  const BarFit fit = identify_bar(bar.draw(2, recording, random), {.theory = WaveTheory::elementary,
                                                                   .solid = SolidKind::two_kelvin,
                                                                   .far_end = FarEndReturn::free})
                         .fit;
  Material material = paper_pmma();
  material.solid = fit.solid;
  material.parameters = measured_of(fit.parameters);
  material.covariance = row_by_row(fit.covariance);
  material.identified = Material::Identified{fit.band_limit_Hz, std::nullopt};
  return material;
}

class Inside {
 public:
  void take(double deviations) {
    ++count_;
    inside_ += std::abs(deviations) < 1.96 ? 1 : 0;
    squares_ += deviations * deviations;
  }
  [[nodiscard]] double mean_square() const { return squares_ / count_; }
  [[nodiscard]] double share() const { return static_cast<double>(inside_) / count_; }

 private:
  int count_ = 0;
  int inside_ = 0;
  double squares_ = 0.0;
};

/// Of the bar's J at frequencies through its file's covariance, and of a specimen between such bars
/// with and without it. What the bar leaves open is alike in a repeat's numbers: few of them are
/// independent.
TEST(CarriedCovariance, OfTwoBranchesHoldsTheTruthAsOftenAsItSays) {
  constexpr int kRepeats = 40;
  const testing::BarShots bar({.material = kBar});
  testing::LinearShpb model;
  model.input = model.output = kBar;
  const auto records = model.solve();
  const std::array truth{model.specimen.E1_Pa, model.specimen.E2_Pa, model.specimen.eta2_Pa_s};
  SpecimenFitOptions massless;
  massless.bars = WaveTheory::elementary;
  massless.specimen = SpecimenWaves::massless;
  std::mt19937_64 random(31);
  Inside of_bar, of_specimen, as_exact;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const Material filed = identified_bar(bar, random);
    const BarPrior prior(filed);
    const Eigen::MatrixXd directions = moduli_directions(model.bench(), prior);
    for (const double frequency_Hz : {1e3, 4e3, 12e3}) {
      const Complex s(0.0, 2.0 * std::numbers::pi * frequency_Hz);
      const Complex J = compliance_of(filed)->at(s);
      const Complex off =
          J - 1.0 / kBar.E1_Pa - 1.0 / (kBar.E2_Pa + s * kBar.eta2_Pa_s) - 6e-12 / (1.0 + 3e-4 * s);
      std::array<double, 2> variance{};
      for (Eigen::Index i = 0; i < directions.cols(); ++i) {
        Material moved = filed;
        move_parameters(moved, 1e-3 * directions.col(i));
        const Complex by = 1e3 * (compliance_of(moved)->at(s) - J);
        variance[0] += by.real() * by.real();
        variance[1] += by.imag() * by.imag();
      }
      of_bar.take(off.real() / std::sqrt(variance[0]));
      of_bar.take(off.imag() / std::sqrt(variance[1]));
    }
    std::vector<Shot> shots;
    for (int i = 0; i < 4; ++i) {
      shots.push_back(testing::digitise(model.bench(), records, 1e-6, 16, 0.005,
                                        static_cast<unsigned>(random())));
    }
    Material exact = filed;
    exact.covariance.emplace(filed.covariance->size(), 0.0);
    const SpecimenFit fit = fit_specimen(shots, prior, massless);
    const SpecimenFit held = fit_specimen(shots, BarPrior(exact), massless);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      of_specimen.take((fit.parameters[i].value - truth[i]) / fit.parameters[i].sd);
      as_exact.take((held.parameters[i].value - truth[i]) / held.parameters[i].sd);
    }
  }
  std::printf(
      "bar's J: %.1f %% inside, mean square %.2f; specimen: %.1f %%, %.2f; bar held exact: "
      "%.1f %%, %.2f\n",
      100.0 * of_bar.share(), of_bar.mean_square(), 100.0 * of_specimen.share(),
      of_specimen.mean_square(), 100.0 * as_exact.share(), as_exact.mean_square());
  EXPECT_GE(of_bar.share(), 0.90);
  EXPECT_GE(of_specimen.share(), 0.88);
  EXPECT_GT(of_specimen.mean_square(), 0.5);
  EXPECT_LT(of_specimen.mean_square(), 1.6);
  EXPECT_GT(as_exact.mean_square(), 2.0);
}

}  // namespace
}  // namespace kolsky
