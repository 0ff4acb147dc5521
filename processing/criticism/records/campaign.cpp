#include "processing/criticism/records/campaign.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/criticism/records/ball_gate.hpp"
#include "processing/criticism/records/faint_pulse.hpp"
#include "processing/criticism/records/lost_samples.hpp"
#include "processing/identification/bar_records.hpp"
#include "processing/reduction/ball/ball_flight.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky {

namespace {

std::size_t reference_of(const Bench& bench) {
  std::size_t reference = bench.gauges.size();
  for (std::size_t j = 0; j < bench.gauges.size(); ++j) {
    const bool input = bench.gauges[j].bar != "output";
    if (input && (reference == bench.gauges.size() ||
                  bench.gauges[j].position_m < bench.gauges[reference].position_m)) {
      reference = j;
    }
  }
  return reference;
}

/// A record's values, each once, in order; none where they are more than so many.
std::vector<double> values_of(const std::vector<double>& record, std::size_t most) {
  // By its bits a value has a place in a table, or the next that is free: half of them stay so.
  const auto bits = static_cast<int>(std::bit_width(2 * most + 1));
  std::vector<std::uint32_t> known(std::size_t{1} << bits);  // 1 + the index of a value, or 0
  std::vector<double> values;
  for (const double value : record) {
    const double signless_zero = value + 0.0;
    std::size_t place =
        (std::bit_cast<std::uint64_t>(signless_zero) * 0x9e3779b97f4a7c15U) >> (64 - bits);
    while (known[place] != 0 && values[known[place] - 1] != value) {
      place = (place + 1) % known.size();
    }
    if (known[place] == 0) {
      if (values.size() == most) {
        return {};
      }
      values.push_back(value);
      known[place] = static_cast<std::uint32_t>(values.size());
    }
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// From one value that a record takes to the next, in rising order; none where it takes too many to
/// show its codes.
std::vector<double> steps_of(const std::vector<double>& strain) {
  constexpr std::size_t kSamplesPerValue = 4;
  const std::vector<double> values = values_of(strain, strain.size() / kSamplesPerValue);
  if (values.size() < 3) {
    return {};
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    steps.push_back(values[i] - values[i - 1]);
  }
  std::ranges::sort(steps);
  return steps;
}

/// The step between neighbouring codes where the record takes few enough values to show it.
double step_of(const std::vector<double>& strain) {
  const std::vector<double> steps = steps_of(strain);
  return steps.empty() ? 0.0 : steps[steps.size() / 4];
}

/// Samples in a row, [first, first + count).
struct Run {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// How far a parabola through the record on either side of a run goes beyond it: of a
/// smooth top less than a step between codes, of one that was cut off what is missing.
double beyond_run(const std::vector<double>& readings, const Run& run) {
  const std::size_t side = std::clamp<std::size_t>(run.count, 8, 16);
  const std::size_t end = run.first + run.count;
  if (run.first < side || end + side > readings.size()) {
    return std::numeric_limits<double>::infinity();
  }
  const double centre = static_cast<double>(run.first) + 0.5 * static_cast<double>(run.count - 1);
  const auto rows = static_cast<Eigen::Index>(2 * side);
  Eigen::MatrixXd powers(rows, 3);
  Eigen::VectorXd values(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::size_t at = k < side ? run.first - side + k : end + k - side;
    const double x = (static_cast<double>(at) - centre) / static_cast<double>(side);
    powers.row(i) << 1.0, x, x * x;
    values[i] = readings[at];
  }
  const double extreme = readings[run.first];
  return std::copysign(1.0, extreme) * (least_squares(powers, values)[0] - extreme);
}

/// Whether a record comes to a run, or leaves it, within a few steps between codes: a pulse that
/// was cut off comes and leaves steeply.
bool level_beside(const std::vector<double>& readings, const Run& run, double most) {
  constexpr std::size_t kSide = 8;
  const std::size_t end = run.first + run.count;
  const auto near = [&](std::size_t first) {
    return std::ranges::all_of(std::span(readings).subspan(first, kSide), [&](double value) {
      return std::abs(value - readings[run.first]) <= most;
    });
  };
  return (run.first >= kSide && near(run.first - kSide)) ||
         (end + kSide <= readings.size() && near(end));
}

/// A record that stays at its extreme far longer than it stays anywhere else near it has been cut
/// off there, wherever its codes end: a table does not tell the converter's range. Where the steps
/// are coarse and the noise is less, a smooth top stays at one code too: as the quiet record does.
std::size_t flat_top(const std::vector<double>& readings) {
  const auto [least, most] = std::minmax_element(readings.begin(), readings.end());
  const double extreme = std::abs(*most) >= std::abs(*least) ? *most : *least;
  /// Longest run of one code, of those that are asked for.
  const auto longest_run = [&](const auto& asked) {
    Run longest;
    std::size_t run = 0;
    for (std::size_t n = 0; n < readings.size(); ++n) {
      run = n > 0 && readings[n] == readings[n - 1] ? run + 1 : 1;
      if (run > longest.count && asked(readings[n])) {
        longest = {n + 1 - run, run};
      }
    }
    return longest;
  };
  constexpr std::size_t kLongRun = 8;
  constexpr double kSteps = 2.0;
  const Run top = longest_run([&](double value) { return value == extreme; });
  const std::size_t at_extreme = top.count;
  if (at_extreme < kLongRun || level_beside(readings, top, kSteps * least_step(readings))) {
    return 0;
  }
  const std::vector<double> steps = steps_of(readings);
  if (!steps.empty() && beyond_run(readings, top) < kSteps * steps.front()) {
    return 0;
  }
  const auto cut_off = [&](double from) {
    const std::size_t elsewhere =
        longest_run([&](double value) { return value != extreme && std::abs(value) > from; }).count;
    return at_extreme > 3 * elsewhere ? at_extreme : 0;
  };
  const std::size_t found = cut_off(0.5 * std::abs(extreme));
  constexpr double kCoarse = 1.0 / 300.0;
  constexpr double kAnywhere = -1.0;
  return found > 0 && step_of(readings) > kCoarse * std::abs(extreme) ? cut_off(kAnywhere) : found;
}

std::optional<double> logged(const Shot& shot, const std::string& key) {
  const auto found = shot.meta.find(key);
  if (found == shot.meta.end()) {
    return std::nullopt;
  }
  double value = 0.0;
  const char* end = found->second.data() + found->second.size();
  const auto [stopped, error] = std::from_chars(found->second.data(), end, value);
  if (error != std::errc{} || stopped != end) {
    return std::nullopt;
  }
  return value;
}

/// Temperatures relative to the bench's, or to the campaign's mean where the bench gives none.
void set_temperatures(const std::vector<Shot>& shots, Campaign& campaign) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Shot& shot : shots) {
    if (const auto T = logged(shot, "temperature_K")) {
      sum += *T;
      ++count;
    }
  }
  if (count == 0) {
    return;
  }
  const double reference = campaign.bench.temperature_K ? campaign.bench.temperature_K->value
                                                        : sum / static_cast<double>(count);
  for (std::size_t n = 0; n < shots.size(); ++n) {
    if (const auto T = logged(shots[n], "temperature_K")) {
      campaign.shots[n].facts.warmer_by_K = *T - reference;
    }
  }
}

[[noreturn]] void refuse_speed(const Shot& shot, const std::string& what) {
  throw InputError("capture " + shot.id + ": incident speed", what,
                   shot.bench.photo_sensors.empty()
                       ? "import it with --meta incident_speed_m_per_s=V"
                       : "leave this capture out, or import it again with a bench without "
                         "photo_sensors and --meta incident_speed_m_per_s=V");
}

/// A ball's speeds as the reduction finds them, from photo-sensors or facts. The force follows the
/// speed: without it nothing can be foretold.
/// @param touch_s  first touch, from the first sample
void set_speeds(const Shot& shot, double touch_s, ShotFacts& facts) {
  if (logged(shot, "incident_speed_m_per_s").value_or(0.0) < 0.0) {
    refuse_speed(
        shot, "is " + shot.meta.at("incident_speed_m_per_s") + ": towards the bar it is positive");
  }
  const BallFlight flight = ball_flight(shot, touch_s);
  if (!flight.incident_m_per_s) {
    refuse_speed(shot, "is missing: " + flight.problem);
  }
  constexpr double kFastest_m_per_s = 300.0;
  if (*flight.incident_m_per_s > kFastest_m_per_s) {
    refuse_speed(
        shot, "is " + formatted("%.4g", flight.incident_m_per_s->value) + ", outside 0 to 300 m/s");
  }
  facts.incident_speed_m_per_s = flight.incident_m_per_s->value;
  facts.incident_speed_sd_m_per_s = flight.incident_m_per_s->sd;
  if (flight.rebound_m_per_s) {
    facts.rebound_speed_m_per_s = flight.rebound_m_per_s->value;
    facts.rebound_speed_sd_m_per_s = flight.rebound_m_per_s->sd;
  }
}

CampaignShot read_shot(const Shot& shot, std::size_t reference) {
  const Bench& bench = shot.bench;
  CampaignShot out;
  out.id = shot.id;
  const auto pulse = first_pulse(readings_of(shot.channels[reference]), shot.rate.Hz());
  out.quiet_samples = pulse.value().quiet;
  out.foot_s = pulse->foot * shot.rate.period_s();
  for (std::size_t j = 0; j < bench.gauges.size(); ++j) {
    const BridgeConversion bridge(bench.gauges[j], bench.bar_of(bench.gauges[j]), bench.positive);
    const std::vector<double> readings = readings_of(shot.channels[j]);
    std::vector<double> strain(readings.size());
    bridge.convert(readings, quiet_before(readings, out.quiet_samples).baseline, strain);
    out.strain.push_back(std::move(strain));
  }
  for (const double value : out.strain[reference]) {
    out.facts.peak_strain = std::max(out.facts.peak_strain, std::abs(value));
  }
  for (std::size_t n = 0; n < shot.samples(); ++n) {
    out.facts.time_s.push_back(static_cast<double>(n) * shot.rate.period_s() - out.foot_s);
  }
  return out;
}

/// From the struck face to the reference gauge, as an elastic bar's front goes.
double travel_to_reference_s(const Campaign& campaign) {
  const Bar& bar = campaign.bench.input;
  return bar.youngs_modulus_Pa ? campaign.bench.gauges[campaign.reference].position_m /
                                     std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3)
                               : 0.0;
}

void require_gauges(const Bench& bench) {
  // The ball's force is foretold; a source that is free is known by another gauge only.
  if (bench.kind != BenchKind::impact && bench.gauges.size() < 2) {
    throw InputError("gauges", "are too few: a model is judged by what one gauge says of another",
                     "record the wave with at least two gauges");
  }
  if (reference_of(bench) == bench.gauges.size()) {
    throw InputError("gauges", "are none on the input bar", "put one there: it sees the source");
  }
}

}  // namespace

