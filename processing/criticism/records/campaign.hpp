#pragma once

#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {

/// One shot as the comparison sees it: strain at every gauge of the bench, compression positive,
/// less its baseline.
struct CampaignShot {
  std::string id;
  std::vector<std::vector<double>> strain;  ///< by gauge
  std::size_t quiet_samples = 0;            ///< before the pulse
  double foot_s = 0.0;                      ///< of the pulse at the reference gauge
  ShotFacts facts;
};

/// Shots on one bench, ready to be compared with a model of it.
struct Campaign {
  Bench bench;
  double period_s = 0.0;
  std::size_t reference =
      0;  ///< the gauge that stands for each shot's source: the first in a wave's way
  std::vector<CampaignShot> shots;
  std::vector<double> step;  ///< strain from one code to the next, by gauge; 0: finer than noise

  [[nodiscard]] std::size_t gauges() const { return bench.gauges.size(); }
};

/// Whether a gauge's record has a pulse that stands out of its noise: sample by sample at the first
/// gauge, where it has to be found, on average at the others.
[[nodiscard]] bool holds_pulse(const Shot& shot, std::size_t gauge);

/// Why a shot cannot be compared with anything, in one line; empty for one that can. Holes,
/// clipping, no pulse, no quiet samples before it: bad data is a verdict of its own.
[[nodiscard]] std::string bad_data(const Shot& shot);

/// @throws InputError where shots are of different benches or rates, too few gauges, or bad_data
[[nodiscard]] Campaign read_campaign(const std::vector<Shot>& shots);

}  // namespace kolsky
