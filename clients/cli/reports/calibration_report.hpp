#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "drivers/files/settings/bench_edit.hpp"
#include "processing/calibration/calibration.hpp"

namespace kolsky::cli {

/// A key of the bench file and what belongs there.
struct BenchKey {
  std::string name;  ///< "gauges.g3.position_m"
  BenchEdit edit;    ///< of its value
  Measured value;
};

/// Where a calibrated number stands in the bench file, and what to put there. Nothing for what no
/// bench file holds: a delay, gains of samples that are strain already, a material's moduli.
[[nodiscard]] std::optional<BenchKey> bench_key(const CalibratedNumber& number, BarsLay lay,
                                                const Bench& bench);

/// What files that a gauge reads with the other sign than filed.
[[nodiscard]] BenchEdit inverting_edit(const std::string& gauge, const Bench& bench);

/// Lines of the bench file that the calibration changes: what differs, gauges that are exchanged or
/// read with the other sign, and what is known better by now than filed. What the shots cannot tell
/// stays as it is.
[[nodiscard]] std::vector<BenchEdit> corrections(const Calibration& calibration,
                                                 const Bench& bench);

/// What `calibrate --json` prints.
[[nodiscard]] JsonValue describe(const Calibration& calibration, const Bench& bench);

/// The same for people.
[[nodiscard]] std::string report(const Calibration& calibration, const Bench& bench);

}  // namespace kolsky::cli
