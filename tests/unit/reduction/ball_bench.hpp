#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky::testing {

/// The paper's titanium bar with a ball of the paper's mass, gauges where they are asked for.
inline Bench ball_bench(const std::vector<double>& positions_m = {0.25}) {
  Bench bench;
  bench.kind = BenchKind::impact;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {3.0};
  bench.input.diameter_m = {0.027};
  bench.input.density_kg_m3 = {4420.0};
  bench.input.poisson_ratio = {0.33};
  bench.input.youngs_modulus_Pa = Measured{113e9};
  bench.ball = Ball{{0.0427}, {0.03565}, Measured{0.0434}, false};
  for (const double position_m : positions_m) {
    Gauge gauge;
    gauge.name = "g" + std::to_string(bench.gauges.size() + 1);
    gauge.bar = "input";
    gauge.position_m = {position_m};
    gauge.unit = "strain";
    bench.gauges.push_back(gauge);
  }
  return bench;
}

/// A push of the peak force and duration given, sin^1.5: it starts as a sphere's contact does.
struct Push {
  double peak_N = 9400.0;
  double duration_s = 450e-6;

  [[nodiscard]] double force_N(double time_s) const {
    const double phase = time_s / duration_s;
    return phase > 0.0 && phase < 1.0 ? peak_N * std::pow(std::sin(std::numbers::pi * phase), 1.5)
                                      : 0.0;
  }
  /// Of sin^1.5 over its half turn: B(5/4, 1/2) / pi = 0.55631...
  [[nodiscard]] double impulse_N_s() const {
    return peak_N * duration_s * std::tgamma(1.25) /
           (std::sqrt(std::numbers::pi) * std::tgamma(1.75));
  }
  /// While above a share of the peak.
  [[nodiscard]] double time_above_s(double share) const {
    return duration_s * (1.0 - 2.0 / std::numbers::pi * std::asin(std::pow(share, 2.0 / 3.0)));
  }
};

/// Strain at a place of a thin elastic bar that is pushed at one end and free at both, by the
/// travelling waves: each comes back inverted from either end.
inline double strain_in_bar(const Bar& bar, double position_m, double time_s,
                            const std::function<double(double)>& force_N) {
  const double c = std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
  double force = 0.0;
  for (int trip = 0; trip < 4; ++trip) {
    const double gone_m = 2.0 * trip * bar.length_m;
    force += force_N(time_s - (gone_m + position_m) / c) -
             force_N(time_s - (gone_m + 2.0 * bar.length_m - position_m) / c);
  }
  return force / (*bar.youngs_modulus_Pa * bar.area_m2());
}

struct BallRecording {
  double touch_s = 1203.4e-6;  ///< from the first sample
  std::size_t samples = 4000;
  double noise_strain = 0.0;
  unsigned seed = 1;
  double scale = 1e-9;  ///< strain (or volts) per code
};

/// The gauges' records; `reading` turns strain, compression positive, into what the gauge gives.
inline Shot ball_shot(
    const Bench& bench, const std::function<double(double)>& force_N,
    const BallRecording& recording = {},
    const std::function<double(double)>& reading = [](double e) { return e; }) {
  std::mt19937 random(recording.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  Shot shot;
  shot.bench = bench;
  shot.rate = SampleRate::from_Hz(bench.sampling_frequency_Hz);
  for (const Gauge& gauge : bench.gauges) {
    ChannelRecord channel;
    channel.gauge = gauge.name;
    channel.unit = gauge.unit;
    channel.bits = 32;
    channel.scale = recording.scale;
    channel.code_min = std::numeric_limits<std::int32_t>::min();
    channel.code_max = std::numeric_limits<std::int32_t>::max();
    for (std::size_t n = 0; n < recording.samples; ++n) {
      const double time_s = static_cast<double>(n) * shot.rate.period_s() - recording.touch_s;
      const double strain = strain_in_bar(bench.input, gauge.position_m, time_s, force_N) +
                            recording.noise_strain * normal(random);
      channel.codes.push_back(
          static_cast<std::int32_t>(std::lround(reading(strain) / recording.scale)));
    }
    shot.channels.push_back(channel);
  }
  return shot;
}

}  // namespace kolsky::testing
