#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/waves/seen_modes.hpp"

namespace kolsky {

namespace {

/// A run above the level shorter than this is a spike, not a pulse.
constexpr double kShortestPulse_s = 5e-6;
/// Of the band that the noise allows: a limit below that rounds the pulse's foot off.
constexpr double kMostCut = 0.7;

}  // namespace

bool ShpbPass::find_incident() {
  const auto width = static_cast<std::size_t>(std::ceil(kShortestPulse_s * rate_Hz_));
  const double round_trip_s = 2.0 * bars_.input.front_time_s(in_.gauge_to_specimen_m);
  const auto reach = static_cast<std::size_t>(round_trip_s * rate_Hz_);
  read_raw_station(shot_, in_, t_.input_strain);
  std::optional<Rise> rise;
  double foot = 0.0;
  if (options_.arrival_s) {
    foot = *options_.arrival_s * rate_Hz_;
    if (const auto first =
            find_first_pulse(t_.input_strain, std::max<std::size_t>(width, 3), reach)) {
      arrival_late_s_ = (foot - rough_foot(*first, reach)) * period_s_;
    }
    rise = rise_after_foot(t_.input_strain, foot, reach, rate_Hz_);
  } else {
    rise = find_first_pulse(t_.input_strain, std::max<std::size_t>(width, 3), reach);
    if (!rise) {
      return false;
    }
    foot = rough_foot(*rise, reach);
  }
  const auto clearance = kFootClearance_s * rate_Hz_;
  quiet_ = static_cast<std::size_t>(std::max(0.0, foot - clearance));
  incident_found_ = true;
  // Only now is it known how long the gauges are unstrained, which the bridges' equations start
  // from.
  read_station(shot_, in_, quiet_, t_.input_strain);
  read_station(shot_, out_, quiet_, t_.output_strain);
  sense_ = t_.input_strain[rise->index + 1] < 0.0 ? -1.0 : 1.0;
  input_noise_ = quiet_before(t_.input_strain, quiet_).noise_rms;
  output_noise_ = quiet_before(t_.output_strain, quiet_).noise_rms;
  gauge_foot_ = foot;
  split_ = static_cast<std::size_t>(std::max(0.0, foot + round_trip_s * rate_Hz_));
  return true;
}

double ShpbPass::rough_foot(const Rise& rise, std::size_t reach) {
  const std::size_t half = rise.index;
  const double baseline = quiet_before(t_.input_strain, std::min<std::size_t>(half, 32)).baseline;
  const std::size_t end = std::min(t_.input_strain.size(), half + reach);
  auto& shifted = t_.scratch;
  for (std::size_t n = 0; n < end; ++n) {
    shifted[n] = rise.sense * (t_.input_strain[n] - baseline);
  }
  const double peak = *std::max_element(shifted.begin() + static_cast<std::ptrdiff_t>(half),
                                        shifted.begin() + static_cast<std::ptrdiff_t>(end));
  return foot_of(shifted, half, peak, 0.0).index;
}

std::span<const double> ShpbPass::incident_strain() const {
  return std::span<const double>(t_.input_strain).first(split_);
}

std::span<const double> ShpbPass::pulse_as_read() const {
  return incident_strain().subspan(std::min(quiet_, split_));
}

void ShpbPass::transform_records() {
  const std::span<const double> pulse = pulse_without_cut();
  choose_band(pulse);
  lost_in_gauge_length_ = lost_in_gauge_length(pulse);
  if (options_.theory == WaveTheory::elementary) {
    moved_by_lateral_inertia_ = moved_by_lateral_inertia(pulse);
  }
  t_.transform.forward(t_.input_strain, in_band(t_.rest));
  t_.transform.forward(t_.output_strain, in_band(t_.output_spectrum));
  for (auto* spectrum : {&t_.rest, &t_.output_spectrum}) {
    t_.band.apply(reduction_.band_limit_Hz, in_band(*spectrum));
  }
  complete_incident();
  for (std::size_t k = 0; k < bins_; ++k) {
    t_.rest[k] -= t_.incident[k];
  }
}

void ShpbPass::choose_band(std::span<const double> pulse) {
  const double of_noise_Hz = t_.band.from_noise(pulse, input_noise_);
  double limit_Hz = options_.band_limit_Hz.value_or(
      std::min(of_noise_Hz, options_.most_band_Hz.value_or(of_noise_Hz)));
  foot_is_rounded_ = limit_Hz < kMostCut * of_noise_Hz;
  bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
  bars_.reach(t_, bins_);
  const double blind_from_Hz = bars_.blind_from_Hz(t_, bins_);
  if (options_.band_limit_Hz) {
    require_band_seen(limit_Hz, blind_from_Hz);
    require_band_of_pulse(limit_Hz);
  } else {
    limit_Hz = std::min(limit_Hz, highest_band_limit_Hz(blind_from_Hz));
    bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
  }
  reduction_.band_limit_Hz = limit_Hz;
  band_loss_ = t_.band.loss(pulse_as_read(), input_noise_, limit_Hz);
}

void ShpbPass::require_band_of_pulse(double limit_Hz) const {
  const double alone_s = (static_cast<double>(split_) - gauge_foot_) * period_s_;
  if (BandLimit::smear_s(limit_Hz) > alone_s) {
    throw InputError(
        "band_limit_Hz",
        formatted("%s is too low: a filter with that limit reaches over %.0f us, and %s sees the "
                  "pulse alone for %.0f us",
                  in_words(limit_Hz, "Hz").c_str(), 1e6 * BandLimit::smear_s(limit_Hz),
                  first_gauge().c_str(), 1e6 * alone_s),
        formatted("give at least %.0f Hz",
                  std::ceil(limit_Hz * BandLimit::smear_s(limit_Hz) / alone_s)));
  }
}

}  // namespace kolsky
