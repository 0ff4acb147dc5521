// A shot of 2 x 4096 samples through the reducer, beside the bare transforms it needs (three there,
// six back).
#include <benchmark/benchmark.h>
#include <fftw3.h>

#include <algorithm>

#include "processing/reduction/reducer.hpp"
#include "processing/specimen/specimen_fit.hpp"
#include "processing/uncertainty/monte_carlo.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/two_threads.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/linear_shpb.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kSamples = 4096;
constexpr double kBound_s = 0.25e-3;  ///< of a reduction

/// Three transforms there and six back, which a reduction cannot do without.
class BareTransforms {
 public:
  BareTransforms()
      : time_(fftw_alloc_real(kSamples)),
        frequency_(fftw_alloc_complex(kSamples / 2 + 1)),
        there_(fftw_plan_dft_r2c_1d(kSamples, time_, frequency_, FFTW_ESTIMATE)),
        back_(fftw_plan_dft_c2r_1d(kSamples, frequency_, time_, FFTW_ESTIMATE)) {}
  ~BareTransforms() {
    fftw_destroy_plan(there_);
    fftw_destroy_plan(back_);
    fftw_free(time_);
    fftw_free(frequency_);
  }
  BareTransforms(const BareTransforms&) = delete;
  BareTransforms& operator=(const BareTransforms&) = delete;

  void once() {
    std::fill_n(time_, kSamples, 1e-3);
    for (int i = 0; i < 3; ++i) fftw_execute(there_);
    for (int i = 0; i < 6; ++i) fftw_execute(back_);
    benchmark::ClobberMemory();
  }

 private:
  double* time_;
  fftw_complex* frequency_;
  fftw_plan there_;
  fftw_plan back_;
};

double best_transforms_s() {
  BareTransforms transforms;
  return best_time_s(2000, [&] { transforms.once(); });
}

/// @param reductions  in one iteration, by as many threads as `threads`
void beside_reductions(benchmark::State& state, double reductions = 1.0, double threads = 1.0) {
  beside_transforms(state, best_transforms_s() * reductions / threads);
}

Shot paper_like_shot() {
  testing::ElasticShpb model;
  model.duration_s = static_cast<double>(kSamples) * 1e-6;
  Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 1);
  shot.bench_toml = std::string(1200, '#');
  return shot;
}

void reduce(benchmark::State& state) {
  const Shot shot = paper_like_shot();
  Reducer reducer;
  if (!reducer.reduce(shot).quality.reducible) {
    state.SkipWithError("not reducible");
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(reducer.reduce(shot));
  }
  hold_to(state, kBound_s);
  beside_reductions(state);
}
BENCHMARK(reduce)->Unit(benchmark::kMicrosecond);

/// A shot on viscoelastic bars with exact dispersion; `anew`: tables and all, as for a first shot.
void reduce_exact(benchmark::State& state) {
  const bool anew = state.range(0) != 0;
  testing::LinearShpb model;
  model.record_s = static_cast<double>(kSamples) * 1e-6;
  const Shot shot = testing::digitise(model.bench(), model.solve(), 4e-6, 16, 0.005, 1);
  ReductionOptions options;
  options.theory = WaveTheory::exact;
  Reducer reducer(options);
  for (auto _ : state) {
    if (anew) {
      benchmark::DoNotOptimize(Reducer(options).reduce(shot));
    } else {
      benchmark::DoNotOptimize(reducer.reduce(shot));
    }
  }
  if (!anew) {
    hold_to(state, kBound_s);
    beside_reductions(state);
  }
}
BENCHMARK(reduce_exact)->ArgName("anew")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

/// A pulse that outlasts the window, told apart by two gauges on the input bar.
void reduce_separated(benchmark::State& state, WaveTheory theory) {
  testing::ElasticShpb model;
  model.duration_s = static_cast<double>(kSamples) * 1e-6;
  model.pulse_s = 500e-6;
  model.second_to_A_m = 0.8;
  const Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 1);
  ReductionOptions options;
  options.theory = theory;
  Reducer reducer(options);
  if (reducer.reduce(shot).separation != Separation::gauges) {
    state.SkipWithError("not separated");
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(reducer.reduce(shot));
  }
}
BENCHMARK_CAPTURE(reduce_separated, elementary, WaveTheory::elementary)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(reduce_separated, exact, WaveTheory::exact)->Unit(benchmark::kMillisecond);

/// 1000 draws on two threads, the budget included.
void monte_carlo(benchmark::State& state) {
  testing::LinearShpb model;
  model.record_s = static_cast<double>(kSamples) * 1e-6;
  Shot shot = testing::digitise(model.bench(), model.solve(), 4e-6, 16, 0.005, 1);
  for (Gauge& gauge : shot.bench.gauges) {
    gauge.position_m.sd = 0.2e-3;
  }
  shot.bench.input.diameter_m.sd = shot.bench.output->diameter_m.sd = 0.02e-3;
  shot.bench.input.density_kg_m3.sd = 3.0;
  shot.bench.specimen->length_m.sd = 0.01e-3;
  shot.bench.temperature_K = Measured{296.0, 0.5};
  const Reduction reduction = Reducer().reduce(shot);
  const Workers two = two_threads();
  const UncertaintyOptions options;
  for (auto _ : state) {
    benchmark::DoNotOptimize(propagate(shot, {}, reduction, options, two));
  }
  hold_to(state, 0.5);
  beside_reductions(state, static_cast<double>(options.draws), 2.0);
}
BENCHMARK(monte_carlo)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// Ten shots of the paper's core, every set of assumptions tried.
void identify_specimen(benchmark::State& state) {
  testing::LinearShpb model;
  const auto records = model.solve();
  std::vector<Shot> shots;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    shots.push_back(testing::digitise(model.bench(), records, 4e-6, 16, 0.005, seed));
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(fit_specimen(shots, BarPrior(paper_pmma()), {}));
  }
}
BENCHMARK(identify_specimen)->Unit(benchmark::kMillisecond);

void bare_transforms(benchmark::State& state) {
  BareTransforms transforms;
  for (auto _ : state) transforms.once();
}
BENCHMARK(bare_transforms)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kolsky
