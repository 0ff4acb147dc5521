#include "processing/reduction/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "processing/base/error.hpp"
#include "processing/base/striker.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/loop_summary.hpp"

namespace kolsky {

namespace {

/// The strongest metals yield at 1 to 1.5 %; polymers bear several.
constexpr double kMostElastic = 0.02;
constexpr double kMostViscoelastic = 0.1;
/// A pulse shaper, a soft impact or dispersion take tens of per cent off a pulse, not a half.
constexpr double kFactorOff = 2.0;

const Gauge& gauge_of(const Shot& shot, const BarStation& station) {
  return shot.bench.gauges[station.channels.front()];
}

/// What turns its readings into strain, by the keys of its bench file.
std::string what_scales(const Gauge& gauge) {
  if (gauge.unit == "strain") {
    return "the unit of its samples";
  }
  return gauge.strain_per_V ? "strain_per_V, or the unit of its samples (mV read as V?)"
                            : "gain, gauge_factor or excitation_V, or the unit of its samples (mV "
                              "read as V?)";
}

std::optional<double> speed_of(const Shot& shot) {
  try {
    const auto speed = filed_striker_speed(shot);
    return speed ? std::optional(speed->value) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;  // what was noted of a shot must not keep it from being reduced
  }
}

/// Of the striker's impedance in the bar's.
std::optional<double> impedance_ratio(const Striker& striker, const Bar& bar) {
  const auto share = impedance_share(striker, bar);
  if (!share || !striker.diameter_m) {
    return std::nullopt;
  }
  return *share * std::pow(*striker.diameter_m / bar.diameter_m.value, 2.0);
}

}  // namespace

std::optional<Check> impossible_specimen_strain(const Reduction& reduction) {
  const auto end = reduction.strain.begin() + static_cast<std::ptrdiff_t>(loading_end(reduction));
  const double most =
      std::accumulate(reduction.strain.begin(), end, 0.0,
                      [](double so_far, double strain) { return std::max(so_far, strain); });
  if (most < 1.0) {
    return std::nullopt;
  }
  Check check{.name = "specimen_strain",
              .value = most,
              .limit = 1.0,
              .unit = "1",
              .verdict = Verdict::fail,
              .text = {}};
  check.text = formatted(
      "the specimen would be shortened by %.3g %%, which is all of its length or more: the gauges' "
      "gain, specimen.length_m or a unit (mV read as V, mm as m) is off by a large factor; true "
      "strain and stress beyond 100 %% do not exist",
      100.0 * most);
  return check;
}

std::optional<Check> impossible_bar_strain(const Shot& shot, const BarStation& station,
                                           std::span<const double> strain) {
  const Gauge& gauge = gauge_of(shot, station);
  const double limit =
      shot.bench.bar_of(gauge).youngs_modulus_Pa ? kMostElastic : kMostViscoelastic;
  const auto far =
      std::ranges::find_if(strain, [limit](double value) { return !(std::abs(value) <= limit); });
  if (far == strain.end()) {
    return std::nullopt;
  }
  double most = std::abs(*far);
  for (const double value : strain) {
    most = std::max(most, std::abs(value));
  }
  Check check{.name = "bar_strain",
              .value = most,
              .limit = limit,
              .unit = "1",
              .verdict = Verdict::fail,
              .text = {}};
  check.text = formatted("%s reads %.3g %% of strain, and no such bar bears more than %.0f %%: ",
                         gauge.name.c_str(), 100.0 * most, 100.0 * limit) +
               what_scales(gauge) + " is not as filed";
  return check;
}

std::optional<Check> striker_speed(const Shot& shot, const BarStation& station, double peak_strain,
                                   double wave_speed_m_per_s) {
  const auto speed_m_per_s = speed_of(shot);
  if (!speed_m_per_s || !shot.bench.striker) {
    return std::nullopt;
  }
  const auto ratio = impedance_ratio(*shot.bench.striker, shot.bench.input);
  if (!ratio) {
    return std::nullopt;
  }
  const double expected = *speed_m_per_s / wave_speed_m_per_s * *ratio / (1.0 + *ratio);
  const double share = peak_strain / expected;
  Check check{
      .name = "striker_speed", .value = share, .limit = kFactorOff, .unit = "1", .text = {}};
  const Gauge& gauge = gauge_of(shot, station);
  check.text = formatted(
      "the incident pulse's %.3g microstrain are %.3g times what the striker's %.3g m/s make of "
      "it (%.3g microstrain)",
      1e6 * peak_strain, share, *speed_m_per_s, 1e6 * expected);
  if (!(share <= kFactorOff && share >= 1.0 / kFactorOff)) {
    check.verdict = Verdict::warn;
    check.text += ": at " + gauge.name + " " + what_scales(gauge) +
                  " is not as filed, or the striker's numbers are not its own" +
                  (share < 1.0 ? "; a soft pulse shaper takes off as much" : "");
  }
  return check;
}

}  // namespace kolsky
