// Comparing a shot with a model, and asking eight bar shots or six split-bar shots what a model
// lacks: each beside one forward evaluation of all their records, which any fit is made of. Then
// fifteen impacts at three speeds, made by another code.
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>
#include <vector>

#include "processing/criticism/comparing/comparison.hpp"
#include "processing/criticism/impact/impact_diagnosis.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/two_threads.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/impact_campaign.hpp"

namespace kolsky {
namespace {

enum class Kind { bar, shpb };

std::vector<Shot> shots_with(Kind kind, int shots, const char* effect) {
  testing::CampaignWishes wishes{.seed = 77,
                                 .shots = shots,
                                 .gauges = kind == Kind::bar ? 4 : 3,
                                 .samples = 2048,
                                 .rate_Hz = 1e6,
                                 .split = kind == Kind::shpb};
  testing::Campaign made = testing::draw_campaign(wishes);
  if (effect != nullptr) {
    testing::hide(made, testing::parse_effect(effect));
  }
  return testing::shots_of(made);
}

Model model_of(Kind kind, const std::vector<Shot>& shots) {
  if (kind == Kind::bar) {
    return paper_model(BenchKind::bar, false);
  }
  return paper_model(BenchKind::shpb, shots.front().bench.input.youngs_modulus_Pa.has_value());
}

/// As the daemon does it after a shot's reduction.
void compare_one_shot(benchmark::State& state, Kind kind) {
  const std::vector<Shot> shots = shots_with(kind, 3, nullptr);
  const Campaign all = read_campaign(shots);
  Study fitting(all, 0.0, Workers{});
  const Model model = fitting.fit(model_of(kind, shots)).model;
  for (auto _ : state) {
    const Campaign one = read_campaign({shots.front()});
    Study study(one, 0.0, Workers{});
    const Studied studied = study.as_it_is(model);
    benchmark::DoNotOptimize(compare(study, studied));
  }
  hold_to(state, 2e-3);
}
BENCHMARK_CAPTURE(compare_one_shot, bar, Kind::bar)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare_one_shot, shpb, Kind::shpb)->Unit(benchmark::kMillisecond);

void diagnose_shots(benchmark::State& state, Kind kind, int count, const char* effect) {
  const std::vector<Shot> shots = shots_with(kind, count, effect);
  const Campaign campaign = read_campaign(shots);
  const Model model = model_of(kind, shots);
  Study forward(campaign, 0.0, Workers{});
  const Studied studied = forward.fit(model);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  constexpr int kEvaluations = 10;
  for (int n = 0; n < kEvaluations; ++n) {
    // Elsewhere each time: nothing of the one before serves.
    std::vector<double> theta = studied.fit.theta;
    theta.front() += 1e-4 * n;
    benchmark::DoNotOptimize(forward.residuals().evaluate(studied.composition, theta));
  }
  const double evaluation_s =
      std::chrono::duration<double>(Clock::now() - begin).count() / kEvaluations;
  std::string found;
  const Clock::time_point start = Clock::now();
  for (auto _ : state) {
    Study study(campaign, 0.0, two_threads());
    const Diagnosis diagnosis = diagnose(study, model, {});
    found = diagnosis.effects.empty() ? name_of(diagnosis.verdict) : diagnosis.effects.front();
  }
  const double diagnosis_s = std::chrono::duration<double>(Clock::now() - start).count() /
                             static_cast<double>(state.iterations());
  hold_to(state, kind == Kind::bar ? 1.0 : 5.0);
  state.counters["evaluations"] = diagnosis_s / evaluation_s;
  state.SetLabel(found);
}
BENCHMARK_CAPTURE(diagnose_shots, bar_nothing_hidden, Kind::bar, 8, nullptr)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose_shots, bar_position, Kind::bar, 8, "gauge-position:g2=0.004")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose_shots, bar_relaxation, Kind::bar, 8,
                  "second-relaxation=5e-12,tau=100e-6")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose_shots, shpb_nothing_hidden, Kind::shpb, 6, nullptr)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose_shots, shpb_friction, Kind::shpb, 6, "interface-friction=0.3")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// A ball whose materials are known to 1.5 %.
Model known_ball() {
  constexpr double kKnown = 0.015;
  Model model = paper_model(BenchKind::impact, true);
  for (const auto& [id, paper] : {std::pair{"three-element-core", paper_golf_core()},
                                  std::pair{"three-element-cover", paper_golf_cover()}}) {
    Material material = paper;
    for (Measured* const number : {&material.E1_Pa(), &material.E2_Pa(), &material.eta2_Pa_s()}) {
      number->sd = kKnown * number->value;
    }
    take_layer(material, *model.find(id));
  }
  return model;
}

void diagnose_fifteen_impacts(benchmark::State& state, double core_b, double bridge_b,
                              double core_damage) {
  testing::ImpactWishes wishes;
  wishes.seed = 77;
  wishes.speed_error = 1e-3;
  wishes.across = 15;
  wishes.core_b = core_b;
  wishes.bridge_b = bridge_b;
  wishes.core_damage = core_damage;
  const Campaign campaign = read_campaign(testing::impact_shots(wishes));
  std::string found;
  for (auto _ : state) {
    ImpactStudy study(campaign, JudgedStretch::to_reflection, 0.0, two_threads());
    const Diagnosis diagnosis = diagnose_impacts(study, known_ball(), {});
    found = name_of(diagnosis.verdict);
    for (const std::string& id : diagnosis.effects) {
      found += " " + id;
    }
  }
  hold_to(state, 60.0);
  state.SetLabel(found);
}
BENCHMARK_CAPTURE(diagnose_fifteen_impacts, nothing_hidden, 0.0, 0.0, 0.0)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose_fifteen_impacts, one_effect, 0.9, 0.0, 0.0)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();
BENCHMARK_CAPTURE(diagnose_fifteen_impacts, two_effects, 0.6, 240.0, 0.0)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();
// Damage is no effect of the library.
BENCHMARK_CAPTURE(diagnose_fifteen_impacts, effect_not_in_library, 0.0, 0.0, 0.6)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();

}  // namespace
}  // namespace kolsky
