#include "tests/unit/reduction/solved_bench.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/generators/elastic_shpb.hpp"

namespace kolsky::testing {

namespace {

Bar bar_of(const RodShape& rod, const Bar& like) {
  Bar bar = like;
  bar.length_m = {rod.length_m};
  bar.diameter_m = {2.0 * std::sqrt(rod.area_m2 / std::numbers::pi)};
  bar.density_kg_m3 = {rod.material.density_kg_m3};
  bar.youngs_modulus_Pa.reset();
  if (rod.material.elastic()) {
    bar.youngs_modulus_Pa = Measured{rod.material.E1_Pa};
  }
  return bar;
}

}  // namespace

double circle_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

BenchRecords records_of(const BenchModel& model, double record_s) {
  const auto steps_per_sample = static_cast<std::size_t>(std::lround(kPeriod_s / kStep_s));
  const BenchHistory history =
      run_bench(model, kStep_s, static_cast<std::size_t>(std::lround(record_s / kStep_s)));
  BenchRecords records;
  for (const auto& strain : history.gauge_strain) {
    records.strains.emplace_back(kPreSamples, 0.0);
    for (std::size_t n = 0; n < strain.size(); n += steps_per_sample) {
      records.strains.back().push_back(strain[n]);
    }
  }
  records.truth = *history.specimen;
  return records;
}

Bench bench_of(const BenchModel& model) {
  Bench bench = ElasticShpb{}.bench();
  bench.input = bar_of(model.input, bench.input);
  bench.output = bar_of(*model.output, *bench.output);
  const Gauge like = bench.gauges.front();
  bench.gauges.clear();
  for (const GaugeStation& station : model.gauges) {
    Gauge& gauge = bench.gauges.emplace_back(like);
    gauge.name = "g" + std::to_string(bench.gauges.size());
    gauge.bar = station.rod == RodId::input ? "input" : "output";
    gauge.position_m = {station.position_m};
  }
  const Bar specimen = bar_of(*model.specimen, bench.input);
  bench.specimen = Specimen{.length_m = specimen.length_m, .diameter_m = specimen.diameter_m};
  bench.specimen->density_kg_m3 = specimen.density_kg_m3;
  return bench;
}

SolvedShot shot_of(const BenchModel& model, const BenchRecords& records, double noise_rms,
                   double range_strain, unsigned seed) {
  return {
      digitise(bench_of(model), records.strains, noise_rms, noise_rms > 0.0 ? 16 : 24, range_strain,
               seed),
      records.truth,
      kPreSamples * kPeriod_s + model.input.length_m / model.input.material.front_speed_m_per_s()};
}

double worst(const Reduction& r, const std::vector<double>& reduced, const SolvedShot& solved,
             const std::vector<double>& exact) {
  double largest = 0.0;
  double difference = 0.0;
  for (std::size_t n = 0; n < reduced.size(); ++n) {
    const double t = r.time_s[n] + r.arrival_s - solved.front_arrival_s;
    const double index = std::max(0.0, (t - solved.truth.time_s.front()) / kStep_s);
    const auto i = std::min(static_cast<std::size_t>(index), exact.size() - 2);
    const double share = index - static_cast<double>(i);
    const double expected = exact[i] * (1.0 - share) + exact[i + 1] * share;
    largest = std::max(largest, std::abs(expected));
    difference = std::max(difference, std::abs(reduced[n] - expected));
  }
  return difference / largest;
}

const Check& check_of(const Reduction& r, const std::string& name) {
  for (const Check& check : r.quality.checks) {
    if (check.name == name) {
      return check;
    }
  }
  throw std::out_of_range(name);
}

}  // namespace kolsky::testing
