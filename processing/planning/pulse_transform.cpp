#include "processing/planning/pulse_transform.hpp"

#include <cmath>

namespace kolsky {

namespace {

/// Standard deviation of the Gaussian: 1e-10 of the highest frequency is left.
constexpr double kSmoothing_steps = 2.16;

}  // namespace

PulseTransform::PulseTransform(const PlannedPulse& pulse, double quiet_s, double record_s,
                               double step_s)
    : step_s_(step_s),
      steps_(static_cast<std::size_t>(record_s / step_s) + 1),
      transform_(steps_, step_s),
      path_(transform_.bins()),
      force_(transform_.bins()) {
  std::vector<double> record(steps_);
  for (std::size_t n = 0; n < steps_; ++n) {
    record[n] = pulse.force_N(static_cast<double>(n) * step_s - quiet_s);
  }
  transform_.forward(record, force_);
  const double smoothing_s = kSmoothing_steps * step_s;
  for (std::size_t k = 0; k < path_.size(); ++k) {
    path_[k] = transform_.s(k);
    const Complex smoothed = smoothing_s * path_[k];
    force_[k] *= std::exp(0.5 * smoothed * smoothed);
  }
}

std::vector<double> PulseTransform::history(const std::vector<Complex>& per_N) {
  std::vector<Complex> spectrum(force_.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] = force_[k] * per_N[k];
  }
  std::vector<double> history(steps_);
  transform_.inverse(spectrum, history);
  return history;
}

}  // namespace kolsky
