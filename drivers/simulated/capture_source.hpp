#pragma once

#include <vector>

#include "drivers/simulated/code_source.hpp"
#include "drivers/simulated/front_end.hpp"
#include "drivers/simulated/shot_schedule.hpp"
#include "drivers/simulated/simulated_adc.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// Plays stored captures: each shot is the next of them, code by code, round and round. In between
/// the channels stand at what the captures show before their pulse, with noise of the same
/// strength; what a record ends with fades away over as long again, so that its end is no step.
class CaptureSource : public CodeSource {
 public:
  /// @throws InputError where the captures have different channels, rates or conversions, or codes
  /// that
  ///   their converter cannot give
  CaptureSource(std::vector<Shot> captures, std::uint64_t seed);

  void convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) override;
  void fire(Tick tick) override { schedule_.fire(tick); }
  [[nodiscard]] Tick shot_samples() const override { return 2 * longest_; }
  void set_rate(SampleRate) override {}  // the captures' own is the only one

  /// The converter's settings that follow from the captures, as adc_settings(Scenario) gives a
  /// scenario's.
  [[nodiscard]] AdcSettings settings() const;

 private:
  struct Baseline {
    double mean = 0.0;
    double rms = 0.0;
  };

  void play(const ChannelRecord& record, const Baseline& baseline, Tick shot_tick, Tick first_tick,
            std::span<double> values) const;

  std::vector<Shot> captures_;
  std::uint64_t seed_;
  Tick longest_ = 0;
  std::vector<std::vector<Baseline>> baselines_;  ///< per capture and channel
  std::vector<NoiseStream> noise_;
  ShotSchedule schedule_;
  std::vector<double> values_;
};

}  // namespace kolsky
