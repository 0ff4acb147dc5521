#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/simulated/bench_model.hpp"
#include "processing/reduction/reducer.hpp"
#include "tests/accuracy/table.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky::accuracy {
namespace {

constexpr double kStep_s = 0.1e-6;
constexpr std::size_t kStepsPerSample = 10;
constexpr std::size_t kSteps = 37'000;
constexpr std::size_t kPreSamples = 400;
constexpr double kLength_m = 0.7;
constexpr double kDiameter_m = 0.015;
constexpr double kSpecimenDiameter_m = 0.012;
constexpr RodMaterial kPmma{1180.0, 5.66e9, 37.0e9, 1.81e6};

double circle_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

Bench bench_of(double specimen_length_m) {
  Bench bench = testing::ElasticShpb{}.bench();
  bench.input.length_m = {kLength_m};
  bench.input.diameter_m = {kDiameter_m};
  bench.input.density_kg_m3 = {kPmma.density_kg_m3};
  bench.input.youngs_modulus_Pa.reset();
  bench.output = bench.input;
  bench.gauges[0].position_m = {0.4};
  bench.gauges[1].position_m = {0.05};
  bench.specimen = Specimen{.length_m = {specimen_length_m}, .diameter_m = {kSpecimenDiameter_m}};
  return bench;
}

/// Largest difference as a share of the truth's largest value.
double worst(const Reduction& r, const std::vector<double>& reduced, double arrival_s,
             const SpecimenHistory& truth, const std::vector<double>& exact) {
  double largest = 0.0;
  double difference = 0.0;
  for (std::size_t n = 0; n < reduced.size(); ++n) {
    const double index = (r.time_s[n] + r.arrival_s - arrival_s - truth.time_s.front()) / kStep_s;
    const auto i = static_cast<std::size_t>(std::max(0.0, index));
    const double share = index - static_cast<double>(i);
    const double expected = exact[i] * (1.0 - share) + exact[i + 1] * share;
    largest = std::max(largest, std::abs(expected));
    difference = std::max(difference, std::abs(reduced[n] - expected));
  }
  return difference / largest;
}

/// The paper's bench solved in the time domain.
struct Solved {
  BenchHistory history;
  Shot shot;
};

Solved solve(const RodMaterial& material, double length_m, double noise_strain) {
  const RodShape bar{kLength_m, circle_m2(kDiameter_m), kPmma};
  BenchModel model;
  model.input = bar;
  model.output = bar;
  model.specimen = RodShape{length_m, circle_m2(kSpecimenDiameter_m), material};
  model.pulse.peak_force_N = kPmma.E1_Pa * bar.area_m2 * 1e-3;
  model.gauges = {{RodId::input, 0.4}, {RodId::output, 0.05}};
  Solved solved{run_bench(model, kStep_s, kSteps), {}};
  std::vector<std::vector<double>> records;
  for (const auto& strain : solved.history.gauge_strain) {
    records.emplace_back(kPreSamples, 0.0);
    for (std::size_t n = 0; n < strain.size(); n += kStepsPerSample) {
      records.back().push_back(strain[n]);
    }
  }
  constexpr int kFineCodes = 24;
  solved.shot = testing::digitise(bench_of(length_m), records, noise_strain, kFineCodes, 0.01, 1);
  return solved;
}

void add(const char* name, const RodMaterial& material, double length_m, Section& section) {
  const auto [history, shot] = solve(material, length_m, 0.0);
  const Reduction r = Reducer().reduce(shot);
  const double arrival_s = kPreSamples * 1e-6 + kLength_m / kPmma.front_speed_m_per_s();
  const SpecimenHistory& truth = *history.specimen;
  const auto off = [&](const std::vector<double>& found, const std::vector<double>& exact) {
    return fmt::format("{:.1g}", worst(r, found, arrival_s, truth, exact));
  };
  section.rows.push_back(
      {name, fmt::format("{:.0f}", 1e6 * r.time_s.back()), off(r.stress_Pa, truth.stress_Pa),
       off(r.strain, truth.strain), off(r.strain_rate_per_s, truth.strain_rate_per_s),
       off(r.force_front_N, truth.force_front_N), off(r.force_back_N, truth.force_back_N)});
}

constexpr RodMaterial kCore{1140.0, 121e6, 143e6, 2860.0};
constexpr RodMaterial kCover{960.0, 987e6, 452e6, 6020.0};

}  // namespace

std::optional<Section> rubber_equilibrium() {
  Section section{
      "Equilibrium of rubber under a 170 us pulse",
      "rms(front - back) over the mean force of the loading, the paper's bench solved in the time "
      "domain, 4 microstrain of noise. Reference: `physics.md`, for another pulse of that length. "
      "The limit is 7 %.",
      {"specimen", "reference [%]", "ours [%]", "verdict"},
      {}};
  const auto add_row = [&](const char* name, const RodMaterial& material, double length_m,
                           const char* reference) {
    const Reduction r = Reducer().reduce(solve(material, length_m, 4e-6).shot);
    const Check& check = *r.quality.find("equilibrium");
    section.rows.push_back({name, reference, fmt::format("{:.3g}", 100.0 * check.value),
                            check.verdict == Verdict::pass ? "in equilibrium" : "not"});
  };
  add_row("core, 4 mm", kCore, 0.004, "4.5 to 5");
  add_row("core, 6 mm", kCore, 0.006, "9 to 11");
  add_row("cover, 6 mm", kCover, 0.006, "3.4");
  return section;
}

std::optional<Section> reduced_shots() {
  Section section{
      "Reduced shots",
      "The paper's bench solved in the time domain (staggered grid, no transform), no "
      "noise: largest difference of each history until the first return, as a share of "
      "its largest value.",
      {"specimen", "until [us]", "stress", "strain", "rate", "front force", "back force"},
      {}};
  add("core, 4 mm", kCore, 0.004, section);
  add("core, 6 mm", kCore, 0.006, section);
  add("cover, 4 mm", kCover, 0.004, section);
  return section;
}

}  // namespace kolsky::accuracy
