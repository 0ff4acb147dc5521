#include "processing/reduction/reducer.hpp"

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/ball/ball_reducer.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/shpb_pass.hpp"

namespace kolsky {

namespace {

std::string describe(const Bench& bench, const Material& viscoelastic, bool assumed) {
  const bool elastic_input = bench.input.youngs_modulus_Pa.has_value();
  const bool elastic_output = bench.output->youngs_modulus_Pa.has_value();
  if (elastic_input && elastic_output) {
    return "elastic bars, moduli from the bench";
  }
  std::string text = viscoelastic.source.empty() ? "the bar model given" : viscoelastic.source;
  if (assumed) {
    text += ", assumed because no bar model was given";
  }
  return text;
}

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

void require_band_of_record(const std::optional<double>& band_limit_Hz, const Shot& shot) {
  const double most_Hz = shot.rate.Hz() / 2.0;
  if (band_limit_Hz && !(*band_limit_Hz > 0.0 && *band_limit_Hz <= most_Hz)) {
    throw InputError("band_limit_Hz",
                     in_words(*band_limit_Hz, "Hz") +
                         " is not in the record, which was sampled at " +
                         in_words(shot.rate.Hz(), "Hz"),
                     "give at most half of that");
  }
}

}  // namespace

struct Reducer::State {
  ReductionOptions options;
  std::unique_ptr<ShpbPlans> plans;
  std::unique_ptr<ShpbTables> tables;
  BallReducer ball{};
};

Reducer::Reducer(ReductionOptions options) : state_(std::make_unique<State>()) {
  state_->options = std::move(options);
}
Reducer::~Reducer() = default;
Reducer::Reducer(Reducer&&) noexcept = default;
Reducer& Reducer::operator=(Reducer&&) noexcept = default;

void Reducer::set_bar_model(const Material& material) {
  state_->options.bar_model = material;
}

void Reducer::set_push_goes_on(double share) {
  state_->options.push_goes_on = share;
}

Reduction Reducer::reduce(const Shot& shot) {
  require_band_of_record(state_->options.band_limit_Hz, shot);
  if (shot.bench.kind == BenchKind::impact) {
    return state_->ball.reduce(shot, state_->options);
  }
  require_reducible_bench(shot);
  const std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    return not_reducible(unusable, kRepeatOrLeaveOut);
  }
  ReductionOptions options = state_->options;
  const bool assumed = !options.bar_model && !shot.bar_model;
  const Material material = options.bar_model ? *options.bar_model
                            : shot.bar_model  ? *shot.bar_model
                                              : assumed_bars(shot.bench);
  if (!options.bar_model && shot.bar_model) {
    require_bar_model_holds(material, shot, "the capture's bar model");
    require_band_known(material, options.band_limit_Hz, "the capture's bar model");
  }
  if (!options.most_band_Hz && material.identified) {
    options.most_band_Hz = material.identified->band_limit_Hz;
  }
  const Station in = station_on(shot.bench, "input");
  const Station out = station_on(shot.bench, "output");
  std::vector<double> numbers = shpb_numbers(shot.bench, material, options.theory, in, out);
  const ShpbBar input(shot.bench.input, in, material);
  const ShpbBar output(*shot.bench.output, out, material);
  const ShpbPlanKey plan = ShpbPlanKey::of(shot, input, output);
  if (!state_->plans || !(state_->plans->key == plan)) {
    state_->plans = std::make_unique<ShpbPlans>(plan);
  }
  if (!state_->tables || state_->tables->numbers != numbers || !(state_->tables->plan == plan)) {
    state_->tables = std::make_unique<ShpbTables>(std::move(numbers), plan, options.theory,
                                                  shot.bench, material, in, out);
  }
  Reduction reduction = shpb_pass(shot, in, out, options, *state_->plans, *state_->tables);
  reduction.bar_model = describe(shot.bench, material, assumed);
  return reduction;
}

}  // namespace kolsky
