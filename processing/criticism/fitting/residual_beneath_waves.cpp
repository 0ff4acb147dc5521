#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/residual_workspace.hpp"
#include "processing/criticism/fitting/residuals.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

struct Squares {
  double sum = 0.0;
  double samples = 0.0;

  void add(double value) {
    sum += value * value;
    samples += 1.0;
  }
  [[nodiscard]] double mean() const { return sum / samples; }
};

/// What of a record is more than this is a wave that passes.
double least_wave(const std::vector<double>& record, double noise_sd) {
  constexpr double kShareOfPeak = 0.05;
  constexpr double kNoise = 3.0;
  double peak = 0.0;
  for (const double value : record) {
    peak = std::max(peak, std::abs(value));
  }
  return std::max(kShareOfPeak * peak, kNoise * noise_sd);
}

}  // namespace

WhiteResiduals::AroundWaves WhiteResiduals::around_waves() const {
  Squares beneath;
  Squares between;
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    std::vector<Spectrum> deviations = deviation_spectra(white_of(n, frozen_));
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      for (std::size_t k = 0; k < band_.bins_judged; ++k) {
        const double sd = shares_.spread(k).row(static_cast<Eigen::Index>(j)).norm();
        deviations[j][k + 1] = sd > 0.0 ? deviations[j][k + 1] / sd : Complex(0.0);
      }
      const std::vector<double> series = work_.front()->transforms.window_with(deviations[j]);
      const std::vector<double>& record = judged_record(n, j);
      const double least = least_wave(record, std::sqrt(noise_.quiet_power(j)));
      for (std::size_t t = 0; t < record.size(); ++t) {
        (std::abs(record[t]) > least ? beneath : between).add(series[t]);
      }
    }
  }
  if (beneath.samples == 0.0 || between.samples == 0.0) {
    return {};
  }
  const double freedom_of_sample =
      static_cast<double>(frozen_.size()) / (beneath.samples + between.samples);
  // Bins of two unit deviates each, either side of frequency zero.
  const double of_noise =
      4.0 * static_cast<double>(band_.bins_judged) / std::pow(static_cast<double>(band_.judged), 2);
  const double freedom = between.samples * freedom_of_sample;
  return {log_f_tail(beneath.mean() / between.mean(), beneath.samples * freedom_of_sample, freedom),
          between.mean() / of_noise, std::sqrt(2.0 / freedom)};
}

void WhiteResiduals::keep_what_is_between_waves(const Composition& composition,
                                                const std::vector<double>& theta) {
  constexpr double kDeviations = 2.0;
  constexpr int kSteps = 6;
  const GaugeNoise::Scales learned = noise_.scales();
  const auto leaves_too_little = [&](double share) {
    noise_.scale_by(learned, share);
    forget_whitener();
    freeze(composition, theta);
    const AroundWaves around = around_waves();
    return around.between < 1.0 - kDeviations * around.between_sd;
  };
  if (!leaves_too_little(1.0)) {
    return;
  }
  double most = 0.0;
  double beyond = 1.0;
  for (int step = 0; step < kSteps; ++step) {
    const double middle = 0.5 * (most + beyond);
    (leaves_too_little(middle) ? beyond : most) = middle;
  }
  noise_.scale_by(learned, most);
  forget_whitener();
  freeze(composition, theta);
}

}  // namespace kolsky
