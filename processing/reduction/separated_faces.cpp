#include "processing/reduction/separated_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/reduction/separation_records.hpp"
#include "processing/separation/separation.hpp"

namespace kolsky {

namespace {

/// Samples before the pulse at a gauge: fewer where it stands before the one that gave `quiet`.
std::size_t quiet_at(const Shot& shot, const ShpbBar& model, const Gauge& gauge,
                     std::size_t quiet) {
  const double ahead_m = gauge.bar == "input" ? shot.bench.distance_to_specimen_m(gauge) -
                                                    model.waves.gauge_to_specimen_m
                                              : 0.0;
  const double earlier = std::ceil(std::max(0.0, model.front_time_s(ahead_m)) * shot.rate.Hz());
  return quiet - std::min(quiet, static_cast<std::size_t>(earlier));
}

std::string all_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : " and ") + name;
  }
  return text;
}

std::vector<double> times(const std::vector<double>& values, double factor) {
  std::vector<double> scaled(values);
  for (double& value : scaled) {
    value *= factor;
  }
  return scaled;
}

constexpr std::array<std::pair<const char*, Separation>, 4> kSeparationNames = {
    {{"auto", Separation::as_needed},
     {"never", Separation::never},
     {"gauges", Separation::gauges},
     {"equilibrium", Separation::equilibrium}}};

}  // namespace

Separation separation_from(const std::string& name) {
  for (const auto& [known, separation] : kSeparationNames) {
    if (name == known) {
      return separation;
    }
  }
  throw InputError("separate", "\"" + name + "\" is not a way to tell waves apart",
                   "give auto, never, gauges or equilibrium");
}

std::string name_of(Separation separation) {
  const auto* const known =
      std::ranges::find(kSeparationNames, separation, &std::pair<const char*, Separation>::second);
  return known->first;
}

void require_two_places(const Bench& bench) {
  if (!gauges_at_two_places(bench, "input")) {
    throw InputError("gauges",
                     "are at one place of the input bar: two are needed to tell its waves apart",
                     "file a second gauge there, or separate by equilibrium: the output bar's "
                     "force in place of the second gauge");
  }
}

bool gauges_at_two_places(const Bench& bench, const std::string& bar) {
  double least = 1e300;
  double most = -1e300;
  double diameter = 0.0;
  for (const Gauge& gauge : bench.gauges) {
    if (gauge.bar == bar) {
      least = std::min(least, gauge.position_m.value);
      most = std::max(most, gauge.position_m.value);
      diameter = bench.bar_of(gauge).diameter_m;
    }
  }
  return most - least > diameter;
}

SeparatedFaces separated_faces(const Shot& shot, const ShpbTables& bars, Separation how,
                               std::size_t quiet, double band_limit_Hz) {
  if (how == Separation::gauges) {
    require_two_places(shot.bench);
  }
  const double period_s = shot.rate.period_s();
  const SeparationRecords out(shot, "output", [&](const Gauge& gauge) {
    return quiet_at(shot, bars.output, gauge, quiet);
  });
  const bool matched = bars.output_bar.far_end == FarEnd::matched;
  const WaveSeparation back(bars.output_bar, *bars.output.compliance, bars.theory, out.gauges,
                            {.start = false, .end = !matched, .end_matched = matched}, period_s,
                            band_limit_Hz);
  SeparatedWaves at_back = back.at(0.0, StrainOf::section);

  SeparationRecords in(
      shot, "input", [&](const Gauge& gauge) { return quiet_at(shot, bars.input, gauge, quiet); });
  std::vector<double> stress_front;
  if (how == Separation::equilibrium) {
    stress_front = times(at_back.stress_Pa, bars.output.waves.area_m2 / bars.input.waves.area_m2);
    in.add_end(bars.input_bar, stress_front);
  }
  const WaveSeparation front(bars.input_bar, *bars.input.compliance, bars.theory, in.gauges, {},
                             period_s, band_limit_Hz);
  SeparatedWaves at_front = front.at(bars.input_bar.length_m, StrainOf::section);

  SeparatedFaces faces;
  faces.force_back_N = times(at_back.stress_Pa, bars.output.waves.area_m2);
  faces.force_front_N = how == Separation::equilibrium
                            ? faces.force_back_N
                            : times(at_front.stress_Pa, bars.input.waves.area_m2);
  faces.rate_of_front_per_s = times(at_front.velocity_m_per_s, 1.0 / bars.specimen_length_m);
  faces.strain_rate_per_s = faces.rate_of_front_per_s;
  for (std::size_t n = 0; n < faces.strain_rate_per_s.size(); ++n) {
    faces.strain_rate_per_s[n] -= at_back.velocity_m_per_s[n] / bars.specimen_length_m;
  }
  faces.incident = std::move(at_front.right_going);
  faces.reflected = std::move(at_front.left_going);
  faces.transmitted = std::move(at_back.right_going);
  const WaveSeparation& noisier = how == Separation::equilibrium ? back : front;
  const ShpbBar& noisy_bar = how == Separation::equilibrium ? bars.output : bars.input;
  const double noisy_at_m = how == Separation::equilibrium ? 0.0 : bars.input_bar.length_m.value;
  faces.front_noise_N = times(noisier.stress_noise_Pa(noisy_at_m, quiet), noisy_bar.waves.area_m2);
  for (const BlindFrequency& blind : blind_frequencies(bars.input_bar, *bars.input.compliance,
                                                       bars.theory, in.gauges, {}, band_limit_Hz)) {
    faces.blind_Hz.push_back(blind.frequency_Hz);
  }
  faces.gauges = all_of(in.names);
  faces.quiet = in.least_quiet;
  faces.known = std::min(front.known(bars.input_bar.length_m), back.known(0.0));
  return faces;
}

std::size_t first_loading_end(const SeparatedFaces& faces, std::size_t arrival) {
  constexpr double kRisen = 0.2;
  constexpr double kFallen = 0.1;
  const auto force = [&](std::size_t n) {
    return std::abs(faces.force_front_N[n] + faces.force_back_N[n]) / 2.0;
  };
  double peak = 0.0;
  for (std::size_t n = arrival; n < faces.known; ++n) {
    peak = std::max(peak, force(n));
  }
  double most = 0.0;
  for (std::size_t n = arrival; n < faces.known; ++n) {
    most = std::max(most, force(n));
    if (most > kRisen * peak && force(n) < kFallen * most) {
      return n;
    }
  }
  return faces.known;
}

}  // namespace kolsky
