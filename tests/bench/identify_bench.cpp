// What identifying a bar costs, beside the transforms that reading the records takes alone.
#include <benchmark/benchmark.h>

#include <random>

#include "processing/identification/bar_fit.hpp"
#include "processing/identification/bar_identification.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/transform.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/two_threads.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/solid_bar_shots.hpp"
#include "tests/generators/table4.hpp"

namespace {

using namespace kolsky;

const std::vector<Shot>& ten_shots() {
  static const std::vector<Shot> shots = [] {
    testing::BarShots::Setup setup;
    setup.material = testing::kTable4[0].material;
    const testing::BarShots generator(setup);
    std::mt19937_64 random(1);
    testing::BarShots::Recording recording;
    recording.gain_sd = 0.01;
    recording.position_sd_m = 0.2e-3;
    return generator.draw(10, recording, random);
  }();
  return shots;
}

/// The same on a bar with lateral inertia, as exact theory has it.
const std::vector<Shot>& ten_shots_of_solid() {
  static const std::vector<Shot> shots = [] {
    const testing::SolidBarShots generator(testing::kTable4[0]);
    std::mt19937_64 random(1);
    return generator.draw({}, random);
  }();
  return shots;
}

/// Of every record of ten shots with four gauges, there.
double transforms_of_ten_shots_s() {
  const std::size_t samples = ten_shots().front().samples();
  DampedTransform transform(samples, 1e-6);
  std::vector<Complex> spectrum(transform.bins());
  const std::vector<double> record(samples, 1e-3);
  return best_time_s(100, [&] {
    for (std::size_t i = 0; i < 40; ++i) {
      transform.forward(record, spectrum);
      benchmark::DoNotOptimize(spectrum.data());
    }
  });
}

/// Each theory on records that it holds for, and exact theory on those that it does not: there the
/// search is longer.
void fit_ten_shots(benchmark::State& state, WaveTheory theory, bool solid) {
  const auto& shots = solid ? ten_shots_of_solid() : ten_shots();
  for (auto _ : state) {
    benchmark::DoNotOptimize(fit_bar(shots, {.theory = theory}));
  }
  hold_to(state, 0.05);
  beside_transforms(state, transforms_of_ten_shots_s());
}
BENCHMARK_CAPTURE(fit_ten_shots, elementary, WaveTheory::elementary, false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit_ten_shots, exact, WaveTheory::exact, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit_ten_shots, exact_of_elementary, WaveTheory::exact, false)
    ->Unit(benchmark::kMillisecond);

/// All of it: wave theories, far ends and families of solids tried, and the spectra.
void identify_ten_shots(benchmark::State& state, bool solid) {
  const auto& shots = solid ? ten_shots_of_solid() : ten_shots();
  const Workers two = two_threads();
  for (auto _ : state) {
    benchmark::DoNotOptimize(identify_bar(shots, {}, two));
  }
  hold_to(state, 0.05);
  beside_transforms(state, transforms_of_ten_shots_s());
}
BENCHMARK_CAPTURE(identify_ten_shots, thin, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(identify_ten_shots, solid, true)->Unit(benchmark::kMillisecond)->UseRealTime();

void exact_dispersion_to_60_kHz(benchmark::State& state) {
  Bar bar;
  bar.length_m = {2.0};
  bar.diameter_m = {0.020};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  const ThreeElementSolid pmma(5.66e9, 37.0e9, 1.81e6);
  const DampedTransform transform(4096, 1e-6);
  std::vector<Complex> path;
  for (std::size_t k = 0; static_cast<double>(k) * transform.bin_width_Hz() <= 60e3; ++k) {
    path.push_back(transform.s(k));
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(bar_modes(WaveTheory::exact, bar, pmma, path));
  }
  hold_to(state, 0.02);
  state.counters["frequencies"] = static_cast<double>(path.size());
}
BENCHMARK(exact_dispersion_to_60_kHz)->Unit(benchmark::kMillisecond);

}  // namespace
