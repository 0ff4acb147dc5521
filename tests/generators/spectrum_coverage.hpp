#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "drivers/simulated/rod.hpp"
#include "processing/identification/bar_spectrum.hpp"
#include "processing/specimen/specimen_fit.hpp"

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
      const Truth J(truth, spectrum.frequency_Hz[k]);
      take(spectrum.J1_per_Pa.mean[k], spectrum.J1_per_Pa.sd_of_mean[k], J.J1_per_Pa);
      take(spectrum.J2_per_Pa.mean[k], spectrum.J2_per_Pa.sd_of_mean[k], J.J2_per_Pa);
    }
  }
  void take(const std::vector<CompliancePoint>& spectrum, const RodMaterial& truth,
            double up_to_Hz) {
    for (const CompliancePoint& point : spectrum) {
      if (point.frequency_Hz > up_to_Hz) {
        break;
      }
      const Truth J(truth, point.frequency_Hz);
      take(point.J1_per_Pa, point.J1_sd_of_mean, J.J1_per_Pa);
      take(point.J2_per_Pa, point.J2_sd_of_mean, J.J2_per_Pa);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double inside_share() const {
    return static_cast<double>(inside_) / static_cast<double>(count_);
  }
  /// Of distances from the truth in stated deviations.
  [[nodiscard]] double mean_square() const { return squares_ / static_cast<double>(count_); }

 private:
  struct Truth {
    double J1_per_Pa;
    double J2_per_Pa;

    Truth(const RodMaterial& solid, double frequency_Hz) {
      const double wt = 2.0 * std::numbers::pi * frequency_Hz * solid.eta2_Pa_s / solid.E2_Pa;
      const double late = 1.0 / (solid.E2_Pa * (1.0 + wt * wt));
      J1_per_Pa = 1.0 / solid.E1_Pa + late;
      J2_per_Pa = wt * late;
    }
  };

  void take(double mean, double sd, double truth) {
    constexpr double kInside = 1.959964;  // 95 %
    const double off = (mean - truth) / sd;
    inside_ += std::abs(off) < kInside ? 1U : 0U;
    squares_ += off * off;
    ++count_;
  }

  std::size_t count_ = 0;
  std::size_t inside_ = 0;
  double squares_ = 0.0;
};

}  // namespace kolsky::testing
