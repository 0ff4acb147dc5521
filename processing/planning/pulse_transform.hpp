#pragma once

#include <cstddef>
#include <vector>

#include "processing/planning/planned_pulse.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// A planned pulse along a damped line of the Laplace plane, and the way back to histories.
///
/// Its spectrum is that of the pulse after a Gaussian of two steps. A spectrum that is cut off at
/// the grid's highest frequency rings before everything that comes between two steps; what rings
/// before the record goes round to its end, where the line's damping makes it e^18 times as large.
class PulseTransform {
 public:
  /// @param quiet_s   from the first step to the impact; several steps, or the Gaussian starts
  ///   before the record does
  /// @param record_s  length of the record, the quiet included
  /// @param step_s    small beside the pulse's rise
  PulseTransform(const PlannedPulse& pulse, double quiet_s, double record_s, double step_s);

  [[nodiscard]] const std::vector<Complex>& path() const { return path_; }
  [[nodiscard]] const std::vector<Complex>& force() const { return force_; }
  [[nodiscard]] double step_s() const { return step_s_; }

  /// The history that the pulse makes of a response per newton, by step from the record's start.
  [[nodiscard]] std::vector<double> history(const std::vector<Complex>& per_N);

 private:
  double step_s_;
  std::size_t steps_;
  DampedTransform transform_;
  std::vector<Complex> path_;
  std::vector<Complex> force_;
};

}  // namespace kolsky
