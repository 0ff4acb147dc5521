#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "drivers/simulated/rod.hpp"
#include "processing/identification/bar_spectrum.hpp"

namespace kolsky::testing {

/// How often the J1 and J2 of identified spectra lie within what is stated of their means.
class SpectrumCoverage {
 public:
  /// @param truth  three elements
  void take(const BarSpectrum& spectrum, const RodMaterial& truth, double up_to_Hz) {
    for (std::size_t k = 0; k < spectrum.frequency_Hz.size(); ++k) {
      if (spectrum.frequency_Hz[k] > up_to_Hz) {
        break;
      }
      const double wt =
          2.0 * std::numbers::pi * spectrum.frequency_Hz[k] * truth.eta2_Pa_s / truth.E2_Pa;
      const double late = 1.0 / (truth.E2_Pa * (1.0 + wt * wt));
      take(spectrum.J1_per_Pa, k, 1.0 / truth.E1_Pa + late);
      take(spectrum.J2_per_Pa, k, wt * late);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double inside_share() const {
    return static_cast<double>(inside_) / static_cast<double>(count_);
  }
  /// Of distances from the truth in stated deviations.
  [[nodiscard]] double mean_square() const { return squares_ / static_cast<double>(count_); }

 private:
  void take(const SpectrumLine& line, std::size_t k, double truth) {
    constexpr double kInside = 1.959964;  // 95 %
    const double off = (line.mean[k] - truth) / line.sd_of_mean[k];
    inside_ += std::abs(off) < kInside ? 1U : 0U;
    squares_ += off * off;
    ++count_;
  }

  std::size_t count_ = 0;
  std::size_t inside_ = 0;
  double squares_ = 0.0;
};

}  // namespace kolsky::testing
