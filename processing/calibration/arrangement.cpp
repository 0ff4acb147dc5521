#include "processing/calibration/arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/identification/bar_records.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/record_faults.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/incident_tail.hpp"

namespace kolsky {

namespace {

constexpr double kAlike = 0.01;
/// A bar that shows less than this of the other one's pulse was not touched.
constexpr double kSilent = 0.03;
/// What is kept of the time until faces can part.
constexpr double kSafely = 0.97;
/// Pulses that give a modulus more times the paper's, or less, were not of bars that touch.
constexpr double kMostTimesStiffer = 3.0;

std::optional<FirstPulse> pulse_of(const Shot& shot, std::size_t channel) {
  return first_pulse(readings_of(shot.channels[channel]), shot.rate.Hz());
}

double strain_per_reading(const Bench& bench, const Gauge& gauge) {
  return std::abs(BridgeConversion(gauge, bench.bar_of(gauge), bench.positive).sensitivity());
}

/// Largest first pulse on a bar, in strain; 0 where there is none.
double loudest(const Shot& shot, const std::string& bar) {
  double peak = 0.0;
  for (std::size_t j = 0; j < shot.bench.gauges.size(); ++j) {
    const Gauge& gauge = shot.bench.gauges[j];
    if (gauge.bar == bar) {
      if (const auto pulse = pulse_of(shot, j)) {
        peak = std::max(peak, pulse->height * strain_per_reading(shot.bench, gauge));
      }
    }
  }
  return peak;
}

BarsLay lay_of(const Shot& shot) {
  if (shot.bench.kind == BenchKind::bar) {
    return BarsLay::one_bar;
  }
  const double input = loudest(shot, "input");
  const double output = loudest(shot, "output");
  if (input == 0.0 && output == 0.0) {
    throw InputError("capture " + shot.id, "holds no pulse that stands out of its noise",
                     "give the shot's whole record, from before the impact");
  }
  if (output < kSilent * input) {
    return BarsLay::input_alone;
  }
  return input < kSilent * output ? BarsLay::output_alone : BarsLay::together;
}

/// Gives every gauge the place whose turn it was: cables that were exchanged show in the order in
/// which the pulse arrives.
std::vector<std::pair<std::string, std::string>> set_in_order(Bench& bench, const Shot& shot) {
  std::vector<std::pair<std::string, std::string>> swapped;
  std::vector<std::size_t> by_way(bench.gauges.size());
  std::iota(by_way.begin(), by_way.end(), std::size_t{0});
  std::vector<double> seen;
  for (std::size_t j = 0; j < shot.channels.size(); ++j) {
    const auto pulse = pulse_of(shot, j);
    if (!pulse) {
      return {};
    }
    seen.push_back(pulse->half);
  }
  std::stable_sort(by_way.begin(), by_way.end(), [&](std::size_t a, std::size_t b) {
    return way_to_m(bench, bench.gauges[a]) < way_to_m(bench, bench.gauges[b]);
  });
  constexpr double kClearly = 3.0;  // samples
  for (std::size_t round = 0; round < by_way.size(); ++round) {
    bool in_order = true;
    for (std::size_t i = 0; i + 1 < by_way.size(); ++i) {
      Gauge& first = bench.gauges[by_way[i]];
      Gauge& second = bench.gauges[by_way[i + 1]];
      if (seen[by_way[i]] > seen[by_way[i + 1]] + kClearly) {
        std::swap(first.position_m, second.position_m);
        std::swap(first.bar, second.bar);
        swapped.emplace_back(first.name, second.name);
        std::swap(by_way[i], by_way[i + 1]);
        in_order = false;
      }
    }
    if (in_order) {
      break;
    }
  }
  return swapped;
}

/// Of a gauge's first pulse, compression positive; 0 where there is none.
double sense_of(const Shot& shot, std::size_t gauge) {
  const Gauge& own = shot.bench.gauges[gauge];
  const auto pulse = pulse_of(shot, gauge);
  if (!pulse) {
    return 0.0;
  }
  const BridgeConversion bridge(own, shot.bench.bar_of(own), shot.bench.positive);
  return std::copysign(1.0, bridge.strain(pulse->sense * pulse->height));
}

/// Gauges whose pulse pulls in every shot, where another's pushes: one wave comes to all.
std::vector<std::size_t> inverted_in(const std::vector<Shot>& shots) {
  std::vector<std::size_t> inverted;
  bool some_push = false;
  for (std::size_t j = 0; j < shots.front().bench.gauges.size(); ++j) {
    const auto sense = [&](const Shot& shot) { return sense_of(shot, j); };
    some_push = some_push ||
                std::ranges::all_of(shots, [&](const Shot& shot) { return sense(shot) > 0.0; });
    if (std::ranges::all_of(shots, [&](const Shot& shot) { return sense(shot) < 0.0; })) {
      inverted.push_back(j);
    }
  }
  return some_push ? inverted : std::vector<std::size_t>{};
}

/// Gives gauges that read with the other sign the one that is filed.
void set_senses(CalibrationPart& part) {
  for (const std::size_t gauge : inverted_in(part.shots)) {
    part.inverted.push_back(part.shots.front().bench.gauges[gauge].name);
    for (Shot& shot : part.shots) {
      shot.channels[gauge].scale = -shot.channels[gauge].scale;
    }
  }
}

void cut(Shot& shot, std::size_t samples) {
  for (ChannelRecord& channel : shot.channels) {
    channel.codes.resize(std::min(channel.codes.size(), samples));
  }
}

/// Leaves of a shot on bars that touch what happens before the far end's answer can part them.
void cut_before_faces_part(Shot& shot, const BarPrior& bars) {
  const Bench& bench = shot.bench;
  if (bench.output->far_end != FarEnd::free) {
    return;
  }
  std::size_t first = 0;
  double nearest_m = bench.input.length_m;
  for (std::size_t j = 0; j < bench.gauges.size(); ++j) {
    if (way_to_m(bench, bench.gauges[j]) < way_to_m(bench, bench.gauges[first])) {
      first = j;
    }
    nearest_m = std::min(nearest_m, bench.distance_to_specimen_m(bench.gauges[j]));
  }
  const auto pulse = pulse_of(shot, first);
  if (!pulse) {
    return;
  }
  const double speed_in =
      front_speed_m_per_s(bench.input, *compliance_of(bench.input, bars.material));
  const double speed_out =
      front_speed_m_per_s(*bench.output, *compliance_of(*bench.output, bars.material));
  const double time_s = bench.distance_to_specimen_m(bench.gauges[first]) / speed_in +
                        2.0 * bench.output->length_m / speed_out +
                        nearest_m / std::max(speed_in, speed_out);
  cut(shot, static_cast<std::size_t>(pulse->foot + kSafely * time_s * shot.rate.Hz()));
}

/// One bar of a split bench by itself.
void leave_one_bar(Shot& shot, const std::string& name) {
  Bench& bench = shot.bench;
  std::vector<Gauge> gauges;
  std::vector<ChannelRecord> channels;
  for (std::size_t j = 0; j < bench.gauges.size(); ++j) {
    if (bench.gauges[j].bar == name) {
      gauges.push_back(bench.gauges[j]);
      gauges.back().bar = "input";
      channels.push_back(std::move(shot.channels[j]));
    }
  }
  if (name == "output") {
    bench.input = *bench.output;
  }
  bench.kind = BenchKind::bar;
  bench.output.reset();
  bench.specimen.reset();
  bench.gauges = std::move(gauges);
  shot.channels = std::move(channels);
}

/// Makes a second gauge of one that sees the pulse come back from the free end: what it reads from
/// then on, inverted, on a bar that has no end. What the first one reads from then on would reach
/// the second only after the record's new end. What of the first pass is still to come then is
/// taken off. The way between them is known as well as the bar's
/// length and the gauge's place.
void split_passes(Shot& shot, const BarPrior& bars) {
  Gauge& gauge = shot.bench.gauges.front();
  const Bar bar = shot.bench.input;
  const double rate_Hz = shot.rate.Hz();
  const auto pulse = pulse_of(shot, 0);
  const double speed = front_speed_m_per_s(bar, *compliance_of(bar, bars.material));
  constexpr double kClear_s = 40e-6;  // of the front's foot before its half rise
  const auto sample = [&](double after_s) {
    return static_cast<std::size_t>(
        std::max(0.0, (pulse ? pulse->half : 0.0) + (after_s - kClear_s) * rate_Hz));
  };
  const double to_end_s = (bar.length_m - gauge.position_m) / speed;
  const double to_start_s = gauge.position_m / speed;
  const std::size_t quiet = sample(0.0);
  const std::size_t back = sample(2.0 * to_end_s);
  const std::size_t end = std::min(
      shot.samples(), std::min(sample(2.0 * (to_end_s + to_start_s)), sample(4.0 * to_end_s)));
  constexpr std::size_t kFewest = 64;
  if (!pulse || quiet < kFewest || back + kFewest >= end) {
    throw InputError("gauge " + gauge.name, "sees too little of what the free end returns",
                     "place it farther from the end, record longer, or use two gauges");
  }
  auto& codes = shot.channels.front().codes;
  double baseline = 0.0;
  for (std::size_t n = 0; n < quiet; ++n) {
    baseline += static_cast<double>(codes[n]) / static_cast<double>(quiet);
  }
  std::vector<double> readings(codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(end));
  for (double& reading : readings) {
    reading -= baseline;
  }
  const std::vector<double> tail =
      incident_tail(readings, back, bar, *compliance_of(bar, bars.material), gauge.position_m,
                    shot.rate.period_s());
  ChannelRecord returned = shot.channels.front();
  for (std::size_t n = 0; n < end; ++n) {
    // Noise of before the pulse, to and fro, stands where the first pass was.
    const std::size_t phase = n % (2 * quiet);
    returned.codes[n] =
        n < back ? codes[phase < quiet ? quiet - 1 - phase : phase - quiet]
                 : static_cast<std::int32_t>(std::lround(baseline - readings[n] + tail[n]));
  }
  Gauge second = gauge;
  second.name += " returned";
  second.position_m = {2.0 * bar.length_m - gauge.position_m,
                       2.0 * std::hypot(bar.length_m.sd, gauge.position_m.sd)};
  returned.gauge = second.name;
  gauge.position_m.sd = 0.0;
  shot.bench.gauges.push_back(second);
  shot.channels.push_back(returned);
  shot.bench.input.length_m = {2.0 * bar.length_m, 0.0};
  cut(shot, end);
}

CalibrationPart& part_of(std::vector<CalibrationPart>& parts, BarsLay lay) {
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.lay == lay; });
  if (found != parts.end()) {
    return *found;
  }
  CalibrationPart& part = parts.emplace_back();
  part.lay = lay;
  return part;
}

