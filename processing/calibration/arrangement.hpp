#pragma once

#include <string>
#include <utility>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/specimen/shpb_unknowns.hpp"

namespace kolsky {

/// How the bars lay when a shot was fired.
enum class BarsLay { one_bar, together, input_alone, output_alone };

[[nodiscard]] std::string name_of(BarsLay lay);

/// Shots that were fired with the bars lying alike, on a bench of their own: what a fit takes.
struct CalibrationPart {
  BarsLay lay = BarsLay::one_bar;
  std::vector<Shot> shots;
  /// One gauge, whose second sight of the pulse (from the free end) stands for another gauge.
  bool two_passes = false;
  /// Gauges whose pulses arrive in each other's order: by name, on the part's bench exchanged.
  std::vector<std::pair<std::string, std::string>> swapped;
  /// Gauges whose pulse pulls where another's pushes: by name, in the part's shots inverted.
  std::vector<std::string> inverted;
  /// What viscoelastic bars were taken to be where records were cut, and where a fit begins.
  BarPrior bars{paper_pmma()};
};

/// How channels are taken: exchanged and inverted where their first pulses say so, or as the bench
/// files them.
enum class Channels { as_they_read, as_filed };

/// Sorts shots by how the bars lay, which the records show: a bar that stays silent was not
/// touched. A bar by itself becomes a bench of kind "bar"; bars together stay a split bar, with the
/// records cut before faces can part.
/// @throws InputError where the shots are of different benches or kinds, or hold no pulse
[[nodiscard]] std::vector<CalibrationPart> arrange(const std::vector<Shot>& shots,
                                                   const BarPrior& bars,
                                                   Channels channels = Channels::as_they_read);

/// What viscoelastic bars are taken to be before anything of them is known: the paper's PMMA, and
/// of bars that touch one as much stiffer as the pulse is faster from gauge to gauge.
/// @throws InputError where a split bench's bars are too dense or too light for any PMMA
[[nodiscard]] BarPrior bars_to_begin_with(const std::vector<Shot>& shots);

/// Whether the filed specimen is a slice of the bars themselves.
[[nodiscard]] bool specimen_is_slice_of_bar(const Bench& bench);

/// Distance from where the wave starts to a gauge, across the specimen for the output bar.
[[nodiscard]] double way_to_m(const Bench& bench, const Gauge& gauge);

}  // namespace kolsky
