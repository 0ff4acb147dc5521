#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "clients/figure/figure.hpp"
#include "clients/terminal/terminal.hpp"
#include "processing/identification/bar_identification.hpp"
#include "processing/prediction/ball_prediction.hpp"
#include "processing/reduction/ball/ball_repeats.hpp"
#include "processing/specimen/specimen_fit.hpp"

namespace kolsky::cli {

/// A measured number beside what was foretold.
struct Compared {
  Measured measured;  ///< sd: of a single shot or of the mean, whichever is more
  Foretold foretold;
  [[nodiscard]] double sd() const;  ///< of both and the mesh
  [[nodiscard]] double z() const { return (measured.value - foretold.value) / sd(); }
};

/// One speed: what was measured at it and what the specimens foretell.
struct ChainSpeed {
  BallRepeats measured;
  BallPrediction foretold;
  std::optional<Compared> peak_force_N;
  std::optional<Compared> contact_time_s;
  std::optional<Compared> impulse_N_s;
  std::optional<Compared> restitution_by_speed;
  std::optional<Compared> restitution_by_impulse;
  std::vector<double>
      force_N;  ///< mean of the shots, at the foretold times; NaN beyond the shortest
  double force_rms_share = 0.0;  ///< rms of measured less foretold over the contact, of the peak
  double force_sd_share = 0.0;   ///< rms of what is foretold to be uncertain there

  /// The compared number that is furthest off, in deviations; nothing where none is compared.
  struct Furthest {
    const char* name = "";
    double z = 0.0;
  };
  [[nodiscard]] std::optional<Furthest> furthest() const;
};

/// Of the numbers of a chain, some fifteen, one is further off than this by chance once in a
/// thousand chains.
constexpr double kFarOff = 4.0;

/// The chain from bar to ball.
struct ChainRun {
  std::optional<BarIdentification> bar;  ///< where its shots were given
  std::string bars;                      ///< what the specimens' bars were taken to be
  SpecimenFit core;
  SpecimenFit cover;
  /// Covariance of the core's numbers with the cover's.
  std::array<std::array<double, 3>, 3> between{};
  PredictionOptions options;
  std::vector<BallImpact> impacts;
  std::vector<ChainSpeed> speeds;
  std::vector<std::string> remarks;
};

[[nodiscard]] JsonValue describe(const ChainRun& run);
[[nodiscard]] std::string report(const ChainRun& run, const Terminal& terminal);
/// A panel a speed: measured, foretold and its band of two deviations.
[[nodiscard]] Figure chain_figure(const ChainRun& run);

}  // namespace kolsky::cli