/// Of the first pulse from the first gauge to the last, where both bars are viscoelastic and both
/// show it.
std::optional<double> pulse_speed_m_per_s(const Shot& shot) {
  const Bench& bench = shot.bench;
  if (bench.input.youngs_modulus_Pa || !bench.output || bench.output->youngs_modulus_Pa ||
      bench.gauges.size() < 2 || shot.channels.size() != bench.gauges.size() ||
      lay_of(shot) != BarsLay::together) {
    return std::nullopt;
  }
  const auto nearer = [&](const Gauge& a, const Gauge& b) {
    return way_to_m(bench, a) < way_to_m(bench, b);
  };
  const auto [near, far] = std::minmax_element(bench.gauges.begin(), bench.gauges.end(), nearer);
  const auto seen_near = pulse_of(shot, static_cast<std::size_t>(near - bench.gauges.begin()));
  const auto seen_far = pulse_of(shot, static_cast<std::size_t>(far - bench.gauges.begin()));
  if (!seen_near || !seen_far || seen_far->half <= seen_near->half) {
    return std::nullopt;
  }
  return (way_to_m(bench, *far) - way_to_m(bench, *near)) * shot.rate.Hz() /
         (seen_far->half - seen_near->half);
}

void prepare(CalibrationPart& part, const BarPrior& bars, Channels channels) {
  for (Shot& shot : part.shots) {
    if (part.lay == BarsLay::input_alone || part.lay == BarsLay::output_alone) {
      leave_one_bar(shot, part.lay == BarsLay::input_alone ? "input" : "output");
    }
  }
  if (channels == Channels::as_they_read) {
    set_senses(part);
  }
  Bench bench = part.shots.front().bench;
  part.two_passes = bench.gauges.size() == 1;
  if (channels == Channels::as_they_read) {
    part.swapped = set_in_order(bench, part.shots.front());
  }
  for (Shot& shot : part.shots) {
    shot.bench = bench;
    if (part.two_passes) {
      split_passes(shot, bars);
    } else if (part.lay == BarsLay::together) {
      cut_before_faces_part(shot, bars);
    }
  }
}

}  // namespace

