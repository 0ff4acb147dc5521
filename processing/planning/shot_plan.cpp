#include "processing/planning/shot_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/planning/foretold_waves.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/specimen/shpb_records.hpp"
#include "processing/uncertainty/noise.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

namespace {

constexpr double kQuiet_s = 300e-6;
constexpr int kBits = 24;
constexpr double kRoom = 1.5;  // of the converter's range over the signal

double largest(const std::vector<double>& record) {
  double most = 0.0;
  for (const double value : record) {
    most = std::max(most, std::abs(value));
  }
  return most;
}

ChannelRecord record_of(const Gauge& gauge, const BridgeConversion& bridge,
                        const std::vector<double>& strain, std::size_t steps_per_sample,
                        double noise_strain, RandomStream& random) {
  std::vector<double> readings;
  for (std::size_t n = 0; n < strain.size(); n += steps_per_sample) {
    readings.push_back(bridge.reading(strain[n] + noise_strain * random.normal()));
  }
  ChannelRecord channel;
  channel.gauge = gauge.name;
  channel.unit = gauge.unit;
  channel.bits = kBits;
  const double full = std::ldexp(1.0, kBits - 1);
  channel.code_min = static_cast<std::int32_t>(-full);
  channel.code_max = static_cast<std::int32_t>(full - 1.0);
  channel.scale = kRoom * largest(readings) / full;
  for (const double reading : readings) {
    channel.codes.push_back(static_cast<std::int32_t>(std::lround(reading / channel.scale)));
  }
  return channel;
}

/// A specimen has a mass, whichever file says so: without one both faces would always agree.
Bench with_specimens_mass(Bench bench, const Material& specimen) {
  if (bench.specimen && !bench.specimen->density_kg_m3) {
    bench.specimen->density_kg_m3 = specimen.density_kg_m3;
  }
  return bench;
}

}  // namespace

ShotPlan plan_shot(const Bench& filed, const Material& bars, const Material& specimen,
                   const PlannedPulse& pulse, const PlanOptions& options) {
  const Bench bench = with_specimens_mass(filed, specimen);
  if (bench.kind != BenchKind::shpb || !bench.output || !bench.specimen) {
    throw InputError("kind", "is not \"shpb\", so there is no specimen to plan for",
                     "use a bench file of kind \"shpb\" with bars.output and specimen");
  }
  if (!options.bars_assumed) {
    require_bar_model_holds(bars, bench, "the bar model");
  }
  (void)shpb_stations(bench);  // both bars have a gauge
  ShotPlan plan;
  plan.pulse = pulse;
  const double speed_in = front_speed_m_per_s(bench.input, *compliance_of(bench.input, bars));
  const double speed_out = front_speed_m_per_s(*bench.output, *compliance_of(*bench.output, bars));
  plan.whole_pulse_m = 0.5 * speed_in * (pulse.duration_s() + pulse.rise_s);
  plan.window_s = 2.0 * shpb_stations(bench).front().to_specimen_m / speed_in;
  plan.returns_s = 2.0 * bench.input.length_m / speed_in;
  if (bench.output->far_end == FarEnd::free) {
    plan.returns_s = std::min(plan.returns_s, 2.0 * bench.output->length_m / speed_out);
  }
  ForetoldWaves waves = foretell_waves(bench, bars, specimen, pulse, kQuiet_s, plan.returns_s);
  plan.specimen = std::move(waves.specimen);
  plan.summary = summarise(plan.specimen);
  plan.equilibrium = quotable_part(plan.specimen);

  plan.shot.id = "plan";
  plan.shot.bench = bench;
  plan.shot.rate = SampleRate::from_Hz(bench.sampling_frequency_Hz);
  RandomStream random(1, 0);
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    const std::vector<double>& strain = waves.gauge_strain[i];
    const BridgeConversion bridge(gauge, bench.bar_of(gauge), bench.positive);
    plan.shot.channels.push_back(
        record_of(gauge, bridge, strain, waves.steps_per_sample, options.noise_strain, random));
    const auto [low, high] = std::minmax_element(strain.begin(), strain.end());
    plan.gauges.push_back(
        {gauge.name, gauge.unit, *high, *low,
         std::max(std::abs(bridge.reading(*high)), std::abs(bridge.reading(*low)))});
  }
  ReductionOptions reduction;
  reduction.bar_model = bars;
  plan.reduction = Reducer(reduction).reduce(plan.shot);
  plan.quotable = quotable_part(plan.reduction);

  plan.specimen_transit_s = bench.specimen->length_m / std::sqrt(relaxed_modulus_Pa(specimen) /
                                                                 *bench.specimen->density_kg_m3);
  return plan;
}

}  // namespace kolsky