bool holds_pulse(const Shot& shot, std::size_t gauge) {
  const std::vector<double> record = readings_of(shot.channels[gauge]);
  if (first_pulse(record, shot.rate.Hz())) {
    return true;
  }
  const std::size_t reference = reference_of(shot.bench);
  const auto first = first_pulse(readings_of(shot.channels[reference]), shot.rate.Hz());
  return gauge != reference && first && stands_out_on_average(record, first->quiet);
}

std::string bad_data(const Shot& shot) {
  std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    return unusable;
  }
  const std::size_t reference = reference_of(shot.bench);
  if (reference == shot.bench.gauges.size()) {
    return "no channel of a gauge on the input bar";
  }
  if (const std::size_t filed = shot.bench.channels().size(); shot.channels.size() != filed) {
    return std::to_string(shot.channels.size()) + " channels where the bench files " +
           std::to_string(filed);
  }
  // A photo-sensor stays at its levels by nature.
  for (std::size_t j = 0; j < shot.bench.gauges.size(); ++j) {
    const ChannelRecord& channel = shot.channels[j];
    if (const std::size_t flat = flat_top(readings_of(channel)); flat > 0) {
      return "gauge " + channel.gauge + " stays at its extreme for " + std::to_string(flat) +
             " samples: it was cut off there";
    }
  }
  // Behind a soft specimen there may be none; along one bar it comes to every gauge.
  for (std::size_t j = 0; j < shot.bench.gauges.size(); ++j) {
    if ((j == reference || shot.bench.kind == BenchKind::bar) && !holds_pulse(shot, j)) {
      return "gauge " + shot.bench.gauges[j].name + " holds no pulse that stands out of its noise";
    }
  }
  const auto pulse = first_pulse(readings_of(shot.channels[reference]), shot.rate.Hz());
  if (pulse->quiet < kFewestQuiet) {
    return "too few quiet samples before the pulse: " + std::to_string(pulse->quiet) +
           " of at least " + std::to_string(kFewestQuiet);
  }
  for (std::size_t j = 0; j < shot.bench.gauges.size(); ++j) {
    if (const auto lost = lost_samples(readings_of(shot.channels[j]), pulse->quiet)) {
      return "gauge " + shot.channels[j].gauge + " jumps away and back over " +
             std::to_string(lost->count) + (lost->count == 1 ? " sample" : " samples") + " from " +
             std::to_string(lost->first) +
             " on: strain does not, the digitiser lost what was there";
    }
  }
  return shot.bench.kind == BenchKind::impact ? no_ball_does(shot) : std::string();
}

