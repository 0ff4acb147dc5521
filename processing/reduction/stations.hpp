#pragma once

#include <cstddef>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/waves/wave_theory.hpp"

namespace kolsky {

/// The gauges that one bar is read by: those at one place along it (a pair across the bar is one
/// station).
struct BarStation {
  std::vector<std::size_t> channels;  ///< indices into the shot's channels
  double gauge_to_specimen_m = 0.0;   ///< mean over the station's gauges
  double gauge_to_far_end_m = 0.0;
};

/// The station of a bar that is listed first; its gauges lie within a bar diameter of each other.
/// @throws InputError where the bar has no gauge
[[nodiscard]] BarStation station_on(const Bench& bench, const std::string& bar);

/// The station's record as the digitiser has it, in the gauges' unit and averaged over them: enough
/// to find a pulse in.
void read_raw_station(const Shot& shot, const BarStation& station, std::vector<double>& readings);

/// The station's record as strain, compression positive: each channel's codes through its bridge,
/// less the mean of its first `quiet` samples, averaged over the station's gauges.
/// @param strains  shot.samples() of them
void read_station(const Shot& shot, const BarStation& station, std::size_t quiet,
                  std::vector<double>& strains);

}  // namespace kolsky
