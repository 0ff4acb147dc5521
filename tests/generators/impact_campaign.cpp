#include "tests/generators/impact_campaign.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "tests/generators/beam.hpp"
#include "tests/generators/digitise.hpp"

namespace kolsky::testing {

namespace {

constexpr double kGauge_m = 0.25;
constexpr std::size_t kSamples = 2000;
constexpr double kTrigger_s = 400e-6;
constexpr double kHum_Hz = 50.0;
constexpr double kPi = std::numbers::pi;

Bench paper_bench() {
  Bench bench;
  bench.kind = BenchKind::impact;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {3.0, 0.0};
  bench.input.diameter_m = {0.027, 0.0};
  bench.input.density_kg_m3 = {4420.0, 0.0};
  bench.input.poisson_ratio = {0.33, 0.0};
  bench.input.youngs_modulus_Pa = Measured{113e9, 0.0};
  Gauge gauge;
  gauge.name = "g1";
  gauge.bar = "input";
  gauge.position_m = {kGauge_m, 0.0};
  gauge.unit = "strain";
  bench.gauges = {gauge};
  Ball ball;
  ball.outer_diameter_m = {0.0427, 0.0};
  ball.core_diameter_m = {0.03565, 0.0};
  ball.mass_kg = Measured{0.0434, 0.0};
  bench.ball = ball;
  return bench;
}

double at(const BallForce& force, double time_s) {
  // A sample is the mean over its microsecond: it stands for its middle.
  const double place = time_s / force.period_s - 0.5;
  if (place < 0.0 || place + 1.0 >= static_cast<double>(force.force_N.size())) {
    return 0.0;
  }
  const auto n = static_cast<std::size_t>(place);
  const double u = place - static_cast<double>(n);
  return (1.0 - u) * force.force_N[n] + u * force.force_N[n + 1];
}

/// What a gauge reads of the bar's bending for a force that acts a metre off its axis, from the
/// force's beginning on: a beam in spectral elements, under the force as a sum of splines.
class Bending {
 public:
  explicit Bending(const Bench& bench) : area_m2_(bench.input.area_m2()) {
    BeamProblem beam;
    beam.material = elastic(*bench.input.youngs_modulus_Pa);
    beam.density_kg_m3 = bench.input.density_kg_m3;
    beam.poisson_ratio = bench.input.poisson_ratio;
    beam.radius_m = bench.input.diameter_m / 2.0;
    beam.stations_m = {bench.gauges[0].position_m};
    unit_ = beam_response(beam, {kKnot_s});
  }

  /// @param force  [N] over time from the first touch
  template <typename Force>
  [[nodiscard]] std::vector<double> strain_per_m(const Force& force, double lag_s) const {
    // Splines of 24 us in a pulse of 400: the force in its middle is a spline's coefficient.
    std::vector<double> coefficients;
    constexpr double kLongest_s = 0.8e-3;
    for (double t = -0.5 * UnitSource::kKnots * kKnot_s; t < kLongest_s; t += kKnot_s) {
      coefficients.push_back(force(t + 0.5 * UnitSource::kKnots * kKnot_s) / area_m2_);
    }
    return superpose(unit_.strain[0], unit_.step_s, coefficients, kPeriodsPerKnot, kPeriod_s,
                     lag_s - 0.5 * UnitSource::kKnots * kKnot_s, kSamples);
  }

 private:
  static constexpr double kPeriod_s = 1e-6;
  static constexpr std::size_t kPeriodsPerKnot = 4;
  static constexpr double kKnot_s = kPeriodsPerKnot * kPeriod_s;

