#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/band_transforms.hpp"
#include "processing/criticism/fitting/composition.hpp"
#include "processing/criticism/fitting/known_departures.hpp"
#include "processing/criticism/fitting/residuals.hpp"
#include "processing/criticism/noise/whitener.hpp"
#include "processing/criticism/noise/window_jumps.hpp"

namespace kolsky {

/// One shot's effects: those on waves and those on what was made of their strain.
struct StagedEffects {
  std::vector<AppliedEffect> on_waves;
  std::vector<AppliedEffect> on_records;

  StagedEffects(const Composition& composition, const std::vector<double>& theta,
                std::size_t shot) {
    for (AppliedEffect& effect : composition.applied(theta, shot)) {
      auto& list = effect.effect->about().stage == Stage::record ? on_records : on_waves;
      list.push_back(std::move(effect));
    }
  }
};

/// One worker's, within `WhiteResiduals`.
struct WhiteResiduals::Workspace {
  BandTransforms transforms;
  std::vector<double> shaped;
  std::vector<Spectrum> records;    ///< of one shot where effects change them
  std::vector<Spectrum> residuals;  ///< one shot's, at the carried bins, by other gauge
  std::vector<Spectrum> rows;       ///< the same, at the judged bins
  SpecimenResponse response;
  KnownDepartures departures;

  // Much of a fit moves what is added to records alone: how waves travel then stays as it was in
  // the evaluation before.
  std::vector<AppliedEffect> on_waves;  ///< that made scene and ratios, for a shot
  std::optional<std::size_t> shot;
  std::optional<Scene> scene;
  Ratios ratios;
  std::optional<std::vector<AppliedEffect>> on_noise;  ///< that made responses and whitener
  std::vector<std::vector<double>> responses;          ///< of other gauges to the reference's noise
  CarriedNoise::Memory carried_noise;                  ///< through these responses
  std::vector<CarriedBin> bins;                        ///< the same
  Whitener whitener;
  WindowJumps jumps;

  Workspace(const Campaign& campaign, const JudgedBand& band, const GaugeNoise& noise)
      : transforms(band, campaign.period_s),
        departures(campaign.shots.size()),
        whitener(noise, campaign.gauges(), campaign.reference),
        jumps(campaign.reference) {}
};

}  // namespace kolsky
