#include "processing/reduction/shpb_tables.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/pulse.hpp"
#include "processing/waves/lateral_delay.hpp"
#include "processing/waves/seen_modes.hpp"

namespace kolsky {

namespace {

/// Samples from just before the incident pulse to the specimen's answer at the gauge.
std::size_t pulse_room(const Shot& shot, const ShpbBar& bar) {
  const double round_trip_s = 2.0 * bar.front_time_s(bar.waves.gauge_to_specimen_m);
  return static_cast<std::size_t>((round_trip_s + kFootClearance_s) * shot.rate.Hz()) + 2;
}

std::size_t rounded_up(std::size_t samples) {
  constexpr std::size_t kStep = 32;
  return (samples + kStep - 1) / kStep * kStep;
}

}  // namespace

ShpbBar::ShpbBar(const Bar& bar, const BarStation& station, const Material& viscoelastic)
    : compliance(compliance_of(bar, viscoelastic)),
      front_speed_m_per_s(kolsky::front_speed_m_per_s(bar, *compliance)),
      waves{bar.area_m2(),
            bar.density_kg_m3,
            station.gauge_to_specimen_m,
            station.gauge_to_far_end_m,
            bar.far_end,
            front_speed_m_per_s,
            {}},
      lateral_delay_s_per_m{} {}

double ShpbBar::front_time_s(double distance_m) const {
  return distance_m / front_speed_m_per_s;
}

double ShpbBar::travel_s(std::span<const Complex> path, double band_limit_Hz) const {
  return front_time_s(waves.gauge_to_specimen_m) +
         waves.gauge_to_specimen_m *
             lateral_delay_within(lateral_delay_s_per_m, path, band_limit_Hz);
}

std::vector<double> shpb_numbers(const Bench& b, const Material& m, WaveTheory theory,
                                 const BarStation& in, const BarStation& out) {
  std::vector<double> numbers = {static_cast<double>(theory),
                                 b.input.area_m2(),
                                 b.input.density_kg_m3,
                                 b.input.youngs_modulus_Pa.value_or(Measured{}),
                                 b.input.poisson_ratio,
                                 b.input.dispersion_radius_m(),
                                 b.output->poisson_ratio,
                                 b.output->dispersion_radius_m(),
                                 b.output->area_m2(),
                                 b.output->density_kg_m3,
                                 b.output->youngs_modulus_Pa.value_or(Measured{}),
                                 in.gauge_to_specimen_m,
                                 in.gauge_to_far_end_m,
                                 out.gauge_to_specimen_m,
                                 out.gauge_to_far_end_m,
                                 static_cast<double>(b.output->far_end),
                                 b.specimen->length_m,
                                 static_cast<double>(m.solid)};
  numbers.insert(numbers.end(), m.parameters.begin(), m.parameters.end());
  if (const auto& own = b.output->material) {
    numbers.push_back(static_cast<double>(own->solid));
    numbers.insert(numbers.end(), own->parameters.begin(), own->parameters.end());
  }
  return numbers;
}

std::size_t longest_travel(const Shot& shot, const ShpbBar& input, const ShpbBar& output) {
  const double travel_s = std::max(input.front_time_s(input.waves.gauge_to_specimen_m),
                                   output.front_time_s(output.waves.gauge_to_specimen_m));
  return static_cast<std::size_t>(std::ceil(travel_s * shot.rate.Hz()));
}

/// That damp waves within a radius by no more than half of what exact waves may be.
std::size_t least_for_exact_waves(const Shot& shot, const ShpbBar& input, const ShpbBar& output) {
  constexpr double kDamped = 18.42;  // - ln of what a transform leaves at its end
  constexpr double kRatios = 0.5;    // of Poisson's ratio
  constexpr double kLeast = 0.08;
  const auto least_s = [&](const Bar& bar, const ShpbBar& waves) {
    return kDamped * waves.front_time_s(bar.dispersion_radius_m()) /
           std::max(kRatios * bar.poisson_ratio, kLeast);
  };
  const double longest_s =
      std::max(least_s(shot.bench.input, input), least_s(*shot.bench.output, output));
  return static_cast<std::size_t>(std::ceil(longest_s * shot.rate.Hz()));
}

ShpbPlanKey ShpbPlanKey::of(const Shot& shot, const ShpbBar& input, const ShpbBar& output,
                            WaveTheory theory) {
  const double slowest =
      slowest_over_front(theory) * static_cast<double>(longest_travel(shot, input, output));
  const std::size_t delay = rounded_up(static_cast<std::size_t>(slowest));
  const std::size_t least =
      theory == WaveTheory::exact ? rounded_up(least_for_exact_waves(shot, input, output)) : 0;
  return {shot.samples(), shot.rate, delay, rounded_up(pulse_room(shot, input)),
          std::max(shot.samples() + delay, least)};
}

ShpbPlans::ShpbPlans(const ShpbPlanKey& k)
    : key(k),
      transform(quick_transform_length(k.transformed), k.rate.period_s()),
      band(transform, k.longest_pulse),
      path(transform.bins()),
      input_strain(k.samples),
      output_strain(k.samples),
      history(k.samples + k.delay),
      scratch(k.samples + k.delay),
      strain_rate(k.samples + k.delay),
      incident(transform.bins()),
      rest(transform.bins()),
      output_spectrum(transform.bins()),
      work(transform.bins()),
      hidden(transform.bins()),
      hidden_in_rest(transform.bins()) {
  for (std::size_t n = 0; n < path.size(); ++n) {
    path[n] = transform.s(n);
  }
}

ShpbTables::ShpbTables(std::vector<double> n, const ShpbPlanKey& p, WaveTheory t,
                       const Bench& bench, const Material& m, const BarStation& in,
                       const BarStation& out)
    : numbers(std::move(n)),
      plan(p),
      theory(t),
      input_bar(bench.input),
      output_bar(*bench.output),
      specimen_length_m(bench.specimen->length_m),
      input(bench.input, in, m),
      output(*bench.output, out, m) {}

void ShpbTables::reach(const ShpbPlans& plans, std::size_t bins) {
  if (kernels.bins() >= bins) {
    return;
  }
  const std::vector<Complex> path(plans.path.begin(),
                                  plans.path.begin() + static_cast<std::ptrdiff_t>(bins));
  input.waves.modes = seen_modes(theory, input_bar, *input.compliance, path);
  output.waves.modes = seen_modes(theory, output_bar, *output.compliance, path);
  input.lateral_delay_s_per_m =
      kolsky::lateral_delay_s_per_m(theory, input_bar, *input.compliance, input.waves.modes, path);
  output.lateral_delay_s_per_m = kolsky::lateral_delay_s_per_m(
      theory, output_bar, *output.compliance, output.waves.modes, path);
  const double delay_s = static_cast<double>(plan.delay) * plan.rate.period_s();
  kernels = CarryingKernels(path, input.waves, output.waves, specimen_length_m, delay_s);
}

double ShpbTables::blind_from_Hz(const ShpbPlans& plans, std::size_t bins) const {
  const auto path = std::span(plans.path).first(bins);
  return std::min(kolsky::blind_from_Hz(std::span(input.waves.modes).first(bins), path),
                  kolsky::blind_from_Hz(std::span(output.waves.modes).first(bins), path));
}

}  // namespace kolsky
