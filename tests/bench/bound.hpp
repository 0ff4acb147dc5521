#pragma once

#include <benchmark/benchmark.h>

namespace kolsky {

/// Prints a bound on the time of one iteration over that time: 1 or more where it is kept.
inline void hold_to(benchmark::State& state, double bound_s) {
  state.counters["bound_over_time"] =
      benchmark::Counter(bound_s, benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace kolsky
