#pragma once

#include <memory>

#include "processing/base/shot.hpp"
#include "processing/reduction/reducer.hpp"

namespace kolsky {

/// Reduces shots of a ball on an elastic bar: the part of Reducer for benches of kind "impact".
/// Keeps plans and propagation tables of the last few bars and lengths; one thread at a time.
///
/// Each place of gauges gives the force on the face, F = A rho s^2/gamma^2 strain e^{gamma x} (A E
/// strain earlier by x/c0 for elementary waves); places are averaged by their noise. The baseline
/// is the mean of the last millisecond before the wave. What is known of the force ends when the
/// far end's reflection reaches a gauge, 2 (L - x)/c0 after first touch.
class BallReducer {
 public:
  BallReducer();
  ~BallReducer();

  /// Takes of the options `theory`, `arrival_s` (of the wave at the first gauge), `band_limit_Hz`
  /// (the low-pass; else what the noise allows, at most 50 kHz) and `duration_s`.
  /// @throws InputError where the bar has no modulus, or channels are not the bench's
  [[nodiscard]] Reduction reduce(const Shot& shot, const ReductionOptions& options);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky
