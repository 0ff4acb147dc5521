#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/noise/smooth_power.hpp"

namespace kolsky {

/// What slow noise of one gauge each makes of a shot's whitened residuals: waves of a few
/// frequencies, closer than the bins, so that what is slower than the window is there too, carried
/// through baseline, model and window as records are.
struct SlowWaves {
  double bin_width_Hz = 0.0;
  std::vector<double> frequency;                 ///< in judged bins
  std::vector<std::vector<Eigen::MatrixXd>> at;  ///< by gauge and frequency, cosine and sine part
};

/// @param base  fitted, its noise known by its residuals
[[nodiscard]] SlowWaves slow_waves(const Studied& base, Study& study);

/// One of them as a record, less its mean before the pulse. @param part  0: cosine, 1: sine
[[nodiscard]] std::vector<double> wave_of(const SlowWaves& waves, const CampaignShot& shot,
                                          std::size_t frequency, int part);

/// Spectra of the gauges as they are known, as white noise and the rest, for waves of one bin.
[[nodiscard]] std::vector<SmoothPower> spectra_of_waves(const WhiteResiduals& residuals);

/// All but the white.
[[nodiscard]] inline double slow_power(const SmoothPower& power, double f) {
  return power.at(f) - power.white;
}

/// Parts that noise is made of, each with an amplitude of unit variance: times its transpose they
/// are its covariance. Here of noise that gauges have of their own.
/// @param power  by gauge and frequency
template <class Power>
[[nodiscard]] Eigen::MatrixXd parts_of_own(const SlowWaves& waves, const Power& power) {
  const double step = waves.frequency.front();
  const auto count = static_cast<Eigen::Index>(waves.at.size() * waves.frequency.size());
  Eigen::MatrixXd parts(waves.at.front().front().rows(), 2 * count);
  Eigen::Index first = 0;
  for (std::size_t j = 0; j < waves.at.size(); ++j) {
    for (std::size_t q = 0; q < waves.frequency.size(); ++q) {
      parts.middleCols(first, 2) = std::sqrt(step * power(j, waves.frequency[q])) * waves.at[j][q];
      first += 2;
    }
  }
  return parts;
}

/// The same where all gauges have the same noise, each as much of it as its power says.
template <class Power>
[[nodiscard]] Eigen::MatrixXd parts_in_common(const SlowWaves& waves, const Power& power) {
  const double step = waves.frequency.front();
  const auto count = static_cast<Eigen::Index>(waves.frequency.size());
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(waves.at.front().front().rows(), 2 * count);
  for (std::size_t q = 0; q < waves.frequency.size(); ++q) {
    for (std::size_t j = 0; j < waves.at.size(); ++j) {
      parts.middleCols(2 * static_cast<Eigen::Index>(q), 2) +=
          std::sqrt(step * power(j, waves.frequency[q])) * waves.at[j][q];
    }
  }
  return parts;
}

}  // namespace kolsky
