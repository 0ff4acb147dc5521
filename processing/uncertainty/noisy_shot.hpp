#pragma once

#include <vector>

#include "processing/base/shot.hpp"
#include "processing/uncertainty/converter_steps.hpp"
#include "processing/uncertainty/noise.hpp"

namespace kolsky {

/// A shot that is recorded again and again: its samples, with more of its own noise, and with what
/// its converters' steps may hide.
class NoisyShot {
 public:
  /// @param quiet_samples  before the pulse, which tell what each channel's noise is like
  NoisyShot(const Shot& shot, std::size_t quiet_samples);

  /// Adds noise afresh.
  /// @param noise  draws it; none: no noise
  /// @param steps  draws what converters hide; none: nothing
  void record(RandomStream* noise, RandomStream* steps = nullptr);

  /// Whether any converter hides more than its noise shows.
  [[nodiscard]] bool has_steps() const;

  /// With codes that are finer than the shot's, so that noise below one of those can be added.
  [[nodiscard]] const Shot& shot() const { return shot_; }
  void set_bench(Bench bench) { shot_.bench = std::move(bench); }

 private:
  Shot shot_;
  std::vector<ChannelRecord> as_recorded_;
  std::vector<NoiseMaker> makers_;
  std::vector<ConverterSteps> steps_;
  std::vector<double> noise_;
};

}  // namespace kolsky
