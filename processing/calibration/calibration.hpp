#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processing/base/measured.hpp"
#include "processing/base/workers.hpp"
#include "processing/calibration/arrangement.hpp"
#include "processing/calibration/pulse_areas.hpp"

namespace kolsky {

/// How a filed number stands beside the shots.
enum class Standing {
  agrees,
  differs,      ///< and nothing explains the records as simply
  doubtful,     ///< by more than three deviations, as chance does to one of so many numbers
  tied,         ///< it or one of `tied_with` differs: the shots cannot tell which
  unseen,       ///< the shots say less of it than is filed
  unexplained,  ///< it fits better elsewhere, and still leaves most of what these records differ by
  unfiled,      ///< nothing is filed of it: found by the shots
};

[[nodiscard]] std::string name_of(Standing standing);

/// A number of the bench or of its bars under calibration, as a change of what is filed.
struct CalibratedNumber {
  enum class Of {
    gain,
    position,
    delay,
    bar_length,
    way_to_end,
    diameter,
    density,
    elastic_modulus,
    E1,
    E2,
    eta2
  };
  Of of = Of::gain;
  /// As the effect that would name it: "gauge-position:g3". "E1_Pa" is the bar's or the input
  /// bar's, "output:E1_Pa" that of a viscoelastic output bar lying behind another. Of elastic bars
  /// together "bar-modulus" is off for both alike, "input:bar-modulus" for one alone.
  /// "way-to-end:g1" is what the two passes at one gauge have between them, twice: the bar's length
  /// less the place.
  std::string id;
  std::string gauge;  ///< of gain, position, delay and way to the end
  std::string bar;    ///< "input" or "output", of what is one bar's alone
  Measured filed;     ///< gain: 1, delay: 0, else the number itself; sd 0 where filed as exact
  Measured measured;  ///< by the shots and all other filed numbers, without its own
  Measured combined;  ///< by shots and its own filed number; where it differs, `measured`
  double deviations = 0.0;  ///< measured from filed
  Standing standing = Standing::agrees;
  std::vector<std::string> tied_with;
};

/// What the shots of one arrangement say.
struct PartResult {
  BarsLay lay = BarsLay::one_bar;
  bool two_passes = false;
  std::size_t shots = 0;
  bool exact_waves = false;  ///< else elementary
  bool far_end_seen = false;
  double chi2_reduced = 0.0;  ///< with what differs set right
  double chi2_reduced_as_filed = 0.0;
  Measured wave_speed_m_per_s;  ///< phase speed at `wave_speed_at_Hz`
  double wave_speed_at_Hz = 0.0;
  std::vector<CalibratedNumber> numbers;
  std::vector<std::pair<std::string, std::string>> swapped;  ///< gauges that were exchanged
  std::vector<std::string> inverted;  ///< gauges that read with the other sign than filed
  PulseAreas areas;
  std::vector<std::string> cannot_tell;  ///< combinations of numbers that leave no trace
};

enum class Certificate { pass, fail, undecided };
[[nodiscard]] std::string name_of(Certificate certificate);

struct Calibration {
  Certificate certificate = Certificate::pass;
  std::vector<PartResult> parts;
  std::vector<std::string> reasons;  ///< what keeps the certificate from being a pass
  std::vector<std::string> warnings;
};

struct CalibrationOptions {
  /// Moduli of viscoelastic bars as filed; none: they are found, those of a split bench as of one
  /// material.
  std::optional<BarPrior> bars;
  /// 0: what the noise allows, at most what the bars were identified in.
  double band_limit_Hz = 0.0;
  std::vector<std::string> trusted;  ///< gauges whose gain, place and time count as right
  Workers workers;
  /// Told what is at hand, from the calling thread.
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// Holds a bench file against shots that were fired to check it. Each shot's source is free at all
/// times. Filed numbers move within their deviations; where one is off by more than three, reckoned
/// for the whole bench (with n numbers, as rare as three are for one), the one whose release
/// explains most is named and set free, and so on until what is filed agrees with the rest.
/// @throws InputError as arrange and read_campaign, where the bench lacks a trusted gauge, and
/// where a bar model does not hold for the bench or the shots (see require_bar_model_holds)
[[nodiscard]] Calibration calibrate(const std::vector<Shot>& shots,
                                    const CalibrationOptions& options);

}  // namespace kolsky
