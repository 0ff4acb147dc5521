#include "tests/conformance/pattern_capture.hpp"

#include "drivers/files/settings/bench_file.hpp"
#include "tests/conformance/pattern.hpp"
#include "tests/conformance/rig.hpp"

namespace kolsky {
namespace {

constexpr const char* kBench = R"(kind = "bar"
sampling_frequency_Hz = 1.0e6
positive = "compression"
[bars.input]
length_m = 2.0
diameter_m = 0.020
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.5
unit = "V"
strain_per_V = 1e-3
[[gauges]]
name = "g2"
bar = "input"
position_m = 1.5
unit = "V"
strain_per_V = 1e-3
)";

}  // namespace

Shot pattern_shot(Tick pattern_start, std::size_t samples) {
  Shot shot;
  shot.id = "pattern-" + std::to_string(pattern_start);
  shot.bench_toml = kBench;
  shot.bench = parse_bench(kBench, "pattern bench");
  shot.rate = {1'000'000, 1};
  shot.first_tick = 7'000'000 + pattern_start;  // a stream's ticks are its own
  shot.software_version = "test";
  for (std::size_t channel = 0; channel < Rig::kChannels; ++channel) {
    ChannelRecord record;
    record.gauge = shot.bench.gauges[channel].name;
    record.unit = "V";
    record.scale = Rig::kScale_V[channel];
    record.offset = Rig::kOffset[channel];
    record.codes.resize(samples);
    for (std::size_t i = 0; i < samples; ++i) {
      record.codes[i] = pattern_code(channel, pattern_start + static_cast<Tick>(i));
    }
    shot.channels.push_back(std::move(record));
  }
  return shot;
}

void make_gap(Shot& shot, Tick first_tick, Tick samples) {
  const auto begin = static_cast<std::size_t>(first_tick - shot.first_tick);
  for (ChannelRecord& channel : shot.channels) {
    const std::int32_t last = begin > 0 ? channel.codes[begin - 1] : 0;
    std::fill_n(channel.codes.begin() + static_cast<std::ptrdiff_t>(begin), samples, last);
  }
  shot.gaps.push_back({first_tick, samples, true});
}

}  // namespace kolsky
