#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

namespace kolsky {

/// Prints a bound on the time of one iteration over that time: 1 or more where it is kept.
inline void hold_to(benchmark::State& state, double bound_s) {
  state.counters["bound_over_time"] =
      benchmark::Counter(bound_s, benchmark::Counter::kIsIterationInvariantRate);
}

/// Prints the time of one iteration over that of the transforms it cannot do without.
inline void beside_transforms(benchmark::State& state, double transforms_s) {
  state.counters["of_transforms"] = benchmark::Counter(
      transforms_s, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// The best of many: what else the machine does only adds.
template <typename Work>
double best_time_s(int times, Work work) {
  using Clock = std::chrono::steady_clock;
  double best_s = 1e9;
  for (int i = 0; i < times; ++i) {
    const Clock::time_point begin = Clock::now();
    work();
    best_s = std::min(best_s, std::chrono::duration<double>(Clock::now() - begin).count());
  }
  return best_s;
}

}  // namespace kolsky
