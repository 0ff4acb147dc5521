#include "proto/codec.hpp"

#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/protocol.hpp"
#include "proto/waveform.hpp"

namespace kolsky::wire {
namespace {

constexpr int kMaxChannels = 256;

std::string indexed(const std::string& list, int index) {
  return list + "[" + std::to_string(index) + "]";
}

/// Value and wire name of an enumerator, in one table per enumeration for both ways.
template <class Domain, class Wire>
struct EnumPair {
  Domain domain;
  Wire wire;
};

constexpr EnumPair<TriggerKind, v1::TriggerInfo::Kind> kTriggerKinds[] = {
    {TriggerKind::incident, v1::TriggerInfo::INCIDENT},
    {TriggerKind::forced, v1::TriggerInfo::FORCED},
    {TriggerKind::marked, v1::TriggerInfo::MARKED},
};

constexpr EnumPair<Verdict, v1::Quality::Verdict> kVerdicts[] = {
    {Verdict::pass, v1::Quality::PASS},
    {Verdict::warn, v1::Quality::WARN},
    {Verdict::fail, v1::Quality::FAIL},
};

constexpr EnumPair<Separation, v1::Result::Separation> kSeparations[] = {
    {Separation::never, v1::Result::SEPARATION_UNSPECIFIED},
    {Separation::gauges, v1::Result::GAUGES},
    {Separation::equilibrium, v1::Result::EQUILIBRIUM},
};

constexpr EnumPair<WaveTheory, v1::Result::Dispersion> kDispersions[] = {
    {WaveTheory::elementary, v1::Result::DISPERSION_UNSPECIFIED},
    {WaveTheory::love, v1::Result::LOVE},
    {WaveTheory::exact, v1::Result::EXACT},
};

constexpr EnumPair<StressFrom, v1::Result::StressFrom> kStressesFrom[] = {
    {StressFrom::both_faces, v1::Result::STRESS_FROM_UNSPECIFIED},
    {StressFrom::back, v1::Result::ONE_WAVE},
    {StressFrom::front, v1::Result::TWO_WAVE},
};

template <class Domain, class Wire, std::size_t N>
Wire to_wire(Domain value, const EnumPair<Domain, Wire> (&pairs)[N]) {
  for (const auto& pair : pairs) {
    if (pair.domain == value) {
      return pair.wire;
    }
  }
  return Wire{};
}

template <class Domain, class Wire, std::size_t N>
Domain from_wire(Wire value, const EnumPair<Domain, Wire> (&pairs)[N], const std::string& place) {
  for (const auto& pair : pairs) {
    if (pair.wire == value) {
      return pair.domain;
    }
  }
  throw InputError(
      place, std::to_string(static_cast<int>(value)) + " is not one of its values",
      "use a value that version " + std::to_string(kSchemaVersion) + " of the schema has, not 0");
}

void encode(const Measured& measured, v1::Measured& message) {
  message.set_value(measured.value);
  message.set_sd(measured.sd);
}

Measured decode(const v1::Measured& message) {
  return {message.value(), message.sd()};
}

void encode_solid(const Material& material, v1::Material& message) {
  if (material.solid == SolidKind::three_element) {
    encode(material.E1_Pa(), *message.mutable_e1_pa());
    encode(material.E2_Pa(), *message.mutable_e2_pa());
    encode(material.eta2_Pa_s(), *message.mutable_eta2_pa_s());
    return;
  }
  message.set_solid(name_of(material.solid));
  for (const Measured& number : material.parameters) {
    encode(number, *message.add_parameters());
  }
}

void decode_solid(const v1::Material& message, Material& material) {
  if (message.solid().empty()) {
    material.parameters = {decode(message.e1_pa()), decode(message.e2_pa()),
                           decode(message.eta2_pa_s())};
    return;
  }
  try {
    material.solid = solid_kind(message.solid());
  } catch (const InputError& error) {
    throw error.inside("bar_model");
  }
  const std::size_t count = parameters_of(material.solid).size();
  if (static_cast<std::size_t>(message.parameters_size()) != count) {
    throw InputError(
        "bar_model.parameters",
        "are " + std::to_string(message.parameters_size()) + " of a " + message.solid() + " solid",
        "send " + std::to_string(count) + ", in the order of a material file");
  }
  material.parameters.clear();
  for (const v1::Measured& number : message.parameters()) {
    material.parameters.push_back(decode(number));
  }
}

void encode(const Material& material, v1::Material& message) {
  encode(material.density_kg_m3, *message.mutable_density_kg_m3());
  encode(material.poisson_ratio, *message.mutable_poisson_ratio());
  encode_solid(material, message);
  message.set_source(material.source);
  if (material.covariance) {
    message.mutable_covariance()->Add(material.covariance->begin(), material.covariance->end());
  }
  if (material.identified) {
    v1::MaterialIdentified& identified = *message.mutable_identified();
    if (material.identified->band_limit_Hz) {
      identified.set_band_limit_hz(*material.identified->band_limit_Hz);
    }
    if (material.identified->temperature_K) {
      identified.set_temperature_k(*material.identified->temperature_K);
    }
  }
}

Material decode(const v1::Material& message) {
  Material material;
  material.density_kg_m3 = decode(message.density_kg_m3());
  material.poisson_ratio = decode(message.poisson_ratio());
  decode_solid(message, material);
  material.source = message.source();
  if (message.covariance_size() > 0) {
    const std::size_t numbers = material.parameters.size() * material.parameters.size();
    if (static_cast<std::size_t>(message.covariance_size()) != numbers) {
      throw InputError("bar_model.covariance",
                       "has " + std::to_string(message.covariance_size()) + " numbers",
                       "send " + std::to_string(numbers) + ", row by row, or none");
    }
    material.covariance.emplace(message.covariance().begin(), message.covariance().end());
  }
  if (message.has_identified()) {
    // Not emplace(): what it requires is asked for before a nested class has its defaults.
    material.identified = Material::Identified{};
    Material::Identified& identified = *material.identified;
    if (message.identified().has_band_limit_hz()) {
      identified.band_limit_Hz = message.identified().band_limit_hz();
    }
    if (message.identified().has_temperature_k()) {
      identified.temperature_K = message.identified().temperature_k();
    }
  }
  return material;
}

void encode(const ReductionRequest& request, v1::ReductionAsked& message) {
  message.set_dispersion(request.dispersion.value_or(""));
  message.set_separate(request.separate.value_or(""));
  message.set_stress(request.stress.value_or(""));
  message.set_inertia(request.inertia.value_or(""));
  if (request.friction) {
    message.set_friction(*request.friction);
  }
  if (request.band_limit_Hz) {
    message.set_band_limit_hz(*request.band_limit_Hz);
  }
  if (request.duration_s) {
    message.set_duration_s(*request.duration_s);
  }
  message.set_with_true(request.with_true);
}

ReductionRequest decode(const v1::ReductionAsked& message) {
  const auto word = [](const std::string& text) {
    return text.empty() ? std::nullopt : std::optional(text);
  };
  const auto number = [](bool there, double value) {
    return there ? std::optional(value) : std::nullopt;
  };
  ReductionRequest request;
  request.dispersion = word(message.dispersion());
  request.separate = word(message.separate());
  request.stress = word(message.stress());
  request.inertia = word(message.inertia());
  request.friction = number(message.has_friction(), message.friction());
  request.band_limit_Hz = number(message.has_band_limit_hz(), message.band_limit_hz());
  request.duration_s = number(message.has_duration_s(), message.duration_s());
  request.with_true = message.with_true();
  return request;
}

void encode(const Corrections& corrections, v1::Corrections& message) {
  message.set_axial_inertia(corrections.axial_inertia);
  message.set_radial_inertia(corrections.radial_inertia);
  if (corrections.friction) {
    message.set_friction(*corrections.friction);
  }
}

Corrections decode(const v1::Corrections& message) {
  return {message.axial_inertia(), message.radial_inertia(),
          message.has_friction() ? std::optional(message.friction()) : std::nullopt};
}

SampleRate decode_rate(const v1::Tick& first, const std::string& place) {
  if (first.rate_numerator() <= 0 || first.rate_denominator() <= 0) {
    throw InputError(place + ".rate_numerator",
                     std::to_string(first.rate_numerator()) + " samples in " +
                         std::to_string(first.rate_denominator()) + " s is no rate",
                     "give both above 0");
  }
  return {first.rate_numerator(), first.rate_denominator()};
}

std::vector<ChannelRecord> decode_channels(const v1::Shot& message) {
  if (message.channels_size() > kMaxChannels) {
    throw InputError("channels",
                     std::to_string(message.channels_size()) + " are more than a shot can have",
                     "send at most " + std::to_string(kMaxChannels));
  }
  std::vector<ChannelRecord> channels;
  channels.reserve(message.channels_size());
  for (int i = 0; i < message.channels_size(); ++i) {
    const std::string place = indexed("channels", i);
    channels.push_back(unpack_codes(message.channels(i), place));
    if (channels.back().codes.size() != channels.front().codes.size()) {
      throw InputError(place,
                       "it has " + std::to_string(channels.back().codes.size()) +
                           " samples and channels[0] " +
                           std::to_string(channels.front().codes.size()),
                       "send the same window of every channel");
    }
  }
  return channels;
}

/// Runs a part of a decoding; its errors are seen from `place`.
template <class Part>
auto within(const std::string& place, const Part& part) {
  try {
    return part();
  } catch (const InputError& error) {
    throw error.inside(place);
  }
}

/// How a Reduction's arrays are named on the wire.
struct History {
  const char* name;
  const char* unit;
  std::vector<double> Reduction::*values;
};

constexpr History kHistories[] = {
    {"time_s", "s", &Reduction::time_s},
    {"stress_Pa", "Pa", &Reduction::stress_Pa},
    {"strain", "1", &Reduction::strain},
    {"strain_rate_per_s", "1/s", &Reduction::strain_rate_per_s},
    {"force_front_N", "N", &Reduction::force_front_N},
    {"force_back_N", "N", &Reduction::force_back_N},
};

/// Only there where they are asked for.
constexpr History kTrueHistories[] = {
    {"strain_true", "1", &Reduction::strain_true},
    {"stress_true_Pa", "Pa", &Reduction::stress_true_Pa},
};

constexpr History kWaves[] = {
    {"incident", "1", &Reduction::incident},
    {"reflected", "1", &Reduction::reflected},
    {"transmitted", "1", &Reduction::transmitted},
};

struct BallHistory {
  const char* name;
  const char* unit;
  std::vector<double> BallImpact::*values;
};

constexpr BallHistory kBallHistories[] = {
    {"time_s", "s", &BallImpact::time_s},
    {"force_N", "N", &BallImpact::force_N},
};

using Waveforms = google::protobuf::RepeatedPtrField<v1::Waveform>;

template <class Histories, class Kind, std::size_t N>
void pack_all(const Histories& reduction, const Kind (&histories)[N], Waveforms& waveforms) {
  const std::vector<double>& time = reduction.time_s;
  const double start_s = time.empty() ? 0.0 : time.front();
  const double step_s = time.size() < 2 ? 0.0 : time[1] - time[0];
  for (const Kind& history : histories) {
    v1::Waveform& waveform = *waveforms.Add();
    pack_values(history.name, history.unit, reduction.*history.values, waveform);
    waveform.set_start_s(start_s);
    waveform.set_step_s(step_s);
  }
}

/// Fills the arrays that are there by name; names this version does not know are a later version's.
template <class Histories, class Kind, std::size_t N>
void unpack_all(const Waveforms& waveforms, const std::string& list, const Kind (&histories)[N],
                Histories& reduction) {
  for (const Kind& history : histories) {
    int found = -1;
    for (int i = 0; i < waveforms.size(); ++i) {
      if (waveforms[i].name() != history.name) {
        continue;
      }
      if (found >= 0) {
        throw InputError(indexed(list, i) + ".name",
                         std::string("\"") + history.name + "\" is there already",
                         "send each once");
      }
      found = i;
    }
    if (found >= 0) {
      reduction.*history.values = unpack_values(waveforms[found], indexed(list, found));
    }
  }
}

/// All arrays of a list have the length of `time_s`.
template <class Histories, class Kind, std::size_t N>
void check_lengths(const Histories& reduction, const std::string& list,
                   const Kind (&histories)[N]) {
  for (const Kind& history : histories) {
    const std::size_t length = (reduction.*history.values).size();
    if (length != reduction.time_s.size()) {
      throw InputError(list + " \"" + history.name + "\"",
                       std::to_string(length) + " values beside " +
                           std::to_string(reduction.time_s.size()) + " of time_s",
                       "send every history over the same times");
    }
  }
}

void encode(const ForceStation& station, v1::ForceStation& message) {
  message.set_gauges(station.gauges);
  message.set_position_m(station.position_m);
  message.set_weight(station.weight);
  message.set_clean_from_s(station.clean_from_s);
  message.set_clean_until_s(station.clean_until_s);
  message.set_noise_n(station.noise_N);
  message.set_impulse_n_s(station.impulse_N_s);
}

ForceStation decode(const v1::ForceStation& message) {
  return {message.gauges(),       message.position_m(),    message.weight(),
          message.clean_from_s(), message.clean_until_s(), message.noise_n(),
          message.impulse_n_s()};
}

/// What is not known is not in the message.
template <class MakePlace>
void encode_known(const std::optional<Measured>& number, const MakePlace& make_place) {
  if (number) {
    encode(*number, *make_place());
  }
}

std::optional<Measured> decode_known(bool there, const v1::Measured& message) {
  return there ? std::optional(decode(message)) : std::nullopt;
}

void encode(const BallImpact& ball, v1::BallImpact& message) {
  pack_all(ball, kBallHistories, *message.mutable_histories());
  message.set_low_pass_hz(ball.low_pass_Hz);
  message.set_force_noise_n(ball.force_noise_N);
  message.set_clean_from_s(ball.clean_from_s);
  message.set_clean_until_s(ball.clean_until_s);
  encode(ball.peak_force_N, *message.mutable_peak_force_n());
  message.set_peak_time_s(ball.peak_time_s);
  encode(ball.contact_time_s, *message.mutable_contact_time_s());
  message.set_contact_threshold(ball.contact_threshold);
  message.set_contact_over(ball.contact_over);
  encode(ball.impulse_N_s, *message.mutable_impulse_n_s());
  encode_known(ball.mass_kg, [&] { return message.mutable_mass_kg(); });
  encode_known(ball.incident_speed_m_per_s,
               [&] { return message.mutable_incident_speed_m_per_s(); });
  encode_known(ball.rebound_speed_m_per_s, [&] { return message.mutable_rebound_speed_m_per_s(); });
  message.set_speed_source(ball.speed_source);
  encode_known(ball.restitution_by_speed, [&] { return message.mutable_restitution_by_speed(); });
  encode_known(ball.restitution_by_impulse,
               [&] { return message.mutable_restitution_by_impulse(); });
  encode_known(ball.restitution_difference,
               [&] { return message.mutable_restitution_difference(); });
  encode_known(ball.momentum_excess, [&] { return message.mutable_momentum_excess(); });
  for (const ForceStation& station : ball.stations) {
    encode(station, *message.add_stations());
  }
}

BallImpact decode(const v1::BallImpact& message) {
  BallImpact ball;
  unpack_all(message.histories(), "histories", kBallHistories, ball);
  check_lengths(ball, "histories", kBallHistories);
  ball.low_pass_Hz = message.low_pass_hz();
  ball.force_noise_N = message.force_noise_n();
  ball.clean_from_s = message.clean_from_s();
  ball.clean_until_s = message.clean_until_s();
  ball.peak_force_N = decode(message.peak_force_n());
  ball.peak_time_s = message.peak_time_s();
  ball.contact_time_s = decode(message.contact_time_s());
  ball.contact_threshold = message.contact_threshold();
  ball.contact_over = message.contact_over();
  ball.impulse_N_s = decode(message.impulse_n_s());
  ball.mass_kg = decode_known(message.has_mass_kg(), message.mass_kg());
  ball.incident_speed_m_per_s =
      decode_known(message.has_incident_speed_m_per_s(), message.incident_speed_m_per_s());
  ball.rebound_speed_m_per_s =
      decode_known(message.has_rebound_speed_m_per_s(), message.rebound_speed_m_per_s());
  ball.speed_source = message.speed_source();
  ball.restitution_by_speed =
      decode_known(message.has_restitution_by_speed(), message.restitution_by_speed());
  ball.restitution_by_impulse =
      decode_known(message.has_restitution_by_impulse(), message.restitution_by_impulse());
  ball.restitution_difference =
      decode_known(message.has_restitution_difference(), message.restitution_difference());
  ball.momentum_excess = decode_known(message.has_momentum_excess(), message.momentum_excess());
  for (const v1::ForceStation& station : message.stations()) {
    ball.stations.push_back(decode(station));
  }
  return ball;
}

v1::Quality::Verdict overall(const Quality& quality) {
  Verdict worst = quality.reducible ? Verdict::pass : Verdict::fail;
  for (const Check& check : quality.checks) {
    worst = std::max(worst, check.verdict);
  }
  return to_wire(worst, kVerdicts);
}

}  // namespace

void encode(const Gap& gap, v1::GapInfo& message) {
  message.set_first_tick(gap.first_tick);
  message.set_samples(gap.samples);
  message.set_known(gap.known);
}

Gap decode(const v1::GapInfo& message) {
  if (message.samples() < 0) {
    throw InputError("samples", "it is " + std::to_string(message.samples()),
                     "give how many samples are missing, 0 where nobody knows");
  }
  return {message.first_tick(), message.samples(), message.known()};
}

void encode(const TriggerEvent& trigger, v1::TriggerInfo& message) {
  message.set_kind(to_wire(trigger.kind, kTriggerKinds));
  message.set_tick(trigger.tick);
  message.set_fraction(trigger.fraction);
  message.set_sigma_samples(trigger.sigma_samples);
}

TriggerEvent decode(const v1::TriggerInfo& message) {
  TriggerEvent trigger;
  trigger.kind = from_wire(message.kind(), kTriggerKinds, "trigger.kind");
  trigger.tick = message.tick();
  trigger.fraction = message.fraction();
  trigger.sigma_samples = message.sigma_samples();
  if (!(trigger.fraction >= 0.0 && trigger.fraction < 1.0)) {
    throw InputError("trigger.fraction", "it is " + std::to_string(trigger.fraction),
                     "give the part of a sample past the tick, from 0 to below 1");
  }
  if (!(trigger.sigma_samples >= 0.0) || std::isinf(trigger.sigma_samples)) {
    throw InputError("trigger.sigma_samples", "it is " + std::to_string(trigger.sigma_samples),
                     "give a finite standard deviation");
  }
  return trigger;
}

void encode(const Shot& shot, const std::string& capture, v1::Shot& message) {
  message.Clear();
  message.set_id(shot.id);
  message.set_utc_ns(shot.utc_ns);
  message.set_monotonic_ns(shot.monotonic_ns);
  v1::Tick& first = *message.mutable_first();
  first.set_tick(shot.first_tick);
  first.set_rate_numerator(shot.rate.numerator);
  first.set_rate_denominator(shot.rate.denominator);
  if (shot.trigger) {
    encode(*shot.trigger, *message.mutable_trigger());
  }
  for (const ChannelRecord& channel : shot.channels) {
    v1::Waveform& waveform = *message.add_channels();
    pack_codes(channel, waveform);
    waveform.set_step_s(shot.rate.period_s());
  }
  for (const Gap& gap : shot.gaps) {
    encode(gap, *message.add_gaps());
  }
  message.mutable_meta()->insert(shot.meta.begin(), shot.meta.end());
  message.set_capture(capture);
  message.set_bench_toml(shot.bench_toml);
  if (shot.bar_model) {
    encode(*shot.bar_model, *message.mutable_bar_model());
  }
  message.set_software_version(shot.software_version);
  if (shot.reduction.asks()) {
    encode(shot.reduction, *message.mutable_reduction());
  }
}

Shot decode(const v1::Shot& message) {
  Shot shot;
  shot.id = message.id();
  shot.utc_ns = message.utc_ns();
  shot.monotonic_ns = message.monotonic_ns();
  shot.first_tick = message.first().tick();
  within("shot", [&] {
    shot.rate = decode_rate(message.first(), "first");
    if (message.has_trigger()) {
      shot.trigger = decode(message.trigger());
    }
    shot.channels = decode_channels(message);
    for (int i = 0; i < message.gaps_size(); ++i) {
      shot.gaps.push_back(within(indexed("gaps", i), [&] { return decode(message.gaps(i)); }));
    }
  });
  shot.meta.insert(message.meta().begin(), message.meta().end());
  shot.bench_toml = message.bench_toml();
  if (message.has_bar_model()) {
    shot.bar_model = decode(message.bar_model());
  }
  shot.software_version = message.software_version();
  shot.reduction = decode(message.reduction());
  return shot;
}

void encode(const Quality& quality, v1::Quality& message) {
  message.Clear();
  message.set_reducible(quality.reducible);
  message.set_reason(quality.reason);
  message.set_verdict(overall(quality));
  for (const Check& check : quality.checks) {
    v1::Check& judged = *message.add_checks();
    judged.set_name(check.name);
    judged.set_value(check.value);
    judged.set_limit(check.limit);
    judged.set_unit(check.unit);
    judged.set_verdict(to_wire(check.verdict, kVerdicts));
    judged.set_text(check.text);
  }
}

Quality decode(const v1::Quality& message) {
  Quality quality;
  quality.reducible = message.reducible();
  quality.reason = message.reason();
  static_cast<void>(from_wire(message.verdict(), kVerdicts, "quality.verdict"));
  for (int i = 0; i < message.checks_size(); ++i) {
    const v1::Check& judged = message.checks(i);
    const Verdict verdict =
        from_wire(judged.verdict(), kVerdicts, indexed("quality.checks", i) + ".verdict");
    quality.checks.push_back(
        {judged.name(), judged.value(), judged.limit(), judged.unit(), verdict, judged.text()});
  }
  return quality;
}

void encode(const Reduction& reduction, const std::string& shot_id, v1::Result& message) {
  message.Clear();
  message.set_shot_id(shot_id);
  encode(reduction.quality, *message.mutable_quality());
  pack_all(reduction, kHistories, *message.mutable_histories());
  if (!reduction.strain_true.empty()) {
    pack_all(reduction, kTrueHistories, *message.mutable_histories());
  }
  pack_all(reduction, kWaves, *message.mutable_waves());
  message.set_bar_model(reduction.bar_model);
  message.set_arrival_s(reduction.arrival_s);
  message.set_arrival_sigma_s(reduction.arrival_sigma_s);
  message.set_band_limit_hz(reduction.band_limit_Hz);
  message.set_quiet_samples(static_cast<std::uint32_t>(reduction.quiet_samples));
  message.set_separation(to_wire(reduction.separation, kSeparations));
  message.set_dispersion(to_wire(reduction.theory, kDispersions));
  message.set_stress_from(to_wire(reduction.stress_from, kStressesFrom));
  if (reduction.corrections.any()) {
    encode(reduction.corrections, *message.mutable_corrections());
  }
  message.set_assumed_from_s(reduction.assumed_from_s);
  message.set_push_left_share(reduction.push_left_share);
  if (reduction.ball) {
    encode(*reduction.ball, *message.mutable_ball());
  }
}

Reduction decode(const v1::Result& message) {
  Reduction reduction;
  within("result", [&] {
    reduction.quality = decode(message.quality());
    unpack_all(message.histories(), "histories", kHistories, reduction);
    unpack_all(message.waves(), "waves", kWaves, reduction);
    check_lengths(reduction, "histories", kHistories);
    check_lengths(reduction, "waves", kWaves);
    unpack_all(message.histories(), "histories", kTrueHistories, reduction);
    if (!reduction.strain_true.empty() || !reduction.stress_true_Pa.empty()) {
      check_lengths(reduction, "histories", kTrueHistories);
    }
    if (message.has_ball()) {
      reduction.ball = within("ball", [&] { return decode(message.ball()); });
    }
    reduction.separation = from_wire(message.separation(), kSeparations, "separation");
    reduction.theory = from_wire(message.dispersion(), kDispersions, "dispersion");
    reduction.stress_from = from_wire(message.stress_from(), kStressesFrom, "stress_from");
  });
  reduction.corrections = decode(message.corrections());
  reduction.bar_model = message.bar_model();
  reduction.arrival_s = message.arrival_s();
  reduction.arrival_sigma_s = message.arrival_sigma_s();
  reduction.band_limit_Hz = message.band_limit_hz();
  reduction.quiet_samples = message.quiet_samples();
  reduction.assumed_from_s = message.assumed_from_s();
  reduction.push_left_share = message.push_left_share();
  return reduction;
}

void parse(std::string_view bytes, const std::string& place,
           google::protobuf::MessageLite& message) {
  // The error says it; left alone, protobuf writes a line to stderr for every hostile message.
  const google::protobuf::LogSilencer silence;
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw InputError(place, "these bytes are no " + message.GetTypeName(),
                     "send what version 1 of kolsky.proto says");
  }
}

bool changes_state(const v1::ControlRequest& request) {
  switch (request.command_case()) {
    case v1::ControlRequest::kStatus:
    case v1::ControlRequest::kListShots:
    case v1::ControlRequest::kGetShot:
    case v1::ControlRequest::kSnapshot:
    case v1::ControlRequest::kDiagnosis:
    case v1::ControlRequest::COMMAND_NOT_SET:
      return false;
    default:
      return true;
  }
}

}  // namespace kolsky::wire