Campaign read_campaign(const std::vector<Shot>& shots) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one");
  }
  Campaign campaign;
  campaign.bench = shots.front().bench;
  require_gauges(campaign.bench);
  campaign.period_s = shots.front().rate.period_s();
  campaign.reference = reference_of(campaign.bench);
  const double travel_s = travel_to_reference_s(campaign);
  for (const Shot& shot : shots) {
    if (shot.rate != shots.front().rate || shot.bench_toml != shots.front().bench_toml) {
      throw InputError("capture " + shot.id, "is of another bench or rate than " + shots.front().id,
                       "compare shots of one bench at a time");
    }
    if (const std::string reason = bad_data(shot); !reason.empty()) {
      throw InputError("capture " + shot.id, reason, "repeat the shot, or leave this capture out");
    }
    campaign.shots.push_back(read_shot(shot, campaign.reference));
    if (campaign.bench.kind == BenchKind::impact) {
      CampaignShot& own = campaign.shots.back();
      set_speeds(shot, own.foot_s - travel_s, own.facts);
    }
    campaign.shots.back().facts.shot = campaign.shots.size() - 1;
  }
  set_temperatures(shots, campaign);
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    double step = 0.0;
    for (const CampaignShot& shot : campaign.shots) {
      step = std::max(step, step_of(shot.strain[j]));
    }
    campaign.step.push_back(step);
  }
  return campaign;
}

}  // namespace kolsky
