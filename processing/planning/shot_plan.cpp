#include "processing/planning/shot_plan.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/specimen/shpb_model.hpp"
#include "processing/uncertainty/noise.hpp"
#include "processing/waves/transform.hpp"

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

/// Each gauge at a station of its own, in the bench's order, and where each stands in the model's.
std::vector<ShpbStation> one_station_per_gauge(const Bench& bench) {
  std::vector<ShpbStation> stations;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    stations.push_back({{i}, gauge.bar == "input", bench.distance_to_specimen_m(gauge)});
  }
  std::stable_sort(
      stations.begin(), stations.end(), [](const ShpbStation& a, const ShpbStation& b) {
        return a.on_input != b.on_input ? a.on_input : a.to_specimen_m > b.to_specimen_m;
      });
  return stations;
}

double slowest_m_per_s(const Bench& bench, const Material& bars) {
  return std::min(front_speed_m_per_s(bench.input, *compliance_of(bench.input, bars)),
                  front_speed_m_per_s(*bench.output, *compliance_of(*bench.output, bars)));
}

/// Strain at each gauge, in the bench's order.
std::vector<std::vector<double>> strains_of(const Bench& bench, const Material& bars,
                                            const Material& specimen, const PlannedPulse& pulse) {
  const double longest_m = std::max<double>(bench.input.length_m, bench.output->length_m);
  const double record_s = kQuiet_s + pulse.duration_s() +
                          (bench.input.length_m + 4.0 * longest_m) / slowest_m_per_s(bench, bars);
  const double period_s = 1.0 / bench.sampling_frequency_Hz;
  const auto samples = static_cast<std::size_t>(record_s / period_s);
  DampedTransform transform(samples, period_s);
  std::vector<double> record(transform.length(), 0.0);
  for (std::size_t n = 0; n < samples; ++n) {
    record[n] = pulse.force_N(static_cast<double>(n) * period_s - kQuiet_s);
  }
  std::vector<Complex> force(transform.bins());
  transform.forward(record, force);
  std::vector<Complex> path;
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    path.push_back(transform.s(k));
  }
  const auto stations = one_station_per_gauge(bench);
  ShpbModel model(stations);
  const BarPrior prior(bars);
  const MovedShpb moved(bench, stations, prior, {}, {});
  ShpbTheory theory;
  theory.specimen = bench.specimen->density_kg_m3 ? SpecimenWaves::rod : SpecimenWaves::massless;
  std::vector<std::vector<Complex>> transfers;
  std::vector<Complex> first_per_N;
  model.evaluate(theory, moved, ThreeElementSolid(specimen), path, 0, transfers, &first_per_N);
  std::vector<std::vector<double>> strains(bench.gauges.size());
  std::vector<Complex> spectrum(transform.bins());
  for (std::size_t j = 0; j < stations.size(); ++j) {
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      spectrum[k] = force[k] * first_per_N[k] * (j == 0 ? 1.0 : transfers[j - 1][k]);
    }
    transform.inverse(spectrum, record);
    strains[stations[j].channels.front()].assign(
        record.begin(), record.begin() + static_cast<std::ptrdiff_t>(samples));
  }
  return strains;
}

ChannelRecord record_of(const Gauge& gauge, const BridgeConversion& bridge,
                        const std::vector<double>& strain, double noise_strain,
                        RandomStream& random) {
  std::vector<double> readings;
  for (const double value : strain) {
    readings.push_back(bridge.reading(value + noise_strain * random.normal()));
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

}  // namespace

ShotPlan plan_shot(const Bench& bench, const Material& bars, const Material& specimen,
                   const PlannedPulse& pulse, const PlanOptions& options) {
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
  plan.shot.id = "plan";
  plan.shot.bench = bench;
  plan.shot.rate = SampleRate::from_Hz(bench.sampling_frequency_Hz);
  const auto strains = strains_of(bench, bars, specimen, pulse);
  RandomStream random(1, 0);
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    const BridgeConversion bridge(gauge, bench.bar_of(gauge), bench.positive);
    plan.shot.channels.push_back(
        record_of(gauge, bridge, strains[i], options.noise_strain, random));
    const auto [low, high] = std::minmax_element(strains[i].begin(), strains[i].end());
    plan.gauges.push_back(
        {gauge.name, gauge.unit, *high, *low,
         std::max(std::abs(bridge.reading(*high)), std::abs(bridge.reading(*low)))});
  }
  ReductionOptions reduction;
  reduction.bar_model = bars;
  plan.reduction = Reducer(reduction).reduce(plan.shot);
  if (const Quality& quality = plan.reduction.quality; !quality.reducible) {
    throw InputError("plan", quality.reason, quality.mend);
  }
  plan.summary = summarise(plan.reduction);
  plan.quotable = quotable_part(plan.reduction);

  const double speed_in = front_speed_m_per_s(bench.input, *compliance_of(bench.input, bars));
  const double speed_out = front_speed_m_per_s(*bench.output, *compliance_of(*bench.output, bars));
  plan.whole_pulse_m = 0.5 * speed_in * (pulse.duration_s() + pulse.rise_s);
  plan.window_s = 2.0 * shpb_stations(bench).front().to_specimen_m / speed_in;
  plan.returns_s = 2.0 * bench.input.length_m / speed_in;
  if (bench.output->far_end == FarEnd::free) {
    plan.returns_s = std::min(plan.returns_s, 2.0 * bench.output->length_m / speed_out);
  }
  const double density = bench.specimen->density_kg_m3.value_or(specimen.density_kg_m3);
  const double settled_Pa = specimen.E1_Pa * specimen.E2_Pa / (specimen.E1_Pa + specimen.E2_Pa);
  plan.specimen_transit_s = bench.specimen->length_m / std::sqrt(settled_Pa / density);
  return plan;
}

}  // namespace kolsky
