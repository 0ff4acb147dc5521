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

double WhiteResiduals::log_p_of_more_where_waves_pass(const Eigen::VectorXd& white) const {
  Squares beneath_waves;
  Squares between;
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    std::vector<Spectrum> deviations = deviation_spectra(white_of(n, white));
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      for (std::size_t k = 0; k < band_.bins_judged; ++k) {
        const double sd = shares_.spread(k).row(static_cast<Eigen::Index>(j)).norm();
        deviations[j][k + 1] = sd > 0.0 ? deviations[j][k + 1] / sd : Complex(0.0);
      }
      const std::vector<double> series = work_.front()->transforms.window_with(deviations[j]);
      const std::vector<double>& record = judged_record(n, j);
      const double least = least_wave(record, std::sqrt(noise_.quiet_power(j)));
      for (std::size_t t = 0; t < record.size(); ++t) {
        (std::abs(record[t]) > least ? beneath_waves : between).add(series[t]);
      }
    }
  }
  if (beneath_waves.samples == 0.0 || between.samples == 0.0) {
    return 0.0;
  }
  const double freedom_of_sample =
      static_cast<double>(white.size()) / (beneath_waves.samples + between.samples);
  return log_f_tail(beneath_waves.mean() / between.mean(),
                    beneath_waves.samples * freedom_of_sample, between.samples * freedom_of_sample);
}

}  // namespace kolsky
