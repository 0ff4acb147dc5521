// What it costs to turn a 2 x 4000-sample shot and its result into the bytes that go out, beside a
// plain copy of as many bytes.
#include <benchmark/benchmark.h>

#include <cstring>
#include <random>

#include "daemon/publish/publisher.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "proto/codec.hpp"
#include "proto/text.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kSamples = 4000;

Shot shot() {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> code(-32768, 32767);
  Shot shot;
  shot.id = "20240102T030405.678901-1";
  shot.bench_toml = std::string(1500, 'x');
  shot.rate = {1'000'000, 1};
  shot.trigger = TriggerEvent{400, 0.5, 0.1, TriggerKind::incident};
  shot.meta = {{"specimen", "Cu 3"}, {"striker_speed_m_per_s", "9.5"}};
  for (const char* gauge : {"g1", "g2"}) {
    ChannelRecord& channel = shot.channels.emplace_back();
    channel.gauge = gauge;
    channel.unit = "V";
    for (std::size_t i = 0; i < kSamples; ++i) {
      channel.codes.push_back(code(random));
    }
  }
  return shot;
}

Reduction reduction() {
  Reduction reduction;
  for (auto* values :
       {&reduction.time_s, &reduction.stress_Pa, &reduction.strain, &reduction.strain_rate_per_s,
        &reduction.force_front_N, &reduction.force_back_N, &reduction.incident,
        &reduction.reflected, &reduction.transmitted}) {
    values->assign(kSamples, 1.25);
  }
  reduction.quality.reducible = true;
  reduction.quality.checks.assign(5, {"equilibrium", 0.02, 0.05, "1", Verdict::pass, "it holds"});
  return reduction;
}

void count_bytes(benchmark::State& state, std::size_t bytes) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes));
  state.counters["bytes"] = static_cast<double>(bytes);
}

void encode_shot(benchmark::State& state) {
  const Shot one = shot();
  v1::Shot message;
  std::size_t bytes = 0;
  for (auto _ : state) {
    wire::encode(one, "store/shots/1.h5", message);
    const std::string out = wire::serialise(message);
    benchmark::DoNotOptimize(out.data());
    bytes = out.size();
  }
  count_bytes(state, bytes);
}
BENCHMARK(encode_shot);

void encode_result(benchmark::State& state) {
  const Reduction one = reduction();
  v1::Result message;
  std::size_t bytes = 0;
  for (auto _ : state) {
    wire::encode(one, "1", message);
    const std::string out = wire::serialise(message);
    benchmark::DoNotOptimize(out.data());
    bytes = out.size();
  }
  count_bytes(state, bytes);
}
BENCHMARK(encode_result);

void encode_shot_and_result(benchmark::State& state) {
  const Shot one = shot();
  const Reduction its = reduction();
  v1::Shot shot_message;
  v1::Result result_message;
  std::size_t bytes = 0;
  for (auto _ : state) {
    wire::encode(one, "store/shots/1.h5", shot_message);
    wire::encode(its, one.id, result_message);
    const std::string first = wire::serialise(shot_message);
    const std::string second = wire::serialise(result_message);
    benchmark::DoNotOptimize(first.data());
    benchmark::DoNotOptimize(second.data());
    bytes = first.size() + second.size();
  }
  count_bytes(state, bytes);
}
BENCHMARK(encode_shot_and_result);

void floor_copy_of_the_same_bytes(benchmark::State& state) {
  v1::Shot shot_message;
  v1::Result result_message;
  wire::encode(shot(), "store/shots/1.h5", shot_message);
  wire::encode(reduction(), "1", result_message);
  const std::string bytes = wire::serialise(shot_message) + wire::serialise(result_message);
  std::string copy(bytes.size(), '\0');
  for (auto _ : state) {
    std::memcpy(copy.data(), bytes.data(), bytes.size());
    benchmark::DoNotOptimize(copy.data());
    benchmark::ClobberMemory();
  }
  count_bytes(state, bytes.size());
}
BENCHMARK(floor_copy_of_the_same_bytes);

void encode_and_publish_shot_and_result(benchmark::State& state) {
  PublisherOptions options;
  options.results_endpoint = "tcp://127.0.0.1:*";
  options.preview_endpoint = "tcp://127.0.0.1:*";
  Publisher publisher(options);
  const Shot one = shot();
  const Reduction its = reduction();
  v1::Shot shot_message;
  v1::Result result_message;
  for (auto _ : state) {
    wire::encode(one, "store/shots/1.h5", shot_message);
    publisher.publish_shot(shot_message);
    wire::encode(its, one.id, result_message);
    publisher.publish_result(result_message);
  }
}
BENCHMARK(encode_and_publish_shot_and_result);

void decode_shot_and_result(benchmark::State& state) {
  v1::Shot shot_message;
  v1::Result result_message;
  wire::encode(shot(), "store/shots/1.h5", shot_message);
  wire::encode(reduction(), "1", result_message);
  const std::string first = wire::serialise(shot_message);
  const std::string second = wire::serialise(result_message);
  for (auto _ : state) {
    v1::Shot received_shot;
    v1::Result received_result;
    wire::parse(first, "shot", received_shot);
    wire::parse(second, "result", received_result);
    benchmark::DoNotOptimize(wire::decode(received_shot).channels.data());
    benchmark::DoNotOptimize(wire::decode(received_result).stress_Pa.data());
  }
  count_bytes(state, first.size() + second.size());
}
BENCHMARK(decode_shot_and_result);

}  // namespace
}  // namespace kolsky
