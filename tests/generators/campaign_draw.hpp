#pragma once

#include <optional>
#include <random>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "tests/generators/bar_world.hpp"
#include "tests/generators/noise.hpp"
#include "tests/generators/shpb_world.hpp"

namespace kolsky::testing {

enum class Tolerances { none, filed };

/// What the caller fixes of a campaign; everything else is drawn from the seed.
struct CampaignWishes {
  std::uint64_t seed = 1;
  int shots = 8;
  int gauges = 4;
  double noise_strain = 4e-6;
  NoiseColour colour = NoiseColour::white;
  std::vector<double> measured_noise{};  ///< for NoiseColour::measured
  Tolerances tolerances = Tolerances::none;
  std::optional<int> bits{};  ///< 0: no quantisation
  std::optional<std::size_t> samples{};
  std::optional<double> rate_Hz{};
  std::optional<double> radius_m{};
  bool split = false;  ///< a split Hopkinson bar in place of a bar
  bool elastic = false;
  bool solid_specimen = false;  ///< a solid of revolution, shortened by a twentieth at most
  bool low_loss_specimen =
      false;                   ///< a solid whose branch is 30 to 300 times as stiff as its spring
  bool soft_specimen = false;  ///< a rubber, which lets hardly a tenth of a pulse through
};

/// The other half of a split bar.
struct SplitParts {
  double output_length_m = 0.7;
  TrueSpecimen specimen;
};

/// A campaign ready to be written: what really is, what is filed, and what the digitiser adds.
struct Campaign {
  BarWorld world;
  std::optional<SplitParts> split;
  Bench bench;                         ///< as filed
  std::optional<Material> filed_bars;  ///< viscoelastic split bars: what is known of them
  CampaignWishes wishes;
  int bits = 14;
  double full_scale_strain = 5e-3;
  std::vector<HiddenEffect> effects;
};

/// Draws bar, gauges, pulses and digitiser without any effect: the base model holds exactly, but
/// for filed tolerances, within which the true values are drawn.
[[nodiscard]] Campaign draw_campaign(const CampaignWishes& wishes);

/// The true numbers drawn once more within what is filed of them.
/// @pre nothing is hidden
void draw_truth_anew(std::mt19937_64& random, Campaign& campaign);

/// The whole split bar. @pre campaign.split
[[nodiscard]] ShpbWorld split_world(const Campaign& campaign);

/// Random coefficients of a pulse's bells: shapes, lengths and edges as bars see them.
/// @param start_s  from the first bell's beginning
[[nodiscard]] std::vector<double> draw_pulse(std::mt19937_64& random, double start_s, double knot_s,
                                             std::size_t knots, double least_length_s = 50e-6);

}  // namespace kolsky::testing
