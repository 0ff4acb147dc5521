#pragma once

#include <vector>

#include "drivers/simulated/code_source.hpp"
#include "drivers/simulated/front_end.hpp"
#include "drivers/simulated/scenario.hpp"
#include "drivers/simulated/shot_schedule.hpp"

namespace kolsky {

/// Codes of a scenario: the front end's noise all the time, and the bench's strains from each shot
/// on.
class ScenarioSource : public CodeSource {
 public:
  /// @param shot  of the scenario, as run_shot gives it
  ScenarioSource(const Scenario& scenario, BenchHistory shot);

  void convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) override;
  void fire(Tick tick) override { schedule_.fire(tick); }
  [[nodiscard]] Tick shot_samples() const override { return shot_samples_; }
  void set_rate(SampleRate rate) override;

 private:
  BenchHistory shot_;
  std::vector<FrontEnd> channels_;
  SampleRate rate_{1, 1};
  std::size_t steps_per_sample_ = 1;
  Tick shot_samples_ = 0;
  ShotSchedule schedule_;
  std::vector<double> strain_;
};

}  // namespace kolsky
