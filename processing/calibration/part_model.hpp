#pragma once

#include <set>
#include <string>
#include <vector>

#include "processing/calibration/calibration.hpp"
#include "processing/criticism/fitting/composition.hpp"
#include "processing/models/model.hpp"

namespace kolsky {

/// A number under calibration with its place in a model.
struct ModelNumber {
  CalibratedNumber::Of of = CalibratedNumber::Of::gain;
  std::string id;
  std::string gauge;
  std::string bar;     ///< as CalibratedNumber
  std::string effect;  ///< id of the effect's use
  std::size_t parameter = 0;
  Measured filed;          ///< as CalibratedNumber
  double origin = 0.0;     ///< of the effect's value where the number is as filed
  double per_value = 1.0;  ///< the number's change per change of the effect's value
  bool relative = false;   ///< the effect's value is a relative change of the number
  bool believed = true;    ///< something is filed of it
  double step = 0.0;       ///< of the effect's value, that matters
  double least_sd = 0.0;   ///< stands for exact
  bool of_both = false;    ///< what each bar's own number does, done to both

  /// What is filed of the number, as a deviation of the effect's value.
  [[nodiscard]] double filed_sd() const;
};

/// Waves and far end of a part's model.
struct PartVariant {
  bool exact_waves = false;
  bool far_end_seen = false;
};

/// Whether a gauge's numbers count as right.
[[nodiscard]] bool trusted(const CalibrationOptions& options, const std::string& gauge);

/// Numbers that a part of the shots can be held against.
[[nodiscard]] std::vector<ModelNumber> numbers_of(const CalibrationPart& part, const Bench& bench,
                                                  const CalibrationOptions& options,
                                                  const PartVariant& variant);

/// A model in which each number has what is filed of it for prior, but for the released.
/// @param loosen  the least deviation of any prior, in steps that matter; 0: as filed
[[nodiscard]] Model part_model(const CalibrationPart& part, const Bench& bench,
                               const CalibrationOptions& options, const PartVariant& variant,
                               const std::vector<ModelNumber>& numbers,
                               const std::set<std::string>& released, double loosen);

}  // namespace kolsky
