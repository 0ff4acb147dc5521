// The sample ring with the trigger behind it against a plain copy of the same bytes: quiet 16-bit
// noise, buffers of the size of the ring, so that neither works from the first cache alone.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "daemon/acquisition/sample_ring.hpp"
#include "processing/trigger/channel_level.hpp"
#include "processing/trigger/incident_trigger.hpp"

namespace {

using namespace kolsky;

constexpr std::size_t kCapacity = std::size_t{1} << 22;  ///< samples per channel
constexpr double kNoise_codes = 20.0;
constexpr double kLeastRate = 2e9;   ///< samples of 16 bits per second, on one core
constexpr double kMostCopies = 5.0;  ///< of the same bytes
/// Smaller blocks, which a digitiser sends below half a megasample per second only, are bound by
/// what each costs.
constexpr std::size_t kLeastBlock = 512;

std::vector<std::int16_t> quiet_noise(std::size_t samples) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(100.0, kNoise_codes);
  std::vector<std::int16_t> codes(samples);
  for (std::int16_t& code : codes) code = static_cast<std::int16_t>(std::lround(noise(random)));
  return codes;
}

const std::vector<std::int16_t>& noise() {
  static const std::vector<std::int16_t> kNoise = quiet_noise(kCapacity);
  return kNoise;
}

double thread_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class PlainCopy {
 public:
  PlainCopy(std::size_t channels, std::size_t block)
      : channels_(channels), block_(block), ring_(channels * kStride) {}

  void once() {
    for (std::size_t channel = 0; channel < channels_; ++channel) {
      std::memcpy(ring_.data() + channel * kStride + at_, noise().data() + at_,
                  block_ * sizeof(std::int16_t));
    }
    benchmark::ClobberMemory();
    at_ = (at_ + block_) % kCapacity;
  }

 private:
  // Not a power of two, as in the ring: else planes share cache sets, and the copy is slower for
  // it.
  static constexpr std::size_t kStride = kCapacity + 96;

  std::size_t channels_;
  std::size_t block_;
  std::vector<std::int16_t> ring_;
  std::size_t at_ = 0;
};

/// Seconds per round in the best time through the buffers: what else the machine does comes and
/// goes, and would otherwise be counted against one side of the ratio alone.
class BestPass {
 public:
  explicit BestPass(std::size_t rounds) : rounds_(rounds), start_s_(thread_time_s()) {}

  void count_round() {
    if (++done_ % rounds_ != 0) return;
    const double now_s = thread_time_s();
    // The first touches the memory.
    if (done_ > rounds_) best_s_ = std::min(best_s_, now_s - start_s_);
    start_s_ = now_s;
  }
  [[nodiscard]] double round_s() const { return best_s_ / static_cast<double>(rounds_); }

 private:
  std::size_t rounds_;
  std::size_t done_ = 0;
  double start_s_;
  double best_s_ = std::numeric_limits<double>::infinity();
};

double floor_s(std::size_t channels, std::size_t block) {
  static std::map<std::pair<std::size_t, std::size_t>, double> known;
  double& best = known[{channels, block}];
  if (best > 0.0) return best;
  PlainCopy copy(channels, block);
  constexpr std::size_t kPasses = 24;
  BestPass passes(kCapacity / block);
  for (std::size_t i = 0; i < kPasses * (kCapacity / block); ++i) {
    copy.once();
    passes.count_round();
  }
  best = passes.round_s();
  return best;
}

void count_samples(benchmark::State& state, std::size_t per_round) {
  const auto samples = static_cast<double>(state.iterations()) * static_cast<double>(per_round);
  state.counters["samples"] = benchmark::Counter(samples, benchmark::Counter::kIsRate);
}

// range(0): channels, range(1): samples per block.
void plain_copy(benchmark::State& state) {
  const auto channels = static_cast<std::size_t>(state.range(0));
  const auto block = static_cast<std::size_t>(state.range(1));
  PlainCopy copy(channels, block);
  for ([[maybe_unused]] auto _ : state) copy.once();
  count_samples(state, channels * block);
}

enum class Watch {
  nothing,
  first,  ///< the trigger on one channel
  all,    ///< the trigger on one, level and noise of the others, as the daemon does
};

void write_ring(benchmark::State& state, Watch watch) {
  const auto channels = static_cast<std::size_t>(state.range(0));
  const auto samples = static_cast<std::size_t>(state.range(1));
  SampleRing ring(SampleFormat::int16, channels, kCapacity);
  const TriggerOptions options = TriggerOptions::for_rate(1e6);
  IncidentTrigger trigger(options);
  std::vector<ChannelLevel> levels(channels, ChannelLevel(options));
  std::vector<RunStatistics> statistics(channels);
  Block block;
  block.samples = samples;
  block.channels.resize(channels);
  std::size_t at = 0;
  BestPass best(kCapacity / samples);
  for ([[maybe_unused]] auto _ : state) {
    const std::span<const std::int16_t> codes(noise().data() + at, samples);
    for (auto& channel : block.channels) channel = std::as_bytes(codes);
    ring.write(block, statistics);
    if (watch != Watch::nothing && trigger.feed(block.first_tick, codes, statistics[0])) {
      state.SkipWithError("fired");
    }
    for (std::size_t i = 1; watch == Watch::all && i < channels; ++i) levels[i].take(statistics[i]);
    block.first_tick += static_cast<Tick>(samples);
    at = (at + samples) % kCapacity;
    best.count_round();
  }
  const double of_copy = best.round_s() / floor_s(channels, samples);
  state.counters["of_copy"] = of_copy;
  count_samples(state, channels * samples);
  if (watch == Watch::all && samples >= kLeastBlock) {
    const double rate = static_cast<double>(channels * kCapacity) / best.round_s();
    state.counters["bound_over_time"] = std::min(rate / kLeastRate, kMostCopies / of_copy);
  }
}

void ring_alone(benchmark::State& state) {
  write_ring(state, Watch::nothing);
}
void ring_and_trigger(benchmark::State& state) {
  write_ring(state, Watch::first);
}
void ring_trigger_and_levels(benchmark::State& state) {
  write_ring(state, Watch::all);
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"channels", "block"});
  for (const std::int64_t channels : {2, 4}) {
    for (const std::int64_t block : {256, 512, 1024, 4096, 65536}) bench->Args({channels, block});
  }
}

BENCHMARK(plain_copy)->Apply(sizes);
BENCHMARK(ring_alone)->Apply(sizes);
BENCHMARK(ring_and_trigger)->Apply(sizes);
BENCHMARK(ring_trigger_and_levels)->Apply(sizes);

}  // namespace
