#pragma once

#include <cstddef>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/time.hpp"
#include "processing/reduction/stations.hpp"
#include "processing/waves/band_limit.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// What decides the plans.
struct BallPlanKey {
  std::size_t samples = 0;
  SampleRate rate;
  std::size_t delay = 0;
  std::size_t longest_pulse = 0;
  bool operator==(const BallPlanKey&) const = default;
};

/// Transforms and work space for shots of one length.
struct BallPlans {
  BallPlanKey key;
  DampedTransform transform;
  BandLimit band;
  std::vector<Complex> path;
  std::vector<Complex> spectrum;

  explicit BallPlans(const BallPlanKey& k);
};

/// What turns strain at each station into the force on the face, late by the plans' delay.
struct BallKernels {
  std::vector<double> numbers;
  BallPlanKey key;
  std::vector<std::vector<Complex>> force_of_strain;  ///< by station
  double blind_from_Hz = 0.0;                         ///< where the bar's gauges go blind

  [[nodiscard]] std::size_t bins() const {
    return force_of_strain.empty() ? 0 : force_of_strain.front().size();
  }
};

/// What decides the kernels: two shots that agree in it share them.
[[nodiscard]] std::vector<double> ball_kernel_numbers(const Bar& bar, WaveTheory theory,
                                                      const std::vector<BarStation>& stations);

/// Makes the kernels of at least so many bins.
void reach(BallKernels& kernels, const BallPlans& plans, const Bar& bar, WaveTheory theory,
           const std::vector<BarStation>& stations, std::size_t bins);

}  // namespace kolsky
