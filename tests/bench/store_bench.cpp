// What durability costs: a shot into the journal beside a bare write and fdatasync of as many
// bytes, and a capture written and read. Runs in the working directory, so start it on the disk in
// question.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <vector>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/store/journal.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

constexpr int kShots = 300;

/// Two gauges, 4000 samples of 16 bits.
Shot make_shot() {
  Shot shot;
  shot.id = "bench";
  shot.bench_toml = R"(kind = "bar"
sampling_frequency_Hz = 1.0e6
[bars.input]
length_m = 2.0
diameter_m = 0.020
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.5
unit = "strain"
[[gauges]]
name = "g2"
bar = "input"
position_m = 1.0
unit = "strain"
)";
  shot.rate = {1'000'000, 1};
  shot.trigger = TriggerEvent{400, 0.5, 0.1, TriggerKind::incident};
  std::mt19937 random(1);
  for (const char* gauge : {"g1", "g2"}) {
    ChannelRecord& channel = shot.channels.emplace_back();
    channel.gauge = gauge;
    channel.unit = "strain";
    channel.scale = 1e-7;
    channel.codes.resize(4000);
    for (std::int32_t& code : channel.codes) {
      code = static_cast<std::int32_t>(random() % 2000) - 1000;
    }
  }
  return shot;
}

/// As many bytes as the journal's record of the shot has, less its header.
std::size_t record_bytes() {
  static const std::size_t kBytes = [] {
    std::vector<std::byte> bytes;
    encode_shot(make_shot(), bytes);
    return bytes.size();
  }();
  return kBytes;
}

/// Half of the floor's writes take no longer than this, once it was measured.
double floor_us = 0.0;

/// Times one action per iteration; what runs between two is not counted.
template <typename Action, typename Between>
void measure(benchmark::State& state, const Action& action, const Between& between) {
  std::vector<double> seconds;
  for ([[maybe_unused]] auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    action();
    seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    state.SetIterationTime(seconds.back());
    between();
  }
  std::sort(seconds.begin(), seconds.end());
  state.counters["p50_us"] = 1e6 * seconds[seconds.size() / 2];
  state.counters["p99_us"] = 1e6 * seconds[seconds.size() * 99 / 100];
}

void floor_of(benchmark::State& state, bool filled) {
  const testing::ScratchFolder folder(".");
  const int file = ::open((folder / "floor").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const std::vector<char> bytes(record_bytes(), 7);
  off_t end = 0;
  for (int i = 0; filled && i < kShots; ++i) {
    benchmark::DoNotOptimize(::pwrite(file, bytes.data(), bytes.size(), end));
    end += static_cast<off_t>(bytes.size());
  }
  ::fsync(file);
  end = 0;
  measure(
      state,
      [&] {
        benchmark::DoNotOptimize(::pwrite(file, bytes.data(), bytes.size(), end));
        ::fdatasync(file);
      },
      [&] { end += static_cast<off_t>(bytes.size()); });
  ::close(file);
}

/// The medium's floor: overwriting blocks that the file has.
void FloorOverwrite(benchmark::State& state) {
  floor_of(state, true);
  floor_us = state.counters["p50_us"];
}

/// The same, each write making the file longer.
void FloorAppend(benchmark::State& state) {
  floor_of(state, false);
}

void AppendShot2x4000(benchmark::State& state) {
  const testing::ScratchFolder folder(".");
  const Shot shot = make_shot();
  Journal journal(folder / "a.kj");
  measure(
      state, [&] { journal.append_shot(shot); },
      [&] { journal.append_stored(shot.id, "bench.h5"); });
  state.counters["of_floor"] = state.counters["p50_us"] / floor_us;
}

void WriteCapture2x4000(benchmark::State& state) {
  const testing::ScratchFolder folder(".");
  const Shot shot = make_shot();
  int i = 0;
  measure(
      state, [&] { write_capture(shot, folder / (std::to_string(i) + ".h5")); }, [&i] { ++i; });
}

void ReadCapture2x4000(benchmark::State& state) {
  const testing::ScratchFolder folder(".");
  write_capture(make_shot(), folder / "a.h5");
  measure(
      state, [&] { benchmark::DoNotOptimize(read_capture(folder / "a.h5")); }, [] {});
}

BENCHMARK(FloorOverwrite)->UseManualTime()->Iterations(kShots)->Unit(benchmark::kMicrosecond);
BENCHMARK(FloorAppend)->UseManualTime()->Iterations(kShots)->Unit(benchmark::kMicrosecond);
BENCHMARK(AppendShot2x4000)->UseManualTime()->Iterations(kShots)->Unit(benchmark::kMicrosecond);
BENCHMARK(WriteCapture2x4000)->UseManualTime()->Iterations(kShots)->Unit(benchmark::kMicrosecond);
BENCHMARK(ReadCapture2x4000)->UseManualTime()->Iterations(kShots)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kolsky
