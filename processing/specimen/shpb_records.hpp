#pragma once

#include <vector>

#include "processing/base/shot.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// Gauges of one bar at one place along it, read as one: a pair across the bar reads no bending.
struct ShpbStation {
  std::vector<std::size_t> channels;  ///< places in the bench's list of gauges
  bool on_input = true;
  double to_specimen_m = 0.0;  ///< mean over the gauges
};

/// A specimen shot as strain at its stations, compression positive, less the baseline before the
/// pulse. All shots that are read together have the same number of quiet samples.
struct ShpbRecords {
  std::vector<std::vector<double>> strain;  ///< by station, from the first quiet sample on
  std::size_t quiet_samples = 0;            ///< before the pulse can have reached the first station
  double foot_s = 0.0;                      ///< of the pulse at the first station, from sample 0
};

/// The stations of a bench of kind "shpb": those on the input bar first, from the impacted end on,
/// then those on the output bar from the specimen on.
/// @throws InputError where a bar has none
[[nodiscard]] std::vector<ShpbStation> shpb_stations(const Bench& bench);

/// @throws InputError where a shot is not of a specimen between two bars, with the command that
///   serves it
void require_specimen(const Shot& shot);

/// @throws InputError where a shot cannot serve: another kind of bench, other benches or rates
///   among the shots, a hole, clipped codes, no pulse, no quiet samples before it
[[nodiscard]] std::vector<ShpbRecords> read_shpb_records(const std::vector<Shot>& shots,
                                                         const std::vector<ShpbStation>& stations);

}  // namespace kolsky
