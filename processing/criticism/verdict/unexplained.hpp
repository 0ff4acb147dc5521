#pragma once

#include "processing/criticism/verdict/single_shots.hpp"

namespace kolsky {

/// What smooth distortions of every gauge, and of a specimen's law, still find in a model's
/// residuals.
struct Unexplained {
  double log_p = 0.0;         ///< ln of the chance that noise alone leaves as much
  double common_log_p = 0.0;  ///< the same of all but what sets shots apart
  double excess = 0.0;        ///< chi2 beyond what noise leaves
  ShotsApart apart{};
};

/// Distortions by frequency, amplitude and shot (distortion.hpp), by time (wander.hpp) and of the
/// specimen's law (departure.hpp), clear of the model's own numbers: all of them together, and each
/// kind at each gauge by itself, as what is missing acts at one place and is easily lost among all
/// directions; and all that is left, of whatever shape. With two shots or more the noise in their
/// directions is taken from what differs between the shots there, which slow noise raises above its
/// spectrum; of one shot it is known by the quiet before its pulse alone, which is hardly at all.
[[nodiscard]] Unexplained unexplained(Study& study, const Studied& studied);

}  // namespace kolsky
