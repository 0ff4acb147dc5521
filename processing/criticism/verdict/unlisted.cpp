#include "processing/criticism/verdict/unlisted.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/verdict/at_bounds.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/criticism/verdict/unexplained.hpp"
#include "processing/criticism/verdict/unlisted_effects.hpp"

namespace kolsky {

namespace {

const EffectUse& use_in(const Model& fitted) {
  return *std::ranges::find_if(fitted.effects, [](const EffectUse& use) {
    return use.effect == &creeping_gauge() || use.effect == &curved_gauge() ||
           use.effect == &curved_readings() || use.effect == &changing_gauge();
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
  if (use.effect == &changing_gauge()) {
    return fmt::format("a reading of {} that is {:.2g} % {} from {:.0f} us after the foot explains",
                       use.gauge, 100.0 * std::abs(strength), strength < 0.0 ? "less" : "more",
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
  if (use.effect == &changing_gauge()) {
    return "look at its bond, its plugs and its ranges";
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

/// With a gain that changes at the gauge and the time where it explains most to first order.
Model with_changing_gauge(Study& study, const Studied& before) {
  std::vector<EffectUse> uses;
  for (const Gauge& gauge : study.campaign().bench.gauges) {
    for (const double start_s : changing_gauge().about().parameters[1].starts) {
      uses.push_back(null_use(changing_gauge(), gauge.name));
      uses.back().values[1].value = start_s;
      uses.back().values[1].free = uses.back().values[2].free = false;
      uses.back().values[2].value = changing_gauge().about().parameters[2].starts.front();
    }
  }
  std::vector<double> gains(uses.size());
  study.executor().run(uses.size(), [&](std::size_t i, std::size_t worker) {
    gains[i] = direction_of({.use = uses[i]}, before, study, worker).gain;
  });
  const auto most = std::ranges::max_element(gains) - gains.begin();
  return with(before.model, {.use = uses[static_cast<std::size_t>(most)]}, Auxiliaries::free);
}

std::string text_of(const Model& fitted, InPlaceOf what) {
  const EffectUse& use = use_in(fitted);
  return fmt::format("{} {}, which no effect of the library is: {}", shape_text(use),
                     what == InPlaceOf::claims ? "as much as these effects" : "nearly all of it",
                     mend_text(use));
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

/// A gain that differs between shots is in part one of all shots, which a fit that takes the rest
/// for noise finds and believes to be all: what is there in every shot leaves shots as far apart as
/// they were. Of true bends that only nearly have the shape it left up to 0.64 of the evidence, of
/// gains that differ 0.99 and more.
bool leaves_shots_apart(Study& study, const Studied& before, const Studied& best) {
  constexpr double kApart = -6.9;  // ln of one in a thousand
  constexpr double kAsMuch = 0.8;
  const double left = unexplained(study, best).apart.log_p;
  return left < kApart && left < kAsMuch * unexplained(study, before).apart.log_p;
}

/// Whether it went to the end of what it may be, where that is another thing. A change may be as
/// sudden as it likes.
bool at_its_end(const Model& fitted) {
  const std::string own = use_in(fitted).id();
  return std::ranges::any_of(numbers_at_bounds(fitted), [&](const AtBound& number) {
    return number.effect != own || number.parameter != "w" || number.most;
  });
}

}  // namespace

std::optional<std::string> unlisted_in_place_of(Study& study, const Studied& before,
                                                const Studied& current, std::size_t effects,
                                                InPlaceOf what) {
  if (study.campaign().gauges() < 3 || (what == InPlaceOf::claims && effects < 2)) {
    return std::nullopt;
  }
  std::vector<Studied> fits;
  std::vector<Model> models = with_unlisted(before.model, study.campaign().bench);
  models.push_back(with_changing_gauge(study, before));
  for (const Model& model : models) {
    fits.push_back(changed(study, before, model));
  }
  const auto best =
      std::ranges::min_element(fits, {}, [](const Studied& own) { return own.fit.objective(); });
  const bool tells = what == InPlaceOf::all ? explains_nearly_all(study, before, *best, fits) &&
                                                  !leaves_shots_apart(study, before, *best)
                                            : best->fit.objective() < current.fit.objective();
  return tells && !at_its_end(best->model) ? std::optional(text_of(best->model, what))
                                           : std::nullopt;
}

}  // namespace kolsky
