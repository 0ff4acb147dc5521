#include "processing/criticism/verdict/unlisted.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/verdict/at_bounds.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {

namespace {

/// Between the times of amplifiers, which the library has, and a share that is as good as constant.
constexpr double kQuickest_s = 30e-6;
constexpr double kSlowest_s = 50e-3;
/// Of 3000 microstrain nearly a fifth.
constexpr double kMostCurved = 2e4;

class CreepingGauge final : public Effect {
 public:
  CreepingGauge()
      : Effect({
            .id = "creeping-gauge",
            .stage = Stage::sensor,
            .definition = "reading x (1 + c / (1 + s tau))",
            .reference = "docs/methods/diagnosis.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{.name = "c", .unit = "-", .lower = -1.0, .upper = 1.0, .typical = 0.01},
                           {.name = "tau",
                            .unit = "s",
                            .lower = kQuickest_s,
                            .upper = kSlowest_s,
                            .typical = 1e-4,
                            .starts = {100e-6, 5e-3}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      scene.gauges[gauge].factor[k] *= 1.0 + values[0] / (1.0 + scene.s[k] * values[1]);
    }
  }
};

class CurvedReading final : public Effect {
 public:
  CurvedReading(const char* id, bool of_one)
      : Effect({
            .id = id,
            .stage = Stage::record,
            .definition = "reading = e (1 + c e^2)",
            .reference = "docs/methods/diagnosis.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{.name = "c",
                            .unit = "-",
                            .lower = -kMostCurved,
                            .upper = kMostCurved,
                            .typical = 100.0}},
            .per_gauge = of_one,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    const double c = values[0];
    const RecordMap curve = [c](std::span<const std::complex<double>> strain,
                                std::span<std::complex<double>> reading) {
      std::ranges::transform(strain, reading.begin(),
                             [c](const auto& e) { return e * (1.0 + c * e * e); });
    };
    scene.record.maps.resize(scene.gauges.size());
    for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
      if (c != 0.0 && (!about().per_gauge || j == gauge)) {
        scene.record.maps[j].push_back(curve);
      }
    }
  }
};

const Effect& creeping_gauge() {
  static const CreepingGauge effect;
  return effect;
}

const Effect& curved_gauge() {
  static const CurvedReading effect("curved-gauge", true);
  return effect;
}

const Effect& curved_readings() {
  static const CurvedReading effect("curved-readings", false);
  return effect;
}

const EffectUse& use_in(const Model& fitted) {
  return *std::ranges::find_if(fitted.effects, [](const EffectUse& use) {
    return use.effect == &creeping_gauge() || use.effect == &curved_gauge() ||
           use.effect == &curved_readings();
  });
}

/// What it is and its verb.
std::string shape_text(const EffectUse& use) {
  const double strength = use.values[0].value;
  if (use.effect == &creeping_gauge()) {
    return fmt::format("a reading of {} that {} by {:.2g} % within {:.0f} us explains", use.gauge,
                       strength < 0.0 ? "droops" : "creeps", 100.0 * std::abs(strength),
                       1e6 * use.values[1].value);
  }
  constexpr double kAt = 1e-3;
  const std::string much =
      fmt::format("{:.2g} % too {} at 1000 microstrain of either sign",
                  100.0 * kAt * kAt * std::abs(strength), strength < 0.0 ? "small" : "large");
  return use.gauge.empty() ? fmt::format("readings that are {} explain", much)
                           : fmt::format("a reading of {} that is {} explains", use.gauge, much);
}

std::string mend_text(const EffectUse& use) {
  if (use.effect == &creeping_gauge()) {
    return "look at its bond and at how its amplifier is coupled, or add it by a formula of your "
           "own (docs/methods/expressions.md, stage `sensor`: 1 + c / (1 + s*tau))";
  }
  return fmt::format(
      "look at the range of amplifiers and digitiser, or add it by a formula of your own "
      "(docs/methods/expressions.md, stage `record`{}: strain * (1 + c*strain^2))",
      use.gauge.empty() ? "" : ", `per_gauge = true`");
}

std::vector<Model> with_unlisted(const Model& model, const Bench& bench) {
  std::vector<Model> list;
  const auto add = [&](const Effect& effect, const std::string& gauge) -> EffectUse& {
    return list.emplace_back(model).effects.emplace_back(null_use(effect, gauge));
  };
  add(curved_readings(), "");
  for (const Gauge& gauge : bench.gauges) {
    for (const double start_s : creeping_gauge().about().parameters[1].starts) {
      add(creeping_gauge(), gauge.name).values[1].value = start_s;
    }
    add(curved_gauge(), gauge.name);
  }
  return list;
}

/// @param as_much  it explains as much as two effects and more do, not nearly all that is unknown
std::string text_of(const Model& fitted, bool as_much) {
  const EffectUse& use = use_in(fitted);
  return fmt::format("{} {}, which no effect of the library is: {}", shape_text(use),
                     as_much ? "as much as these effects" : "nearly all of it", mend_text(use));
}

/// Far more than noise does, with next to nothing left, and far ahead of the others of a kind.
bool explains_nearly_all(const Study& study, const Studied& before, const Studied& best,
                         const std::vector<Studied>& others) {
  constexpr double kNearlyAll = 0.9;
  constexpr double kAhead = 0.2;
  constexpr double kDeviations = 3.0;
  const double noise = noise_of(best.misfit, study.campaign().shots.size());
  const double explained = (before.fit.objective() - best.fit.objective()) / noise;
  const double of_noise = std::sqrt(2.0 * best.misfit.degrees_of_freedom);  // in chi2
  const double left = std::max(0.0, repeated_excess(study, best) - of_noise);
  const std::string own = use_in(best.model).id();
  return explained > std::max(kDeviations * of_noise, kNearlyAll * (explained + left)) &&
         std::ranges::all_of(others, [&](const Studied& other) {
           return use_in(other.model).id() == own ||
                  other.fit.objective() - best.fit.objective() > kAhead * noise * explained;
         });
}

}  // namespace

std::optional<std::string> unlisted_in_place_of(Study& study, const Studied& before,
                                                const Studied& current, std::size_t effects,
                                                bool unknown) {
  if (study.campaign().gauges() < 3 || (!unknown && effects < 2)) {
    return std::nullopt;
  }
  std::vector<Studied> fits;
  for (const Model& model : with_unlisted(before.model, study.campaign().bench)) {
    fits.push_back(changed(study, before, model));
  }
  const auto best =
      std::ranges::min_element(fits, {}, [](const Studied& own) { return own.fit.objective(); });
  const bool tells = unknown ? explains_nearly_all(study, before, *best, fits)
                             : best->fit.objective() < current.fit.objective();
  return tells && numbers_at_bounds(best->model).empty()
             ? std::optional(text_of(best->model, !unknown))
             : std::nullopt;
}

}  // namespace kolsky