  double area_m2_;
  Responses unit_;
};

void file(const std::string& key, double speed, double relative_sd, std::mt19937_64& random,
          std::map<std::string, std::string>& meta) {
  const double error = relative_sd * std::normal_distribution<double>()(random);
  meta[key] = std::to_string(speed * (1.0 + error));
  meta[key + "_sd"] = std::to_string(speed * relative_sd);
}

}  // namespace

std::vector<Shot> impact_shots(const ImpactWishes& wishes) {
  Bench bench = paper_bench();
  bench.ball->core_diameter_m.sd = wishes.diameter_sd_m;
  bench.ball->outer_diameter_m.sd = wishes.diameter_sd_m;
  if (wishes.diameter_sd_m > 0.0) {
    bench.ball->mass_kg.reset();  // densities are what is known
  }
  const Bar& bar = bench.input;
  const double c0 = std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
  const double stiffness_N = *bar.youngs_modulus_Pa * bar.area_m2();
  BallImpact impact;
  impact.core_diameter_m = bench.ball->core_diameter_m + wishes.core_off_m;
  impact.outer_diameter_m = bench.ball->outer_diameter_m + wishes.ball_off_m;
  const std::array<double, 6>& moduli = wishes.moduli;
  impact.core = {1140.0, 0.376, 121e6 * moduli[0], 143e6 * moduli[1], 2860.0 * moduli[2]};
  impact.core.b = wishes.core_b;
  impact.core.damage = wishes.core_damage;
  impact.core.D_per_Pa = wishes.core_D_per_Pa;
  impact.core.tau_s = wishes.core_tau_s;
  impact.cover = {960.0, 0.319, 987e6 * moduli[3], 452e6 * moduli[4], 6020.0 * moduli[5]};
  impact.cover.b = wishes.cover_b;
  impact.cover.D_per_Pa = wishes.cover_D_per_Pa;
  impact.cover.tau_s = wishes.cover_tau_s;
  impact.offset_m = wishes.offset_m;
  impact.friction = wishes.friction;
  impact.sabot_mass_kg = wishes.sabot_mass_kg;
  impact.impedance_kg_per_s = bar.density_kg_m3 * c0 * bar.area_m2();
  impact.target_radius_m = bar.diameter_m / 2.0;
  impact.across = wishes.across;
  std::mt19937_64 random(wishes.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<Shot> shots;
  const std::optional<Bending> bending =
      wishes.bending_m != 0.0 ? std::optional<Bending>(bench) : std::nullopt;
  for (const double nominal : wishes.speeds_m_per_s) {
    // Two impacts to either side; a shot between them. Over 4 % a straight line is good to 1e-4.
    std::vector<BallForce> ends;
    for (const double factor : {0.98, 1.02}) {
      impact.speed_m_per_s = factor * nominal;
      ends.push_back(strike(impact));
    }
    for (std::size_t n = 0; n < wishes.shots; ++n) {
      const double factor =
          1.0 + std::min(0.019, std::max(-0.019, wishes.speed_scatter * normal(random)));
      const double share = (factor - 0.98) / 0.04;
      const double speed = factor * nominal;
      const double touch_s = kTrigger_s + 1e-6 * uniform(random);
      const auto force = [&](double time_s) {
        return (1.0 - share) * at(ends[0], time_s) + share * at(ends[1], time_s);
      };
      const double phase = wishes.hum_strain != 0.0 ? 2.0 * kPi * uniform(random) : 0.0;
      std::vector<double> reading(kSamples);
      const std::vector<double> bent =
          bending ? bending->strain_per_m(force, touch_s) : std::vector<double>(kSamples, 0.0);
      for (std::size_t i = 0; i < kSamples; ++i) {
        const double t = static_cast<double>(i) / bench.sampling_frequency_Hz - touch_s;
        const double x = bench.gauges[0].position_m;
        const double e =
            (force(t - x / c0) - force(t - (2.0 * bar.length_m - x) / c0)) / stiffness_N +
            wishes.bending_m * bent[i];
        const double since_s = static_cast<double>(i) / bench.sampling_frequency_Hz - kTrigger_s;
        reading[i] = (1.0 + wishes.gauge_factor) * e * (1.0 + wishes.bridge_b * e) +
                     wishes.drift_per_s * since_s +
                     wishes.hum_strain * std::cos(2.0 * kPi * kHum_Hz * since_s + phase);
      }
      Digitiser digitiser;
      digitiser.noise_strain = wishes.noise_strain;
      digitiser.bits = 16;
      digitiser.full_scale_strain = 1e-3;
      digitiser.pretrigger = static_cast<std::size_t>(kTrigger_s * bench.sampling_frequency_Hz);
      digitiser.seed = random();
      std::map<std::string, std::string> meta;
      file("incident_speed_m_per_s", speed, wishes.speed_error, random, meta);
      if (wishes.rebound) {
        const double rebound =
            (1.0 - share) * ends[0].rebound_m_per_s + share * ends[1].rebound_m_per_s;
        file("rebound_speed_m_per_s", rebound, wishes.rebound_error, random, meta);
      }
      shots.push_back(digitised(bench, {reading}, {2e-6 * normal(random)}, digitiser, meta));
      shots.back().id = "shot" + std::to_string(shots.size());
    }
  }
  return shots;
}

}  // namespace kolsky::testing
