#include "processing/planning/planned_pulse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/planning/pulse_transform.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

namespace {

constexpr double kLeastStep = 0.02;  // of the first: what follows is no push to speak of
constexpr std::size_t kMostSteps = 50;

double edge(double to_edge_s, double rise_s) {
  if (to_edge_s <= 0.0) {
    return 0.0;
  }
  if (to_edge_s >= rise_s) {
    return 1.0;
  }
  return 0.5 * (1.0 - std::cos(std::numbers::pi * to_edge_s / rise_s));
}

/// Of the input bar's gauge that the pulse reaches first; without one the struck end.
double first_gauge_m(const Bench& bench) {
  double nearest_m = bench.input.length_m;
  bool found = false;
  for (const Gauge& gauge : bench.gauges) {
    if (gauge.bar != "output") {
      nearest_m = std::min<double>(nearest_m, gauge.position_m);
      found = true;
    }
  }
  return found ? nearest_m : 0.0;
}

/// The largest strain that a pulse makes on its way past a place, by elementary waves:
/// strain = J exp(-s sqrt(rho J) x) F / A.
double largest_strain(const PlannedPulse& pulse, const Bar& bar, const Compliance& compliance,
                      double place_m) {
  constexpr double kStepsInPulse = 2000.0;
  constexpr double kMostStepsInPulse = 1e5;
  constexpr double kStepsInRise = 64.0;
  const double step_s =
      std::clamp(pulse.rise_s / kStepsInRise, pulse.duration_s() / kMostStepsInPulse,
                 pulse.duration_s() / kStepsInPulse);
  const double quiet_s = 32.0 * step_s;
  const double record_s = quiet_s + pulse.duration_s() + pulse.rise_s +
                          1.5 * place_m / front_speed_m_per_s(bar, compliance);
  PulseTransform transform(pulse, quiet_s, record_s, step_s);
  std::vector<Complex> per_N;
  for (const Complex s : transform.path()) {
    const Complex J = compliance.at(s);
    per_N.push_back(J * std::exp(-s * std::sqrt(bar.density_kg_m3.value * J) * place_m) /
                    bar.area_m2());
  }
  const std::vector<double> strain = transform.history(per_N);
  return *std::max_element(strain.begin(), strain.end());
}

}  // namespace

double PlannedPulse::force_N(double time_s) const {
  double force_N = 0.0;
  for (std::size_t i = 0; i < step_force_N.size(); ++i) {
    const double before = i > 0 ? step_force_N[i - 1] : 0.0;
    force_N += (step_force_N[i] - before) * edge(time_s - static_cast<double>(i) * step_s, rise_s);
  }
  return force_N - step_force_N.back() * edge(time_s - duration_s(), rise_s);
}

PlannedPulse pulse_of_striker(const Bench& bench, const Material& bars, double speed_m_per_s,
                              double rise_s) {
  if (!bench.striker || !bench.striker->length_m) {
    throw InputError("striker", "is not filed with its length",
                     "file [striker] length_m and diameter_m, or give the pulse itself");
  }
  const Striker& striker = *bench.striker;
  if (!striker.youngs_modulus_Pa && !striker.of_material(bench.input)) {
    throw InputError("striker.density_kg_m3", "is not the bar's, so its waves are not known",
                     "file striker.youngs_modulus_Pa, or give the pulse itself");
  }
  const auto compliance = compliance_of(bench.input, bars);
  const double diameter_m = striker.diameter_m.value_or(bench.input.diameter_m);
  const double density = striker.density_kg_m3.value_or(bench.input.density_kg_m3);
  const double speed = striker.youngs_modulus_Pa
                           ? std::sqrt(*striker.youngs_modulus_Pa / density)
                           : 1.0 / std::sqrt(density * compliance->instantaneous());
  const double area_m2 = std::numbers::pi * diameter_m * diameter_m / 4.0;
  const double Z_striker = area_m2 * density * speed;
  const double Z_bar = bench.input.area_m2() * bench.input.density_kg_m3 *
                       front_speed_m_per_s(bench.input, *compliance);
  PlannedPulse pulse;
  pulse.step_s = 2.0 * *striker.length_m / speed;
  pulse.rise_s = rise_s > 0.0
                     ? rise_s
                     : bench.input.diameter_m / front_speed_m_per_s(bench.input, *compliance);
  const double first_N = speed_m_per_s * Z_striker * Z_bar / (Z_striker + Z_bar);
  const double next = std::max(0.0, (Z_striker - Z_bar) / (Z_striker + Z_bar));
  for (double force_N = first_N;
       force_N > kLeastStep * first_N && pulse.step_force_N.size() < kMostSteps; force_N *= next) {
    pulse.step_force_N.push_back(force_N);
  }
  return pulse;
}

PlannedPulse pulse_of_strain(const Bench& bench, const Material& bars, double strain,
                             double duration_s, double rise_s) {
  const auto compliance = compliance_of(bench.input, bars);
  PlannedPulse pulse;
  pulse.step_force_N = {1.0};
  pulse.rise_s = rise_s > 0.0
                     ? rise_s
                     : bench.input.diameter_m / front_speed_m_per_s(bench.input, *compliance);
  if (2.0 * pulse.rise_s > duration_s) {
    throw InputError("--rise",
                     in_words(pulse.rise_s, "s") + " and the fall are longer than a pulse of " +
                         in_words(duration_s, "s"),
                     "give at most half of --pulse-duration");
  }
  // The pulse is as long as it lasts from foot to foot.
  pulse.step_s = duration_s - pulse.rise_s;
  pulse.step_force_N = {strain /
                        largest_strain(pulse, bench.input, *compliance, first_gauge_m(bench))};
  return pulse;
}

}  // namespace kolsky
