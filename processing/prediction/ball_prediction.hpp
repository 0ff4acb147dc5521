#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/impact/bench_impact.hpp"

namespace kolsky {

/// A material as an identification left it.
struct MaterialPosterior {
  Material material;
  std::array<std::array<double, 3>, 3> covariance{};  ///< of E1_Pa, E2_Pa, eta2_Pa_s
};

/// Core and cover together.
struct BallPosterior {
  MaterialPosterior core;
  MaterialPosterior cover;
  /// Covariance of the core's numbers (rows) with the cover's: what both owe to the same bars.
  std::array<std::array<double, 3>, 3> between{};
};

/// An impact that is to be foretold, and how its measurement reads a force.
struct ForetoldSpeed {
  Measured speed_m_per_s;
  double low_pass_Hz = 0.0;
  double contact_threshold = 0.01;
};

struct PredictionOptions {
  impact::Reading reading = impact::Reading::full;
  impact::FiniteStrain law = impact::FiniteStrain::kirchhoff;
  double friction = 0.3;
  std::size_t draws = 32;
  std::size_t elements = 512;        ///< of the draws
  std::size_t fine_elements = 2048;  ///< of the run with the materials' own values
  unsigned seed = 1;
};

/// A foretold number: value from the fine mesh, sd from the draws (materials, incident speed, filed
/// mass apart), and what the draws' coarser mesh moves it by.
struct Foretold {
  double value = 0.0;
  double sd = 0.0;
  double mesh = 0.0;
};

struct BallPrediction {
  ForetoldSpeed asked;
  Foretold peak_force_N;
  Foretold contact_time_s;
  Foretold impulse_N_s;
  Foretold restitution;         ///< by the centre of mass
  std::vector<double> time_s;   ///< from first touch as a measurement would find it
  std::vector<double> force_N;  ///< low-passed as the measurement
  std::vector<double> force_sd_N;
  double strained_share = 0.0;  ///< of the core's volume: beyond a strain of 0.1
  std::size_t failed = 0;       ///< draws that no ball survives
};

/// Carries two specimens' joint posterior through the finite elements: draws of log moduli with the
/// filed covariances, the same ones at every speed, and of the speed.
/// @param progress  from any thread, after each impact: how many are done, of how many
/// @throws InputError as impact_on; where fewer than two draws come through
[[nodiscard]] std::vector<BallPrediction> foretell_impacts(
    const Bench& bench, const BallPosterior& ball, const std::vector<ForetoldSpeed>& speeds,
    const PredictionOptions& options, const Workers& workers,
    const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace kolsky
