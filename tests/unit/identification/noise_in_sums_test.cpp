// What noise makes of sums over judged residuals, against the scatter of records that were drawn.
#include "processing/identification/noise_in_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "processing/identification/bar_judge.hpp"
#include "processing/identification/bar_model.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/table4.hpp"

namespace kolsky {
namespace {

using testing::BarShots;

constexpr std::size_t kShots = 800;
constexpr double kBand_Hz = 40e3;
constexpr Eigen::Index kSums = 9;

BarShots::Setup two_gauges() {
  BarShots::Setup setup;
  setup.material = testing::kTable4[2].material;
  setup.position_m = {0.2, 0.7};
  setup.length_m = 1.2;
  setup.post_samples = 2600;
  return setup;
}

/// Sums over bins that the far end ties to each other, each with another turn from bin to bin, and
/// over one bin alone.
Eigen::MatrixXcd weights_of(Eigen::Index bins) {
  Eigen::MatrixXcd weights = Eigen::MatrixXcd::Zero(bins, kSums);
  for (Eigen::Index s = 0; s + 1 < kSums; ++s) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(s) / (kSums - 1.0);
    for (Eigen::Index k = 20; k < 60; ++k) {
      weights(k, s) = std::polar(1.0, turn * static_cast<double>(k));
    }
  }
  weights(5, kSums - 1) = 1.0;
  return weights;
}

struct Carried {
  Eigen::MatrixXd foretold;
  Eigen::MatrixXd seen;
  Eigen::VectorXd bin_by_bin;  ///< the foretold variances without what ties the bins
};

Carried carried(double noise_correlation) {
  const BarShots generator(two_gauges());
  std::mt19937_64 random(5);
  const BarShots::Recording noisy{.noise_correlation = noise_correlation, .bits = 24};
  const BarShots::Recording still{.noise_rms = 1e-9, .bits = 24};
  const BarData data(generator.draw(kShots, noisy, random), kBand_Hz);
  const BarData truth(generator.draw(kShots, still, random), kBand_Hz);
  const BarModel model(data.bench(), data.records().front(),
                       {WaveTheory::elementary, SolidKind::three_element, FarEndReturn::free});
  const RodMaterial& bar = two_gauges().material;
  const std::vector<double> at = {std::log(bar.E1_Pa), std::log(bar.E2_Pa),
                                  std::log(bar.eta2_Pa_s)};
  const BarData::Spectrum g = model.transfers(at, data.path(), false).g.front();
  BarJudge judge(data);
  BarData::Spectrum product(g.size());
  for (std::size_t k = 0; k < g.size(); ++k) {
    product[k] = g[k] * data.unit_impulse()[k];
  }
  const auto in_time = [&](const BarData::Spectrum& spectrum) {
    const auto record = judge.in_time(spectrum);
    return std::vector<double>(record.begin(), record.end());
  };
  NoiseInSums noise(data, data.noise(), {in_time(product)}, in_time(data.unit_impulse()));
  const auto bins = static_cast<Eigen::Index>(data.judged_path().size());
  const Eigen::MatrixXcd weights = weights_of(bins);
  Carried carried{noise.covariance({weights}), Eigen::MatrixXd::Zero(kSums, kSums),
                  Eigen::VectorXd::Zero(kSums)};
  for (Eigen::Index k = 0; k < bins; ++k) {
    const Eigen::RowVectorXcd one = weights.row(k);
    for (Eigen::Index s = 0; s < kSums; ++s) {
      if (std::abs(one[s]) > 0.0) {
        Eigen::MatrixXcd alone = Eigen::MatrixXcd::Zero(bins, 1);
        alone(k, 0) = one[s];
        carried.bin_by_bin[s] += noise.covariance({alone})(0, 0);
      }
    }
  }
  BarData::Spectrum of_first(g.size());
  BarData::Spectrum shown(data.judged_path().size());
  for (std::size_t shot = 0; shot < kShots; ++shot) {
    for (std::size_t k = 0; k < g.size(); ++k) {
      of_first[k] = data.spectrum(shot, 0)[k] - truth.spectrum(shot, 0)[k];
    }
    judge.judge_product(g, of_first, shown);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(kSums);
    for (Eigen::Index k = 0; k < bins; ++k) {
      const auto bin = static_cast<std::size_t>(k);
      const Complex residual = data.judged(shot, 1)[bin] - truth.judged(shot, 1)[bin] - shown[bin];
      sums += (weights.row(k).adjoint() * residual).real();
    }
    carried.seen += sums * sums.transpose() / static_cast<double>(kShots);
  }
  return carried;
}

TEST(NoiseInSums, ForetellsHowSumsScatterInRecords) {
  // A variance of so many shots is known to sqrt(2 / shots).
  const double allowed = 4.0 * std::sqrt(2.0 / static_cast<double>(kShots));
  for (const double correlation : {0.0, 0.95}) {
    const Carried sums = carried(correlation);
    for (Eigen::Index a = 0; a < kSums; ++a) {
      for (Eigen::Index b = 0; b < kSums; ++b) {
        const double scale = std::sqrt(sums.foretold(a, a) * sums.foretold(b, b));
        EXPECT_NEAR(sums.seen(a, b) / scale, sums.foretold(a, b) / scale, allowed)
            << correlation << ": " << a << " " << b;
      }
    }
    // What ties the bins is no small matter, so that this could fail.
    const Eigen::ArrayXd over = sums.foretold.diagonal().array() / sums.bin_by_bin.array();
    EXPECT_GT((over - 1.0).abs().maxCoeff(), 1.1 * allowed);
    EXPECT_NEAR(over[kSums - 1], 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace kolsky
