#include "tests/generators/elastic_shpb.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace kolsky::testing {

namespace {

constexpr double kStep_s = 1e-8;

double smooth_pulse(double t_s, double rise_s, double length_s) {
  if (t_s <= 0.0 || t_s >= length_s) {
    return 0.0;
  }
  const double edge = std::min(t_s, length_s - t_s);
  return edge >= rise_s ? 1.0 : 0.5 * (1.0 - std::cos(std::numbers::pi * edge / rise_s));
}

double interpolate(const std::vector<double>& history, double index) {
  if (index < 0.0) {
    return 0.0;
  }
  const auto n = static_cast<std::size_t>(index);
  if (n + 1 >= history.size()) {
    return history.back();
  }
  const double share = index - static_cast<double>(n);
  return history[n] * (1.0 - share) + history[n + 1] * share;
}

}  // namespace

double ElasticShpb::Truth::at(const std::vector<double>& history, double time_s) const {
  return interpolate(history, time_s / step_s);
}

ElasticShpb::Records ElasticShpb::solve() const {
  const double c = std::sqrt(youngs_modulus_Pa / density_kg_m3);
  const double Z = density_kg_m3 * c;
  const double A = std::numbers::pi * diameter_m * diameter_m / 4.0;
  const double As = std::numbers::pi * specimen_diameter_m * specimen_diameter_m / 4.0;
  const double stiffness = specimen_modulus_Pa * As / specimen_length_m;
  const double arrival = foot_at_gauge_s + gauge_to_A_m / c;
  const double return_in = 2.0 * length_in_m / c;
  const double return_out = 2.0 * length_out_m / c;
  const double peak = youngs_modulus_Pa * pulse_strain;

  // Time runs from the arrival at A. Stress waves at the interfaces, compression positive.
  const auto steps = static_cast<std::size_t>(duration_s / kStep_s);
  std::vector<double> right_A(steps), left_A(steps), right_B(steps), left_B(steps);
  Truth truth;
  truth.arrival_s = arrival;
  truth.step_s = kStep_s;
  double force = 0.0;
  double strain = 0.0;
  for (std::size_t n = 0; n < steps; ++n) {
    const double t = static_cast<double>(n) * kStep_s;
    right_A[n] =
        peak * smooth_pulse(t, rise_s, pulse_s) - interpolate(left_A, (t - return_in) / kStep_s);
    left_B[n] = -interpolate(right_B, (t - return_out) / kStep_s);
    left_A[n] = force / A - right_A[n];
    right_B[n] = force / A - left_B[n];
    const double rate =
        ((right_A[n] - left_A[n]) - (right_B[n] - left_B[n])) / Z / specimen_length_m;
    truth.strain.push_back(strain);
    truth.strain_rate_per_s.push_back(rate);
    truth.force_N.push_back(force);
    // The spring relaxes exactly over a step with the waves held.
    const double drive = A * (right_A[n] + left_B[n]);
    const double decay = std::exp(-2.0 * stiffness / (A * Z) * kStep_s);
    const double next = drive + (force - drive) * decay;
    strain += (next - force) / stiffness / specimen_length_m;
    force = next;
  }

  Records records;
  const auto samples = static_cast<std::size_t>(duration_s * sampling_frequency_Hz);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / sampling_frequency_Hz - arrival;
    const auto before_A = [&](double distance_m) {
      return interpolate(right_A, (t + distance_m / c) / kStep_s) +
             interpolate(left_A, (t - distance_m / c) / kStep_s);
    };
    const double out = interpolate(right_B, (t - gauge_to_B_m / c) / kStep_s) +
                       interpolate(left_B, (t + gauge_to_B_m / c) / kStep_s);
    records.input_strain.push_back(before_A(gauge_to_A_m) / youngs_modulus_Pa);
    if (second_to_A_m) {
      records.second_strain.push_back(before_A(*second_to_A_m) / youngs_modulus_Pa);
    }
    records.output_strain.push_back(out / youngs_modulus_Pa);
  }
  records.truth = std::move(truth);
  return records;
}

Bench ElasticShpb::bench() const {
  Bench bench;
  bench.kind = BenchKind::shpb;
  bench.sampling_frequency_Hz = {sampling_frequency_Hz, 0.0};
  bench.input = {.length_m = {length_in_m},
                 .diameter_m = {diameter_m},
                 .density_kg_m3 = {density_kg_m3},
                 .poisson_ratio = {0.3},
                 .youngs_modulus_Pa = Measured{youngs_modulus_Pa},
                 .side_m = {}};
  bench.output = bench.input;
  bench.output->length_m = {length_out_m};
  bench.gauges = {{.name = "g1",
                   .bar = "input",
                   .position_m = {length_in_m - gauge_to_A_m},
                   .unit = "strain",
                   .length_m = {},
                   .bridge = {},
                   .strain_per_V = {}},
                  {.name = "g2",
                   .bar = "output",
                   .position_m = {gauge_to_B_m},
                   .unit = "strain",
                   .length_m = {},
                   .bridge = {},
                   .strain_per_V = {}}};
  if (second_to_A_m) {
    bench.gauges.push_back(bench.gauges.front());
    bench.gauges.back().name = "g3";
    bench.gauges.back().position_m = {length_in_m - *second_to_A_m};
  }
  bench.specimen = Specimen{.length_m = {specimen_length_m},
                            .diameter_m = {specimen_diameter_m},
                            .density_kg_m3 = {},
                            .poisson_ratio = {}};
  return bench;
}

Shot ElasticShpb::shot(const Records& records, double noise_rms, int bits, double range_strain,
                       unsigned seed) const {
  std::vector<std::vector<double>> strains{records.input_strain, records.output_strain};
  if (second_to_A_m) {
    strains.push_back(records.second_strain);
  }
  return digitise(bench(), strains, noise_rms, bits, range_strain, seed);
}

Shot digitise(const Bench& bench, const std::vector<std::vector<double>>& strains, double noise_rms,
              int bits, double range_strain, unsigned seed) {
  Shot shot;
  shot.id = "generated";
  shot.bench = bench;
  shot.rate = SampleRate::from_Hz(bench.sampling_frequency_Hz);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const double full = std::ldexp(1.0, bits - 1);
  for (std::size_t i = 0; i < strains.size(); ++i) {
    ChannelRecord channel;
    channel.gauge = bench.gauges[i].name;
    channel.unit = "strain";
    channel.bits = bits;
    channel.scale = range_strain / full;
    channel.code_min = static_cast<std::int32_t>(-full);
    channel.code_max = static_cast<std::int32_t>(full - 1);
    for (const double strain : strains[i]) {
      const double code = std::round((strain + noise_rms * noise(random)) / channel.scale);
      channel.codes.push_back(static_cast<std::int32_t>(std::clamp(code, -full, full - 1)));
    }
    shot.channels.push_back(std::move(channel));
  }
  return shot;
}

}  // namespace kolsky::testing
