#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/separation/separation.hpp"

namespace kolsky {

/// What one bar's gauges recorded, as a separation takes it: strain, silent before the pulse.
struct SeparationRecords {
  std::vector<std::string> names;
  std::vector<std::vector<double>> strains;
  std::vector<double> noise_rms;        ///< before the pulse, strain
  std::vector<SeparationGauge> gauges;  ///< of `strains`; all count alike where one has no noise
  std::size_t least_quiet;              ///< samples before the pulse at all of them

  /// @param quiet_at  samples before the pulse at a gauge: baseline and noise are theirs
  SeparationRecords(const Shot& shot, const std::string& bar,
                    const std::function<std::size_t(const Gauge&)>& quiet_at);
  SeparationRecords(const SeparationRecords&) = delete;
  SeparationRecords& operator=(const SeparationRecords&) = delete;

  /// Adds the bar's end with a stress that is known from elsewhere, as well as the first gauge's
  /// noise has it. @param stress_Pa  outlives this
  void add_end(const Bar& bar, std::span<const double> stress_Pa);
};

}  // namespace kolsky
