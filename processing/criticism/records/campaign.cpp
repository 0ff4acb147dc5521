#include "processing/criticism/records/campaign.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/criticism/records/ball_gate.hpp"
#include "processing/criticism/records/faint_pulse.hpp"
#include "processing/criticism/records/lost_samples.hpp"
#include "processing/criticism/records/soft_foot.hpp"
#include "processing/identification/bar_records.hpp"
#include "processing/reduction/ball/ball_flight.hpp"
#include "processing/reduction/code_steps.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/record_faults.hpp"

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

void set_peak(std::size_t reference, CampaignShot& shot) {
  shot.facts.peak_strain = 0.0;
  for (const double value : shot.strain[reference]) {
    shot.facts.peak_strain = std::max(shot.facts.peak_strain, std::abs(value));
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
  set_peak(reference, out);
  for (std::size_t n = 0; n < shot.samples(); ++n) {
    out.facts.time_s.push_back(static_cast<double>(n) * shot.rate.period_s() - out.foot_s);
  }
  return out;
}

/// What a pulse adds to the end of its quiet part shifts all levels.
void leave_out(std::size_t of_quiet, Campaign& campaign) {
  if (of_quiet == 0) {
    return;
  }
  for (CampaignShot& shot : campaign.shots) {
    shot.quiet_samples -= of_quiet;
    for (std::vector<double>& strain : shot.strain) {
      const double level = quiet_before(strain, shot.quiet_samples).baseline;
      std::ranges::for_each(strain, [level](double& value) { value -= level; });
    }
    set_peak(campaign.reference, shot);
  }
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
  if (std::string spoiled = spoiled_because(shot); !spoiled.empty()) {
    return spoiled;
  }
  const std::size_t reference = reference_of(shot.bench);
  if (reference == shot.bench.gauges.size()) {
    return "no channel of a gauge on the input bar";
  }
  if (const std::size_t filed = shot.bench.channels().size(); shot.channels.size() != filed) {
    return std::to_string(shot.channels.size()) + " channels where the bench files " +
           std::to_string(filed);
  }
  // Behind a soft specimen there may be none; along one bar it comes to every gauge.
  for (std::size_t j = 0; j < shot.bench.gauges.size(); ++j) {
    if ((j == reference || shot.bench.kind == BenchKind::bar) && !holds_pulse(shot, j)) {
      return "gauge " + shot.bench.gauges[j].name + " holds no pulse that stands out of its noise";
    }
  }
  const auto pulse = first_pulse(readings_of(shot.channels[reference]), shot.rate.Hz());
  if (pulse->quiet < kFewestQuiet) {
    return too_few_quiet(pulse->quiet);
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
  leave_out(soft_foot_samples(campaign.shots, campaign.reference, campaign.period_s), campaign);
  set_temperatures(shots, campaign);
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    double step = 0.0;
    for (const CampaignShot& shot : campaign.shots) {
      step = std::max(step, code_step(shot.strain[j]));
    }
    campaign.step.push_back(step);
  }
  return campaign;
}

}  // namespace kolsky
