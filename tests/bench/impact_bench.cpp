// How long an impact takes, and how that compares with the arithmetic of its element loop alone.
#include <benchmark/benchmark.h>

#include <vector>

#include "processing/impact/body.hpp"
#include "processing/impact/impact.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/impact_peak.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace {

using namespace kolsky;
using namespace kolsky::impact;

// Operations of the linear element with one arm, counted in its machine code: 48 + 40 additions,
// 314 products and 325 fused pairs per lane.
constexpr double kFlopsPerElement = 88.0 + 314.0 + 2.0 * 325.0;

// @param work  elements times steps
void count_work(benchmark::State& state, std::size_t work) {
  state.counters["ns_per_element_step"] = benchmark::Counter(
      1e-9 * static_cast<double>(work), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["GFlops"] = benchmark::Counter(1e-9 * kFlopsPerElement * static_cast<double>(work),
                                                benchmark::Counter::kIsRate);
}

void impact_of(benchmark::State& state, TargetKind target, double nonlinearity) {
  ImpactModel model = testing::paper_impact(40.3, target);
  model.elements = static_cast<std::size_t>(state.range(0));
  model.layers[0].solid.nonlinearity = nonlinearity;
  std::size_t work = 0;
  std::size_t steps = 0;
  for (auto _ : state) {
    const ImpactHistory history = simulate(model);
    benchmark::DoNotOptimize(history.restitution);
    work += history.elements * history.steps;
    steps = history.steps;
  }
  state.counters["steps"] = static_cast<double>(steps);
  count_work(state, work);
}

// What an impact on a dashpot may take, by its elements; none: no bound.
double bound_s(std::size_t elements) {
  return elements == 512 ? 0.03 : elements == 2048 ? 0.15 : 0.0;
}

void linear(benchmark::State& state) {
  impact_of(state, TargetKind::dashpot, 0.0);
  if (const double bound = bound_s(static_cast<std::size_t>(state.range(0))); bound > 0.0) {
    kolsky::hold_to(state, bound);
  }
}

// A kernel that this processor runs; none where it does not.
const ElementKernel* kernel_at(std::size_t number, benchmark::State& state) {
  std::size_t count = 0;
  const ElementKernel* const* const kernels = runnable_kernels(count);
  if (number >= count) {
    state.SkipWithError("this processor does not run it");
    return nullptr;
  }
  state.SetLabel(kernels[number]->name);
  return kernels[number];
}

// The whole impact by each of the kernels.
void impact_by(benchmark::State& state, std::size_t number) {
  const ElementKernel* const kernel = kernel_at(number, state);
  if (kernel == nullptr) {
    return;
  }
  ImpactModel model = testing::paper_impact(40.3);
  std::size_t work = 0;
  for (auto _ : state) {
    const ImpactHistory history = simulate(model, {}, *kernel);
    benchmark::DoNotOptimize(history.restitution);
    work += history.elements * history.steps;
  }
  count_work(state, work);
}

// The arithmetic floor: fused products and additions in registers, on vectors as wide as those of
// a kernel.
void peak(benchmark::State& state, std::size_t number) {
  const ElementKernel* const kernel = kernel_at(number, state);
  if (kernel == nullptr) {
    return;
  }
  const testing::FusedLoop fused = testing::fused_in_registers(kernel->lanes);
  double flops = 0.0;
  for (auto _ : state) {
    flops += fused();
  }
  state.counters["GFlops"] = benchmark::Counter(1e-9 * flops, benchmark::Counter::kIsRate);
}

// The element loop alone, on state that stays in the cache.
void element_loop(benchmark::State& state, std::size_t number) {
  const ElementKernel* const kernel = kernel_at(number, state);
  if (kernel == nullptr) {
    return;
  }
  const ImpactModel model = testing::paper_impact(40.3);
  const std::vector<double> diameters_m = {model.layers[0].outer_diameter_m,
                                           model.layers[1].outer_diameter_m};
  Body body(ball_mesh(diameters_m, 2048), {model.layers[0].solid, model.layers[1].solid}, *kernel);
  body.set_steps(3e-7, 3e-7);
  for (auto _ : state) {
    benchmark::DoNotOptimize(body.find_forces(false));
  }
  const double work =
      static_cast<double>(body.mesh().elements()) * static_cast<double>(state.iterations());
  state.counters["ns_per_element"] =
      benchmark::Counter(1e-9 * work, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["GFlops"] =
      benchmark::Counter(1e-9 * kFlopsPerElement * work, benchmark::Counter::kIsRate);
}

}  // namespace

BENCHMARK(linear)
    ->Name("impact_of/dashpot")
    ->Arg(512)
    ->Arg(2048)
    ->Arg(8192)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(impact_of, nonlinear, TargetKind::dashpot, 0.5)
    ->Arg(512)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(impact_by, portable, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(impact_by, avx2, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(impact_by, avx512, 2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(peak, avx2, 1);
BENCHMARK_CAPTURE(peak, avx512, 2);
BENCHMARK_CAPTURE(element_loop, portable, 0);
BENCHMARK_CAPTURE(element_loop, avx2, 1);
BENCHMARK_CAPTURE(element_loop, avx512, 2);
