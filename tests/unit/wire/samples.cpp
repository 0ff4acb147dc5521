#include "tests/unit/wire/samples.hpp"

#include <bit>
#include <limits>
#include <random>

namespace kolsky {
namespace {

ChannelRecord channel(const std::string& gauge, int bits, std::size_t samples) {
  const std::int32_t code_max = (1 << (bits - 1)) - 1;
  // A scale with no short decimal or binary form.
  ChannelRecord channel{gauge, "V", 0.1 / 3.0, -0.7, bits, -code_max - 1, code_max, {}};
  std::mt19937 random(static_cast<unsigned>(bits));
  std::uniform_int_distribution<std::int32_t> code(channel.code_min, channel.code_max);
  for (std::size_t i = 0; i < samples; ++i) {
    channel.codes.push_back(code(random));
  }
  if (samples >= 2) {
    channel.codes.front() = channel.code_min;
    channel.codes.back() = channel.code_max;
  }
  return channel;
}

std::vector<double> awkward(std::size_t samples, double start) {
  using Limits = std::numeric_limits<double>;
  std::vector<double> values(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    values[i] = start + 0.1 * static_cast<double>(i) / 3.0;
  }
  const double specials[] = {
      0.0,
      -0.0,
      Limits::denorm_min(),
      -Limits::infinity(),
      Limits::max(),
      std::bit_cast<double>(std::uint64_t{0x7ff800000badcafe}),
  };
  for (std::size_t i = 0; i < std::size(specials) && i < samples; ++i) {
    values[samples - 1 - i] = specials[i];
  }
  return values;
}

}  // namespace

Shot full_shot(std::size_t samples) {
  Shot shot;
  shot.id = "20240102T030405.678901-1";
  shot.bench_toml = "kind = \"shpb\"  # Kraftmeßgerät\n";
  shot.bar_model = three_element_material({1200.1, 0.3}, {0.37, 0.0}, {5.5e9, 1e7}, {6.1e9, 0.0},
                                          {1e5, 2.0}, "us");
  shot.reduction = {.dispersion = "exact",
                    .separate = "never",
                    .stress = "one-wave",
                    .inertia = "both",
                    .friction = 0.1 / 3.0,
                    .band_limit_Hz = 2e4 / 7.0,
                    .duration_s = 1e-3 / 3.0,
                    .with_true = true};
  shot.rate = {1'000'000, 3};
  shot.first_tick = 123'456'789'012'345;
  shot.trigger = TriggerEvent{123'456'789'012'745, 0.1, 0.03, TriggerKind::marked};
  shot.channels = {channel("g1", 16, samples), channel("g2", 24, samples)};
  shot.gaps = {{123'456'789'012'400, 17, true}, {123'456'789'012'500, 0, false}};
  shot.meta = {{"specimen", "Cu 3"}, {"striker_speed_m_per_s", "9.5"}, {"", "no name"}};
  shot.utc_ns = 1'704'164'645'678'901'234;
  shot.monotonic_ns = -5;
  shot.software_version = "0.1.0";
  return shot;
}

Reduction awkward_reduction(std::size_t samples) {
  Reduction reduction;
  double start = -1e-4;
  for (auto* values : {&reduction.time_s, &reduction.stress_Pa, &reduction.strain,
                       &reduction.strain_rate_per_s, &reduction.force_front_N,
                       &reduction.force_back_N, &reduction.incident, &reduction.reflected,
                       &reduction.transmitted, &reduction.strain_true, &reduction.stress_true_Pa}) {
    *values = awkward(samples, start);
    start = start * -3.0 + 1.0;
  }
  reduction.arrival_s = 4.1e-4;
  reduction.arrival_sigma_s = 1.0 / 3e7;
  reduction.band_limit_Hz = 123456.7;
  reduction.quiet_samples = 287;
  reduction.separation = Separation::equilibrium;
  reduction.theory = WaveTheory::exact;
  reduction.stress_from = StressFrom::front;
  reduction.corrections = {true, false, 0.1 / 3.0};
  reduction.assumed_from_s = 1.0 / 3e4;
  reduction.push_left_share = 0.01 / 3.0;
  reduction.bar_model = "PMMA";
  reduction.quality.reducible = true;
  reduction.quality.checks = {{"equilibrium", 0.06, 0.05, "1", Verdict::warn, "they differ"},
                              {"clipping", 0.0, 0.0, "1", Verdict::pass, ""}};
  return reduction;
}

std::string bits_of(const std::vector<double>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

}  // namespace kolsky