std::string name_of(BarsLay lay) {
  switch (lay) {
    case BarsLay::one_bar:
      return "bar";
    case BarsLay::together:
      return "bars together";
    case BarsLay::input_alone:
      return "input bar alone";
    case BarsLay::output_alone:
      break;
  }
  return "output bar alone";
}

bool specimen_is_slice_of_bar(const Bench& bench) {
  const auto alike = [](double a, double b) { return std::abs(a - b) <= kAlike * std::abs(b); };
  return bench.specimen && bench.specimen->density_kg_m3 &&
         alike(*bench.specimen->density_kg_m3, bench.input.density_kg_m3) &&
         alike(bench.specimen->area_m2(), bench.input.area_m2());
}

double way_to_m(const Bench& bench, const Gauge& gauge) {
  if (gauge.bar != "output") {
    return gauge.position_m;
  }
  const double slice_m = specimen_is_slice_of_bar(bench) ? bench.specimen->length_m.value : 0.0;
  return bench.input.length_m + slice_m + gauge.position_m;
}

BarPrior bars_to_begin_with(const std::vector<Shot>& shots) {
  BarPrior bars(paper_pmma());
  if (shots.empty() || shots.front().bench.kind != BenchKind::shpb) {
    return bars;
  }
  bars = BarPrior(assumed_bars(shots.front().bench));
  for (const Shot& shot : shots) {
    const auto speed = pulse_speed_m_per_s(shot);
    if (!speed) {
      continue;
    }
    const Material pmma = bars.material;
    const double stiffer = shot.bench.input.density_kg_m3 * *speed * *speed / pmma.E1_Pa();
    if (stiffer > 1.0 / kMostTimesStiffer && stiffer < kMostTimesStiffer) {
      for (Measured& number : bars.material.parameters) {
        number.value *= stiffer;
      }
    }
    break;
  }
  return bars;
}

