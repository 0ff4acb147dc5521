#pragma once

#include "processing/base/shot.hpp"
#include "tests/generators/bar_readings.hpp"
#include "tests/generators/campaign_draw.hpp"

namespace kolsky::testing {

/// Plants an effect and notes it for the truth.
void hide(Campaign& campaign, const HiddenEffect& effect);

/// What its gauges read; waves are kept between calls.
class CampaignForward {
 public:
  [[nodiscard]] Readings readings(const Campaign& campaign);
  /// Answer of every gauge to a single bell of the source (a bar's, or the whole split bar's), from
  /// its beginning on, per sample; gains in it.
  [[nodiscard]] std::vector<std::vector<double>> bell_records(const Campaign& campaign,
                                                              std::size_t samples);

 private:
  BarForward bar_;
  ShpbForward split_;
};

/// The campaign's records, noise and quantisation in them.
[[nodiscard]] std::vector<Shot> shots_of(const Campaign& campaign);
/// The same from readings that are there already.
[[nodiscard]] std::vector<Shot> shots_of(const Campaign& campaign, const Readings& readings);

}  // namespace kolsky::testing
