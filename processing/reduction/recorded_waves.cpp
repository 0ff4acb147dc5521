#include "processing/reduction/recorded_waves.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/finite.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/reduction/separation_records.hpp"
#include "processing/reduction/stations.hpp"
#include "processing/waves/band_limit.hpp"
#include "processing/waves/seen_modes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// What is known of a bar's ends. The start is struck, or at the specimen.
FreeEnds ends_of(const Bench& bench, const Bar& bar, const RecordedWavesOptions& options) {
  const bool at_specimen = bench.kind == BenchKind::shpb && options.bar == "input";
  if (at_specimen || options.gauges_only) {
    return {};
  }
  const bool matched = bar.far_end == FarEnd::matched;
  return {.start = false, .end = !matched, .end_matched = matched};
}

/// Where a bar's gauges see a pulse first.
struct FirstSeen {
  std::size_t gauge = 0;  ///< of the bar's
  std::size_t quiet = 0;  ///< samples before it
};

FirstSeen first_seen(const Shot& shot, const std::string& bar) {
  FirstSeen first{0, shot.samples()};
  std::vector<double> readings(shot.samples());
  std::size_t gauge = 0;
  for (std::size_t i = 0; i < shot.bench.gauges.size(); ++i) {
    if (shot.bench.gauges[i].bar != bar) {
      continue;
    }
    read_raw_station(shot, BarStation{.channels = {i}}, readings);
    const auto pulse = first_pulse(readings, shot.rate.Hz());
    if (pulse && pulse->quiet < first.quiet) {
      first = {gauge, pulse->quiet};
    }
    ++gauge;
  }
  if (gauge == 0) {
    throw InputError("record", "has no gauge on the " + bar + " bar", "give a bar that has gauges");
  }
  if (first.quiet == shot.samples()) {
    throw InputError("record", "shows no pulse on the " + bar + " bar's gauges",
                     "give a shot's whole record, from before the impact");
  }
  return first;
}

/// What a bar is made of, and up to where that is known: of an elastic bar without an end.
struct BarModel {
  std::unique_ptr<const Compliance> compliance;
  std::optional<double> most_band_Hz;
};

BarModel bar_model_of(const Shot& shot, const Bar& bar, const RecordedWavesOptions& options) {
  if (bar.material) {
    require_own_material_holds(shot);
    require_own_band_known(shot.bench, options.band_limit_Hz);
    return {compliance_of(*bar.material), bar.material->identified
                                              ? bar.material->identified->band_limit_Hz
                                              : std::optional<double>{}};
  }
  const std::optional<Material>& given = options.bar_model ? options.bar_model : shot.bar_model;
  if (bar.youngs_modulus_Pa || !given) {
    return {compliance_of(bar, bar.youngs_modulus_Pa ? Material{} : assumed_bars(shot.bench)), {}};
  }
  const char* name = options.bar_model ? "the bar model given" : "the capture's bar model";
  require_bar_model_holds(*given, shot, name);
  require_band_known(*given, options.band_limit_Hz, name);
  return {compliance_of(*given),
          given->identified ? given->identified->band_limit_Hz : std::optional<double>{}};
}

/// A record that ends while waves ring jumps there to nothing, which is in all frequencies: its
/// last tenth is let go gradually.
std::vector<double> faded(std::span<const double> record) {
  std::vector<double> gradual(record.begin(), record.end());
  const std::size_t tail = record.size() / 10;
  for (std::size_t n = 0; n < tail; ++n) {
    const double left = static_cast<double>(tail - n) / static_cast<double>(tail + 1);
    gradual[record.size() - tail + n] *= 0.5 - 0.5 * std::cos(std::numbers::pi * left);
  }
  return gradual;
}

double band_limit_of(const Shot& shot, const SeparationRecords& records, const FirstSeen& first,
                     const Bar& bar, const BarModel& model, const RecordedWavesOptions& options) {
  const double nyquist_Hz = shot.rate.Hz() / 2.0;
  if (options.band_limit_Hz) {
    require_band_of_record(options.band_limit_Hz, shot.rate.Hz());
    require_band_seen(*options.band_limit_Hz, blind_from_Hz(options.theory, bar, *model.compliance,
                                                            *options.band_limit_Hz));
    return *options.band_limit_Hz;
  }
  const double blind_Hz = blind_from_Hz(options.theory, bar, *model.compliance, nyquist_Hz);
  const std::vector<double> pulse =
      faded(std::span(records.strains[first.gauge]).subspan(first.quiet));
  const DampedTransform transform(shot.samples(), shot.rate.period_s());
  BandLimit band(transform, pulse.size());
  const double limit_Hz = std::min(band.from_noise(pulse, records.noise_rms[first.gauge]),
                                   model.most_band_Hz.value_or(nyquist_Hz));
  return std::min(limit_Hz, highest_band_limit_Hz(blind_Hz));
}

/// Root of the mean square of what the waves leave of each record, from the pulse to `known`.
std::vector<GaugeLeft> what_is_left(const SeparationRecords& records,
                                    const WaveSeparation& separation, double period_s,
                                    double band_limit_Hz, std::size_t known) {
  std::vector<GaugeLeft> all;
  DampedTransform transform(records.strains.front().size(), period_s);
  BandLimit band(transform, 0);
  std::vector<Complex> spectrum(BandLimit::bins_within(transform, band_limit_Hz));
  std::vector<double> filtered(records.strains.front().size());
  for (std::size_t j = 0; j < records.names.size(); ++j) {
    transform.forward(records.strains[j], spectrum);
    band.apply(band_limit_Hz, spectrum);
    transform.inverse(spectrum, filtered);
    const SeparatedWaves waves = separation.at(records.gauges[j].position_m);
    double squares = 0.0;
    for (std::size_t n = records.least_quiet; n < known; ++n) {
      const double left = filtered[n] - waves.right_going[n] - waves.left_going[n];
      squares += left * left;
    }
    const auto counted = static_cast<double>(std::max<std::size_t>(1, known - records.least_quiet));
    all.push_back({records.names[j], std::sqrt(squares / counted),
                   records.noise_rms[j] * band.noise_share(band_limit_Hz)});
  }
  return all;
}

/// The stress at the input bar's end that has the force at the output bar's beginning.
struct StressAtEnd {
  std::vector<double> values;
  std::vector<double> noise_Pa;  ///< one standard deviation
  std::size_t known = 0;         ///< samples

  StressAtEnd(const Shot& shot, RecordedWavesOptions options, double band_limit_Hz) {
    options.bar = "output";
    options.positions_m = {0.0};
    options.band_limit_Hz = band_limit_Hz;
    options.equilibrium = false;
    const RecordedWaves waves = recorded_waves(shot, options);
    values = waves.places.front().waves.stress_Pa;
    noise_Pa = waves.places.front().stress_noise_Pa;
    known = waves.known;
    const double ratio = shot.bench.output->area_m2() / shot.bench.input.area_m2();
    for (std::vector<double>* history : {&values, &noise_Pa}) {
      std::ranges::for_each(*history, [ratio](double& stress_Pa) { stress_Pa *= ratio; });
    }
  }
};

void require_specimen_at_end(const Bench& bench, const RecordedWavesOptions& options) {
  if (options.equilibrium && (bench.kind != BenchKind::shpb || options.bar != "input")) {
    throw InputError("equilibrium", "is of a specimen at the input bar's end, and there is none",
                     "leave it out, or ask for the input bar of split bars");
  }
}

void require_gauges_before_specimen(const SeparationRecords& records, const Bench& bench,
                                    const RecordedWavesOptions& options) {
  if (bench.kind == BenchKind::shpb && options.bar == "input" && !options.equilibrium &&
      records.names.size() < 2) {
    throw InputError("gauges",
                     "of the input bar are too few to separate left- and right-going waves before "
                     "a specimen",
                     "take it for in equilibrium (--equilibrium), ask for the output bar "
                     "(--bar output), or give two gauges");
  }
}