std::vector<CalibrationPart> arrange(const std::vector<Shot>& shots, const BarPrior& bars,
                                     Channels channels) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot");
  }
  std::vector<CalibrationPart> parts;
  for (const Shot& shot : shots) {
    if (shot.bench.kind == BenchKind::impact) {
      throw InputError("capture " + shot.id, "is of a ball on a bar, which is not calibrated",
                       "strike the bar alone, with a bench file of kind \"bar\"");
    }
    if (shot.rate != shots.front().rate || shot.bench_toml != shots.front().bench_toml) {
      throw InputError("capture " + shot.id, "is of another bench or rate than " + shots.front().id,
                       "calibrate one bench at a time");
    }
    if (shot.channels.size() != shot.bench.gauges.size()) {
      throw InputError("capture " + shot.id, "has not one channel per gauge",
                       "file one gauge per channel, in their order");
    }
    if (const std::string reason = spoiled_because(shot); !reason.empty()) {
      throw InputError("capture " + shot.id, reason, kRepeatOrLeaveOut);
    }
    part_of(parts, lay_of(shot)).shots.push_back(shot);
  }
  for (CalibrationPart& part : parts) {
    part.bars = bars;
    prepare(part, bars, channels);
  }
  return parts;
}

}  // namespace kolsky
