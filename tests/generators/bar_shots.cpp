#include "tests/generators/bar_shots.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/simulated/bench_model.hpp"

namespace kolsky::testing {

namespace {

constexpr double kStep_s = 0.1e-6;
constexpr std::size_t kStepsPerSample = 10;
constexpr double kNeighbour_m = 2e-3;

std::vector<double> sampled(const std::vector<double>& fine, const BarShots::Setup& setup) {
  std::vector<double> record(setup.pre_samples, 0.0);
  for (std::size_t n = 0; n < setup.post_samples; ++n) {
    record.push_back(fine[n * kStepsPerSample]);
  }
  return record;
}

}  // namespace

BarShots::BarShots(const Setup& setup) : setup_(setup) {
  const double area_m2 = std::numbers::pi * setup.diameter_m * setup.diameter_m / 4.0;
  BenchModel model;
  model.input = RodShape{setup.length_m, area_m2, setup.material};
  model.pulse = {.peak_force_N = setup.material.E1_Pa * area_m2,
                 .duration_s = setup.pulse_s,
                 .ramp_s = setup.ramp_s};
  for (const double x : setup.position_m) {
    for (const double offset : {-kNeighbour_m, 0.0, kNeighbour_m}) {
      model.gauges.push_back({RodId::input, x + offset});
    }
  }
  const BenchHistory history = run_bench(model, kStep_s, setup.post_samples * kStepsPerSample + 1);
  for (std::size_t j = 0; j < setup.position_m.size(); ++j) {
    const auto before = sampled(history.gauge_strain[3 * j], setup);
    const auto here = sampled(history.gauge_strain[3 * j + 1], setup);
    const auto after = sampled(history.gauge_strain[3 * j + 2], setup);
    auto& slope = gradient_.emplace_back();
    auto& bend = curvature_.emplace_back();
    for (std::size_t n = 0; n < here.size(); ++n) {
      slope.push_back((after[n] - before[n]) / (2.0 * kNeighbour_m));
      bend.push_back((after[n] - 2.0 * here[n] + before[n]) / (kNeighbour_m * kNeighbour_m));
    }
    strain_.push_back(here);
  }
}

Bench BarShots::bench(const Recording& recording) const {
  Bench bench;
  bench.kind = BenchKind::bar;
  bench.sampling_frequency_Hz = {1.0 / (kStep_s * static_cast<double>(kStepsPerSample)), 0.0};
  bench.input.length_m = {setup_.length_m};
  bench.input.diameter_m = {setup_.diameter_m};
  bench.input.density_kg_m3 = {setup_.material.density_kg_m3};
  bench.input.poisson_ratio = {setup_.poisson_ratio};
  for (std::size_t j = 0; j < setup_.position_m.size(); ++j) {
    Gauge gauge;
    gauge.name = "g" + std::to_string(j + 1);
    gauge.bar = "input";
    gauge.position_m = {setup_.position_m[j], recording.position_sd_m};
    gauge.unit = "V";
    gauge.strain_per_V = Measured{1e-3, 1e-3 * recording.gain_sd};
    bench.gauges.push_back(gauge);
  }
  return bench;
}

std::vector<Shot> BarShots::draw(std::size_t count, const Recording& recording,
                                 std::mt19937_64& random) const {
  std::normal_distribution<double> normal(0.0, 1.0);
  const std::size_t gauges = setup_.position_m.size();
  std::vector<double> gain;
  std::vector<double> moved_m;
  for (std::size_t j = 0; j < gauges; ++j) {
    gain.push_back(1.0 + recording.gain_sd * normal(random));
    moved_m.push_back(recording.position_sd_m * normal(random));
  }
  const double full = std::ldexp(1.0, recording.bits - 1);
  const double fresh = std::sqrt(1.0 - recording.noise_correlation * recording.noise_correlation);
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.5;
    const double peak = 1e-3 + 2e-3 * share;
    Shot shot;
    shot.id = "shot-" + std::to_string(i + 1);
    shot.bench = bench(recording);
    shot.rate = SampleRate::from_Hz(shot.bench.sampling_frequency_Hz);
    for (std::size_t j = 0; j < gauges; ++j) {
      ChannelRecord channel;
      channel.gauge = shot.bench.gauges[j].name;
      channel.unit = "V";
      channel.bits = recording.bits;
      channel.scale = recording.range_strain / 1e-3 / full;
      channel.code_min = static_cast<std::int32_t>(-full);
      channel.code_max = static_cast<std::int32_t>(full - 1);
      const double d = moved_m[j];
      std::vector<double> coloured;
      if (recording.colour != NoiseColour::white) {
        coloured = testing::noise(recording.colour, 1.0, kStep_s * kStepsPerSample,
                                  strain_[j].size(), random);
      }
      double noise = coloured.empty() ? normal(random) : 0.0;
      for (std::size_t n = 0; n < strain_[j].size(); ++n) {
        const double strain =
            gain[j] * peak * (strain_[j][n] + d * (gradient_[j][n] + 0.5 * d * curvature_[j][n]));
        noise = coloured.empty() ? recording.noise_correlation * noise + fresh * normal(random)
                                 : coloured[n];
        const double volts = (strain + recording.noise_rms * noise) / 1e-3;
        channel.codes.push_back(static_cast<std::int32_t>(
            std::clamp(std::round(volts / channel.scale), -full, full - 1)));
      }
      shot.channels.push_back(std::move(channel));
    }
    shots.push_back(std::move(shot));
  }
  return shots;
}

}  // namespace kolsky::testing