void require_whole(const Shot& shot) {
  if (const std::string reason = unusable_because(shot); !reason.empty()) {
    throw InputError("record", "cannot be used: " + reason, kRepeatOrLeaveOut);
  }
}

/// What is no number must not pass for one, whatever made it.
void require_numbers(const WavesAtPlace& place) {
  const SeparatedWaves& waves = place.waves;
  for (const auto* history : {&waves.right_going, &waves.left_going, &waves.stress_Pa,
                              &waves.velocity_m_per_s, &place.stress_noise_Pa}) {
    if (!all_finite(*history)) {
      throw InputError(
          "record",
          "gives waves at " + in_words(place.position_m, "m") + " that are no finite numbers",
          kCheckPlacesAndBars);
    }
  }
}

std::vector<double> places_of(const RecordedWavesOptions& options, const Bar& bar) {
  if (options.positions_m.empty()) {
    return {0.0, bar.length_m};
  }
  for (const double position_m : options.positions_m) {
    if (!(position_m >= 0.0 && position_m <= bar.length_m)) {
      throw InputError("position", "at " + in_words(position_m, "m") + " is off the bar",
                       "give metres from the bar's start, at most " + in_words(bar.length_m, "m"));
    }
  }
  return options.positions_m;
}

}  // namespace

RecordedWaves recorded_waves(const Shot& shot, const RecordedWavesOptions& options) {
  const Bar& bar = bar_named(shot.bench, options.bar);
  const std::vector<double> places = places_of(options, bar);
  require_specimen_at_end(shot.bench, options);
  require_whole(shot);
  const FirstSeen first = first_seen(shot, options.bar);
  SeparationRecords records(shot, options.bar, [&](const Gauge&) { return first.quiet; });
  require_gauges_before_specimen(records, shot.bench, options);
  const BarModel model = bar_model_of(shot, bar, options);
  const FreeEnds ends = ends_of(shot.bench, bar, options);
  const double period_s = shot.rate.period_s();

  RecordedWaves all;
  all.gauges = records.names;
  all.end_known = ends.end || ends.end_matched || options.equilibrium;
  all.band_limit_Hz = band_limit_of(shot, records, first, bar, model, options);
  all.quiet = first.quiet;
  all.known = shot.samples();
  std::optional<StressAtEnd> at_end;
  if (options.equilibrium) {
    at_end.emplace(shot, options, all.band_limit_Hz);
    all.known = at_end->known;
    records.add_end(bar, at_end->values);
  }
  const WaveSeparation separation(bar, *model.compliance, options.theory, records.gauges, ends,
                                  period_s, all.band_limit_Hz);
  all.blind = blind_frequencies(bar, *model.compliance, options.theory, records.gauges, ends,
                                all.band_limit_Hz);
  // What lies beyond the record comes back through the filter.
  const auto reach =
      static_cast<std::size_t>(std::ceil(BandLimit::reach_s(all.band_limit_Hz) * shot.rate.Hz()));
  for (const double position_m : places) {
    const std::size_t told = separation.known(position_m);
    all.known = std::min(all.known, told - std::min(told, reach));
    all.places.push_back(
        {position_m, separation.at(position_m), separation.stress_noise_Pa(position_m, all.quiet)});
    require_numbers(all.places.back());
  }
  if (all.known <= all.quiet) {
    throw InputError("record", "ends before it tells the waves at the places asked for",
                     "record for longer, or ask for places nearer to a gauge");
  }
  if (records.names.size() > (all.end_known ? 1U : 2U)) {
    all.left = what_is_left(records, separation, period_s, all.band_limit_Hz, all.known);
  }
  return all;
}

}  // namespace kolsky
