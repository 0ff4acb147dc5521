#include "drivers/simulated/scenario_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kolsky {

ScenarioSource::ScenarioSource(const Scenario& scenario, BenchHistory shot)
    : shot_(std::move(shot)) {
  for (std::size_t i = 0; i < scenario.bench.channels().size(); ++i) {
    channels_.emplace_back(scenario.front_end, i);
  }
  ScenarioSource::set_rate(SampleRate::from_Hz(scenario.bench.sampling_frequency_Hz));
}

void ScenarioSource::set_rate(SampleRate rate) {
  rate_ = rate;
  steps_per_sample_ = static_cast<std::size_t>(std::llround(kStepsPerSecond / rate.Hz()));
  shot_samples_ = static_cast<Tick>(shot_.gauge_strain.front().size() / steps_per_sample_);
  schedule_.forget();
}

void ScenarioSource::convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) {
  strain_.assign(codes.size(), 0.0);
  const Tick end = first_tick + static_cast<Tick>(codes.size());
  const std::vector<double>& record = shot_.gauge_strain[channel];
  schedule_.overlapping(first_tick, end, shot_samples_, [&](const ShotSchedule::Fired& shot) {
    const Tick from = std::max(first_tick, shot.tick);
    const Tick to = std::min(end, shot.tick + shot_samples_);
    for (Tick tick = from; tick < to; ++tick) {
      const auto step = static_cast<std::size_t>(tick - shot.tick) * steps_per_sample_;
      strain_[static_cast<std::size_t>(tick - first_tick)] = record[step];
    }
  });
  channels_[channel].convert(first_tick, rate_, strain_, codes);
}

}  // namespace kolsky
