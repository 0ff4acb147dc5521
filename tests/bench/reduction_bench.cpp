// A shot of 2 x 4096 samples through the reducer, beside the bare transforms it needs (three there,
// six back).
#include <benchmark/benchmark.h>
#include <fftw3.h>

#include <algorithm>

#include "processing/reduction/reducer.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kSamples = 4096;

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
}
BENCHMARK(reduce)->Unit(benchmark::kMicrosecond);

void bare_transforms(benchmark::State& state) {
  double* time = fftw_alloc_real(kSamples);
  fftw_complex* frequency = fftw_alloc_complex(kSamples / 2 + 1);
  fftw_plan there = fftw_plan_dft_r2c_1d(kSamples, time, frequency, FFTW_ESTIMATE);
  fftw_plan back = fftw_plan_dft_c2r_1d(kSamples, frequency, time, FFTW_ESTIMATE);
  std::fill_n(time, kSamples, 1e-3);
  for (auto _ : state) {
    for (int i = 0; i < 3; ++i) {
      fftw_execute(there);
    }
    for (int i = 0; i < 6; ++i) {
      fftw_execute(back);
    }
    std::fill_n(time, kSamples, 1e-3);
    benchmark::ClobberMemory();
  }
  fftw_destroy_plan(there);
  fftw_destroy_plan(back);
  fftw_free(time);
  fftw_free(frequency);
}
BENCHMARK(bare_transforms)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kolsky
