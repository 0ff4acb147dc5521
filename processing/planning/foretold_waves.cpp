#include "processing/planning/foretold_waves.hpp"

#include <algorithm>
#include <cmath>

#include "processing/planning/pulse_transform.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/specimen/shpb_model.hpp"

namespace kolsky {

namespace {

constexpr double kUnloaded = 0.1;  // of the peak stress

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

/// Until waves have gone to and fro in the longer bar twice.
double record_s(const Bench& bench, const Material& bars, const PlannedPulse& pulse) {
  const double longest_m = std::max<double>(bench.input.length_m, bench.output->length_m);
  return pulse.duration_s() +
         (bench.input.length_m + 4.0 * longest_m) / slowest_m_per_s(bench, bars);
}

/// A whole part of the sampling period, small beside the pulse's rise.
std::size_t steps_per_sample(double period_s, double rise_s) {
  constexpr double kStepsInRise = 64.0;
  return static_cast<std::size_t>(
      std::clamp(std::ceil(kStepsInRise * period_s / rise_s), 1.0, 64.0));
}

std::vector<double> every(std::size_t count, std::size_t first, const std::vector<double>& all) {
  std::vector<double> some;
  for (std::size_t n = first; n < all.size(); n += count) {
    some.push_back(all[n]);
  }
  return some;
}

/// Samples until a tenth of the peak stress is left after the first loading.
std::size_t unloaded(const Reduction& r) {
  const std::size_t loaded = loading_end(r);
  const auto end = r.stress_Pa.begin() + static_cast<std::ptrdiff_t>(loaded);
  const double peak_Pa = *std::max_element(r.stress_Pa.begin(), end);
  const auto below = std::find_if(
      end, r.stress_Pa.end(), [&](double stress_Pa) { return stress_Pa < kUnloaded * peak_Pa; });
  return static_cast<std::size_t>(below - r.stress_Pa.begin());
}

/// From the pulse's arrival on, to the record's end.
Reduction specimen_histories(const Specimen& specimen, const ShpbPerForce& per_N,
                             PulseTransform& transform, double arrival_s, std::size_t per_sample) {
  const auto first = static_cast<std::size_t>(std::ceil(arrival_s / transform.step_s()));
  const auto history = [&](const std::vector<Complex>& response) {
    return every(per_sample, first, transform.history(response));
  };
  std::vector<Complex> rate(per_N.first.size());
  std::vector<Complex> strain(per_N.first.size());
  for (std::size_t k = 0; k < rate.size(); ++k) {
    rate[k] = (per_N.velocity_front_m_per_s[k] - per_N.velocity_back_m_per_s[k]) /
              specimen.length_m.value;
    strain[k] = rate[k] / transform.path()[k];
  }
  Reduction r;
  r.force_front_N = history(per_N.force_front);
  r.force_back_N = history(per_N.force_back);
  r.strain_rate_per_s = history(rate);
  r.strain = history(strain);
  const double to_arrival_s = static_cast<double>(first) * transform.step_s() - arrival_s;
  const double sample_s = static_cast<double>(per_sample) * transform.step_s();
  for (std::size_t n = 0; n < r.strain.size(); ++n) {
    r.time_s.push_back(to_arrival_s + static_cast<double>(n) * sample_s);
    r.stress_Pa.push_back((r.force_front_N[n] + r.force_back_N[n]) / (2.0 * specimen.area_m2()));
  }
  r.arrival_s = arrival_s;
  r.quality.reducible = true;
  return r;
}

void keep(Reduction& r, std::size_t count) {
  for (auto* history : {&r.time_s, &r.stress_Pa, &r.strain, &r.strain_rate_per_s, &r.force_front_N,
                        &r.force_back_N}) {
    history->resize(std::min(count, history->size()));
  }
}

}  // namespace

ForetoldWaves foretell_waves(const Bench& bench, const Material& bars, const Material& specimen,
                             const PlannedPulse& pulse, double quiet_s, double returns_s) {
  const double period_s = 1.0 / bench.sampling_frequency_Hz;
  ForetoldWaves foretold;
  foretold.steps_per_sample = steps_per_sample(period_s, pulse.rise_s);
  foretold.step_s = period_s / static_cast<double>(foretold.steps_per_sample);
  PulseTransform transform(pulse, quiet_s, quiet_s + record_s(bench, bars, pulse), foretold.step_s);

  const auto stations = one_station_per_gauge(bench);
  ShpbModel model(stations);
  const MovedShpb moved(bench, stations, BarPrior(bars), {}, {});
  ShpbTheory theory;
  theory.specimen = bench.specimen->density_kg_m3 ? SpecimenWaves::rod : SpecimenWaves::massless;
  std::vector<std::vector<Complex>> transfers;
  ShpbPerForce per_N;
  model.evaluate(theory, moved, *compliance_of(specimen), transform.path(), 0, transfers, &per_N);

  foretold.gauge_strain.resize(bench.gauges.size());
  std::vector<Complex> reading(transform.path().size());
  for (std::size_t j = 0; j < stations.size(); ++j) {
    for (std::size_t k = 0; k < reading.size(); ++k) {
      reading[k] = per_N.first[k] * (j == 0 ? 1.0 : transfers[j - 1][k]);
    }
    foretold.gauge_strain[stations[j].channels.front()] = transform.history(reading);
  }
  const double arrival_s =
      quiet_s +
      bench.input.length_m / front_speed_m_per_s(bench.input, *compliance_of(bench.input, bars));
  foretold.specimen =
      specimen_histories(*bench.specimen, per_N, transform, arrival_s, foretold.steps_per_sample);
  keep(foretold.specimen,
       std::max(unloaded(foretold.specimen), static_cast<std::size_t>(returns_s / period_s)));
  return foretold;
}

}  // namespace kolsky
