#pragma once

#include <span>
#include <vector>

#include "processing/waves/transform.hpp"

namespace kolsky {

/// A short pulse on a damped line, with which the causality of a response is tried: what it causes
/// must not come before it. What comes later than the window wraps round to its start, by the
/// transform's damping smaller.
class PulseProbe {
 public:
  explicit PulseProbe(double period_s);

  /// The places s at which responses are wanted.
  [[nodiscard]] const std::vector<Complex>& path() const { return path_; }
  /// The pulse's spectrum there.
  [[nodiscard]] const std::vector<Complex>& pulse() const { return pulse_; }

  /// Largest values of an answer in time.
  struct Answer {
    double before_pulse = 0.0;
    double anywhere = 0.0;
  };
  /// @param spectrum  pulse() times the response, along path()
  /// @param lead_s    by how much an answer may come before the pulse, a sample in any case
  [[nodiscard]] Answer answer(std::span<const Complex> spectrum, double lead_s);

 private:
  double period_s_;
  DampedTransform transform_;
  std::size_t start_;  ///< sample at which the pulse begins
  std::vector<Complex> path_;
  std::vector<Complex> pulse_;
  std::vector<double> record_;
};

}  // namespace kolsky
