#include "processing/reduction/reducer.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/ball/ball_reducer.hpp"
#include "processing/reduction/finite.hpp"
#include "processing/reduction/gauge_order.hpp"
#include "processing/reduction/gauge_sign.hpp"
#include "processing/reduction/gauge_silent.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/recent.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/reduction/shpb_pass.hpp"
#include "processing/reduction/true_values.hpp"

namespace kolsky {

namespace {

void require_reducible_bench(const Shot& shot) {
  if (shot.bench.kind == BenchKind::bar) {
    throw InputError("kind", "is \"bar\", a bar by itself: there is no specimen to reduce",
                     "`kolsky identify bar` finds its moduli; a specimen wants a bench of kind "
                     "\"shpb\"");
  }
  if (!shot.bench.output || !shot.bench.specimen) {
    throw InputError("kind", "is \"shpb\", but there is no specimen between two bars to reduce",
                     "file bars.output and specimen");
  }
  if (shot.channels.size() != shot.bench.gauges.size()) {
    throw InputError("gauges",
                     std::to_string(shot.bench.gauges.size()) + " are filed but the shot has " +
                         std::to_string(shot.channels.size()) + " channels",
                     "file one gauge per channel, in their order");
  }
}

/// A check of how the gauges are connected, into a quality that something is wrong with.
void tell(std::optional<Check> check, Quality& quality) {
  if (check && quality.reducible) {
    quality.checks.push_back(*std::move(check));
  } else if (check) {
    quality.mend = check->text + (check->text.ends_with('?') ? " Else " : "; else ") + quality.mend;
  }
}

/// A bench whose gauges are exchanged or read with the other sign spoils every number and names
/// none: where the bars' work does not add up, forces have a sign that they cannot have, or nothing
/// can be reduced, the first pulse is looked at, at every gauge.
void ask_how_gauges_are_connected(const Shot& shot, Reduction& reduction) {
  Quality& quality = reduction.quality;
  if (!quality.reducible || signs_in_doubt(shot, reduction)) {
    tell(gauge_sign(shot), quality);
  }
  const Check* energy = quality.find("energy_balance");
  const bool adds_up = energy != nullptr && energy->verdict == Verdict::pass;
  if (!adds_up || quality.verdict() == Verdict::fail) {
    tell(gauge_order(shot), quality);
    tell(gauge_silent(shot), quality);
  }
}

/// What is no number must not pass for a result, whatever made it. Of a strain that no bar bears
/// that is why.
Reduction of_numbers(Reduction reduction) {
  const bool numbers = all_finite(reduction.time_s) && all_finite(reduction.stress_Pa) &&
                       all_finite(reduction.strain) && all_finite(reduction.strain_rate_per_s) &&
                       all_finite(reduction.force_front_N) && all_finite(reduction.force_back_N) &&
                       all_finite(reduction.incident) && all_finite(reduction.reflected) &&
                       all_finite(reduction.transmitted) &&
                       !(reduction.ball && !all_finite(reduction.ball->force_N));
  if (numbers) {
    return reduction;
  }
  const Check* strain = reduction.quality.find("bar_strain");
  return not_reducible(
      strain != nullptr ? strain->text : "what was recorded comes out as no finite numbers",
      kCheckPlacesAndBars);
}

/// What fails is read first.
void put_failures_first(std::vector<Check>& checks) {
  std::stable_partition(checks.begin(), checks.end(),
                        [](const Check& c) { return c.verdict == Verdict::fail; });
}

}  // namespace

struct Reducer::State {
  ReductionOptions options;
  Recent<ShpbPlans> plans;
  Recent<ShpbTables> tables;
  BallReducer ball{};

  /// Of a specimen.
  Reduction reduce(const Shot& shot);
};

Reducer::Reducer(ReductionOptions options) : state_(std::make_unique<State>()) {
  state_->options = std::move(options);
}
Reducer::~Reducer() = default;
Reducer::Reducer(Reducer&&) noexcept = default;
Reducer& Reducer::operator=(Reducer&&) noexcept = default;

void Reducer::set_options(ReductionOptions options) {
  state_->options = std::move(options);
}

void Reducer::set_bar_model(const Material& material) {
  state_->options.bar_model = material;
}

void Reducer::set_push_goes_on(double share) {
  state_->options.push_goes_on = share;
}

void Reducer::set_band_limit_Hz(double limit_Hz) {
  state_->options.band_limit_Hz = limit_Hz;
}

std::size_t Reducer::tables_made() const {
  return state_->tables.made();
}

Reduction Reducer::reduce(const Shot& shot) {
  const ReductionOptions& options = state_->options;
  require_band_of_record(options.band_limit_Hz, shot.rate.Hz());
  const bool is_ball = shot.bench.kind == BenchKind::impact;
  Reduction reduction =
      of_numbers(is_ball ? state_->ball.reduce(shot, options) : state_->reduce(shot));
  reduction.theory = options.theory;
  reduction.stress_from = options.stress;
  reduction.corrections = options.corrections;
  if (options.with_true) {
    reduction.strain_true = true_strain(reduction);
    reduction.stress_true_Pa = true_stress_Pa(reduction);
  }
  return reduction;
}

Reduction Reducer::State::reduce(const Shot& shot) {
  require_reducible_bench(shot);
  const std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    return not_reducible(unusable, kRepeatOrLeaveOut);
  }
  ReductionOptions told = options;
  const bool assumed = !told.bar_model && !shot.bar_model;
  require_own_material_holds(shot);
  const Material material = told.bar_model   ? *told.bar_model
                            : shot.bar_model ? *shot.bar_model
                                             : assumed_bars(shot.bench);
  if (!told.bar_model && shot.bar_model) {
    require_bar_model_holds(material, shot, "the capture's bar model");
    require_band_known(material, told.band_limit_Hz, "the capture's bar model");
  }
  if (!told.most_band_Hz) {
    told.most_band_Hz = known_band_Hz(shot.bench, material);
  }
  const BarStation in = station_on(shot.bench, "input");
  const BarStation out = station_on(shot.bench, "output");
  std::vector<double> numbers = shpb_numbers(shot.bench, material, told.theory, in, out);
  const ShpbBar input(shot.bench.input, in, material);
  const ShpbBar output(*shot.bench.output, out, material);
  const ShpbPlanKey plan = ShpbPlanKey::of(shot, input, output, told.theory);
  ShpbPlans& own_plans = plans.get([&](const ShpbPlans& known) { return known.key == plan; },
                                   [&] { return std::make_unique<ShpbPlans>(plan); });
  ShpbTables& own_tables = tables.get(
      [&](const ShpbTables& known) { return known.numbers == numbers && known.plan == plan; },
      [&] {
        return std::make_unique<ShpbTables>(std::move(numbers), plan, told.theory, shot.bench,
                                            material, in, out);
      });
  Reduction reduction = ShpbPass(shot, in, out, told, own_plans, own_tables).run();
  ask_how_gauges_are_connected(shot, reduction);
  put_failures_first(reduction.quality.checks);
  reduction.bar_model =
      all_elastic(shot.bench)
          ? "elastic bars, moduli from the bench"
          : viscoelastic_in_words(shot.bench, assumed ? std::nullopt : std::optional(material));
  return reduction;
}

}  // namespace kolsky
