#include "tests/unit/wire/golden_messages.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <limits>

#include "kolsky/v1/kolsky.pb.h"

namespace kolsky::golden {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;

constexpr std::uint64_t kBootId = 0x0102030405060708;

v1::Envelope envelope() {
  v1::Envelope envelope;
  envelope.set_schema_version(1);
  envelope.set_boot_id(kBootId);
  envelope.set_sequence(300);
  envelope.set_utc_ns(1);
  envelope.set_monotonic_ns(2);
  return envelope;
}

v1::Waveform waveform(const std::string& name, const std::string& unit, v1::Waveform::DType dtype,
                      const std::string& data) {
  v1::Waveform waveform;
  waveform.set_name(name);
  waveform.set_unit(unit);
  waveform.set_dtype(dtype);
  waveform.set_scale(1.0);
  waveform.set_start_s(-0.5);
  waveform.set_step_s(1e-6);
  waveform.set_data(data);
  return waveform;
}

v1::Waveform codes(const std::string& gauge, int bits, const std::string& data) {
  const bool is_short = bits <= 16;
  v1::Waveform codes =
      waveform(gauge, "V", is_short ? v1::Waveform::INT16 : v1::Waveform::INT32, data);
  codes.set_scale(0.125);
  codes.set_offset(-3.0);
  codes.mutable_converter()->set_bits(bits);
  codes.mutable_converter()->set_code_min(is_short ? -32768 : -8388608);
  codes.mutable_converter()->set_code_max(is_short ? 32767 : 8388607);
  return codes;
}

v1::Tick tick() {
  v1::Tick tick;
  tick.set_tick(1'000'000'000'000);
  tick.set_rate_numerator(1'000'000);
  tick.set_rate_denominator(3);
  return tick;
}

v1::Status status() {
  v1::Status status;
  status.set_state(v1::ARMED);
  status.set_digitiser_uri("ip:127.0.0.1:30431");
  status.set_digitiser_description("a digitiser");
  status.set_simulated(true);
  status.set_sampling_frequency_hz(1e6);
  status.set_samples_read(6);
  status.set_samples_missing(7);
  status.set_gaps_of_unknown_length(8);
  status.set_overflows(9);
  status.set_reconnects(10);
  status.set_ring_overruns(11);
  status.set_triggers(12);
  status.set_shots_journaled(13);
  status.set_shots_stored(14);
  status.set_last_shot_id("shot-15");
  status.set_operator_id("operator@16");
  v1::ChannelStatus& channel = *status.add_channels();
  channel.set_gauge("g1");
  channel.set_unit("strain");
  channel.set_baseline(-1e-6);
  channel.set_noise_rms(2e-6);
  channel.set_trigger_level(1.6e-5);
  status.set_disk_free_bytes(18);
  status.set_software_version("0.1.0");
  (*status.mutable_last_sequence())["shot"] = 20;
  (*status.mutable_last_sequence())["status"] = 21;
  status.set_bench_path("bench.toml");
  status.set_store_folder("store");
  v1::StageTiming& timing = *status.add_timings();
  timing.set_stage("reduce");
  timing.set_duration_s(2.5e-4);
  status.set_boot_id(kBootId);
  status.set_results_endpoint("tcp://127.0.0.1:5600");
  status.set_preview_endpoint("tcp://127.0.0.1:5601");
  return status;
}

/// With what a later version counts beside it.
v1::Status status_of_full_disk() {
  v1::Status full = status();
  full.set_journal_failures(30);
  return full;
}

v1::Preview preview() {
  v1::Preview preview;
  *preview.mutable_first() = tick();
  preview.set_step_s(1e-3);
  preview.set_missing_samples(4);
  v1::ChannelPreview& channel = *preview.add_channels();
  channel.set_gauge("g1");
  *channel.mutable_minimum() = codes("g1", 16, std::string("\xfe\xff", 2));
  *channel.mutable_maximum() = codes("g1", 16, std::string("\x03\x00", 2));
  return preview;
}

void set(v1::Measured& measured, double value, double sd) {
  measured.set_value(value);
  measured.set_sd(sd);
}

v1::Shot shot() {
  v1::Shot shot;
  shot.set_id("20240102T030405.678901-1");
  shot.set_utc_ns(1'704'164'645'678'901'000);
  *shot.mutable_first() = tick();
  v1::TriggerInfo& trigger = *shot.mutable_trigger();
  trigger.set_kind(v1::TriggerInfo::INCIDENT);
  trigger.set_tick(1'000'000'000'001);
  trigger.set_fraction(0.25);
  trigger.set_sigma_samples(0.125);
  *shot.add_channels() = codes("g1", 16, std::string("\x01\x00\xfe\xff", 4));
  *shot.add_channels() = codes("g2", 24, std::string("\x00\x00\x01\x00\xff\xff\xff\xff", 8));
  v1::GapInfo& gap = *shot.add_gaps();
  gap.set_first_tick(1'000'000'000'001);
  gap.set_samples(1);
  gap.set_known(true);
  (*shot.mutable_meta())["specimen"] = "PMMA 7";
  (*shot.mutable_meta())["striker_speed_m_per_s"] = "9.5";
  shot.set_capture("store/shots/1.h5");
  shot.set_bench_toml("kind = \"bar\"\n");
  v1::Material& material = *shot.mutable_bar_model();
  set(*material.mutable_density_kg_m3(), 1200.0, 1.0);
  set(*material.mutable_poisson_ratio(), 0.375, 0.0);
  set(*material.mutable_e1_pa(), 5.5e9, 1e7);
  set(*material.mutable_e2_pa(), 6e9, 2e7);
  set(*material.mutable_eta2_pa_s(), 1e5, 3.0);
  material.set_source("identified");
  shot.set_monotonic_ns(11);
  shot.set_software_version("0.1.0");
  return shot;
}

v1::Shot shot_identified() {
  v1::Shot identified = shot();
  v1::Material& material = *identified.mutable_bar_model();
  for (const double number : {4.0, 1.0, 0.0, 1.0, 9.0, -2.0, 0.0, -2.0, 16.0}) {
    material.add_covariance(number);
  }
  material.mutable_identified()->set_band_limit_hz(6000.0);
  material.mutable_identified()->set_temperature_k(293.0);
  return identified;
}

v1::Shot shot_of_another_solid() {
  v1::Shot other = shot();
  v1::Material& material = *other.mutable_bar_model();
  material.clear_e1_pa();
  material.clear_e2_pa();
  material.clear_eta2_pa_s();
  material.set_solid("fractional");
  set(*material.add_parameters(), 5.5e9, 1e7);
  set(*material.add_parameters(), 6e9, 2e7);
  set(*material.add_parameters(), 1e5, 3.0);
  set(*material.add_parameters(), 0.75, 0.0);
  return other;
}

v1::Shot asked_shot() {
  v1::Shot asked = shot();
  v1::ReductionAsked& reduction = *asked.mutable_reduction();
  reduction.set_dispersion("exact");
  reduction.set_separate("never");
  reduction.set_stress("one-wave");
  reduction.set_inertia("both");
  reduction.set_friction(0.125);
  reduction.set_band_limit_hz(20'000.0);
  reduction.set_duration_s(0.5);
  reduction.set_with_true(true);
  return asked;
}

v1::Quality quality() {
  v1::Quality quality;
  quality.set_reducible(true);
  quality.set_reason("");
  quality.set_verdict(v1::Quality::WARN);
  v1::Check& check = *quality.add_checks();
  check.set_name("equilibrium");
  check.set_value(0.06);
  check.set_limit(0.05);
  check.set_unit("1");
  check.set_verdict(v1::Quality::WARN);
  check.set_text("front and back differ");
  return quality;
}

/// 1.0 and -2.0, little endian.
std::string one_and_minus_two() {
  return {"\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\xc0", 16};
}

v1::Result result() {
  v1::Result result;
  result.set_shot_id("20240102T030405.678901-1");
  *result.mutable_quality() = quality();
  for (const char* name :
       {"time_s", "stress_Pa", "strain", "strain_rate_per_s", "force_front_N", "force_back_N"}) {
    *result.add_histories() = waveform(name, "1", v1::Waveform::FLOAT64, one_and_minus_two());
  }
  for (const char* name : {"incident", "reflected", "transmitted"}) {
    *result.add_waves() = waveform(name, "1", v1::Waveform::FLOAT64, one_and_minus_two());
  }
  result.set_bar_model("PMMA of the paper");
  v1::StageTiming& timing = *result.add_timings();
  timing.set_stage("journal");
  timing.set_duration_s(1.7e-4);
  result.set_arrival_s(4e-4);
  result.set_arrival_sigma_s(1e-7);
  result.set_band_limit_hz(30'000.0);
  return result;
}

v1::Result result_with_quiet() {
  v1::Result with_quiet = result();
  with_quiet.set_quiet_samples(287);
  return with_quiet;
}

v1::Result separated_result() {
  v1::Result separated = result();
  separated.set_separation(v1::Result::EQUILIBRIUM);
  separated.set_assumed_from_s(6e-5);
  separated.set_push_left_share(0.25);
  return separated;
}

v1::Result asked_result() {
  v1::Result asked = result();
  for (const char* name : {"strain_true", "stress_true_Pa"}) {
    *asked.add_histories() = waveform(name, "1", v1::Waveform::FLOAT64, one_and_minus_two());
  }
  asked.set_dispersion(v1::Result::EXACT);
  asked.set_stress_from(v1::Result::ONE_WAVE);
  asked.mutable_corrections()->set_axial_inertia(true);
  asked.mutable_corrections()->set_radial_inertia(true);
  asked.mutable_corrections()->set_friction(0.125);
  return asked;
}

v1::Measured measured(double value, double sd) {
  v1::Measured number;
  number.set_value(value);
  number.set_sd(sd);
  return number;
}

v1::Result ball_result() {
  v1::Result result;
  result.set_shot_id("20240102T030405.678901-3");
  *result.mutable_quality() = quality();
  v1::BallImpact& ball = *result.mutable_ball();
  for (const char* name : {"time_s", "force_N"}) {
    *ball.add_histories() = waveform(name, "1", v1::Waveform::FLOAT64, one_and_minus_two());
  }
  ball.set_low_pass_hz(25'000.0);
  ball.set_force_noise_n(12.5);
  ball.set_clean_from_s(49e-6);
  ball.set_clean_until_s(1088e-6);
  *ball.mutable_peak_force_n() = measured(9444.0, 30.0);
  ball.set_peak_time_s(209e-6);
  *ball.mutable_contact_time_s() = measured(451e-6, 1e-6);
  ball.set_contact_threshold(0.01);
  ball.set_contact_over(true);
  *ball.mutable_impulse_n_s() = measured(2.5, 0.01);
  *ball.mutable_mass_kg() = measured(0.0434, 0.0001);
  *ball.mutable_incident_speed_m_per_s() = measured(31.1, 0.1);
  *ball.mutable_rebound_speed_m_per_s() = measured(25.75, 0.1);
  ball.set_speed_source("photo-sensors");
  *ball.mutable_restitution_by_speed() = measured(0.828, 0.004);
  *ball.mutable_restitution_by_impulse() = measured(0.852, 0.008);
  *ball.mutable_restitution_difference() = measured(-0.024, 0.01);
  *ball.mutable_momentum_excess() = measured(0.0133, 0.005);
  v1::ForceStation& station = *ball.add_stations();
  station.set_gauges("g1+g2");
  station.set_position_m(0.25);
  station.set_weight(1.0);
  station.set_clean_from_s(49e-6);
  station.set_clean_until_s(1137e-6);
  station.set_noise_n(65.0);
  station.set_impulse_n_s(2.5);
  return result;
}

void fill_ball_shots(v1::ControlReply& reply) {
  v1::ShotSummary& summary = *reply.mutable_shots()->add_shots();
  summary.set_id("20240102T030405.678901-3");
  summary.set_verdict(v1::Quality::PASS);
  summary.set_reducible(true);
  summary.set_peak_force_n(9444.0);
  summary.set_restitution(0.828);
}

v1::Result irreducible() {
  v1::Result result;
  result.set_shot_id("20240102T030405.678901-2");
  result.mutable_quality()->set_reason("3 samples are missing");
  result.mutable_quality()->set_verdict(v1::Quality::FAIL);
  return result;
}

v1::Fault fault() {
  v1::Fault fault;
  fault.set_kind("gap");
  fault.set_text("3 samples are missing");
  fault.set_tick(100);
  fault.set_samples(3);
  return fault;
}

v1::Comparison comparison() {
  v1::Comparison comparison;
  comparison.set_shot_id("20240102T030405.678901-1");
  comparison.set_model_path("m.toml");
  comparison.set_model_sha256("00ff");
  comparison.set_comparable(true);
  comparison.set_reason("none");
  comparison.mutable_misfit()->set_chi2_reduced(1.25);
  comparison.mutable_misfit()->set_repeatable_share(0.5);
  comparison.mutable_misfit()->set_noise_floor_share(0.125);
  comparison.set_excess_share(0.0625);
  comparison.set_light(v1::Comparison::AMBER);
  comparison.set_rule("by rule");
  v1::MisfitPlace& place = *comparison.add_places();
  place.set_gauge("g1");
  place.set_window("incident");
  place.set_low_hz(1e3);
  place.set_high_hz(2e3);
  place.set_sigma(4.5);
  place.set_share(0.75);
  comparison.add_trend(1.0);
  comparison.add_trend(1.25);
  comparison.set_duration_s(5e-4);
  return comparison;
}

v1::Diagnosis diagnosis() {
  v1::Diagnosis diagnosis;
  v1::DiagnosisSummary& summary = *diagnosis.mutable_summary();
  summary.set_id("d1");
  summary.set_state(v1::DiagnosisSummary::DONE);
  summary.set_step("done");
  summary.set_verdict("tied");
  summary.add_effects("gauge-position:g3");
  diagnosis.add_shots("20240102T030405.678901-1");
  diagnosis.set_model_path("m.toml");
  diagnosis.set_model_sha256("00ff");
  (*diagnosis.mutable_tied_with())["gauge-position:g3"].add_items("channel-delay:g3");
  diagnosis.mutable_misfit()->mutable_before()->set_chi2_reduced(3.5);
  diagnosis.mutable_misfit()->mutable_after()->set_chi2_reduced(1.0);
  diagnosis.mutable_misfit()->mutable_held_out()->set_before(3.0);
  diagnosis.mutable_misfit()->mutable_held_out()->set_after(1.5);
  diagnosis.mutable_misfit()->mutable_held_out()->set_floor(1.25);
  v1::DiagnosisCandidate& candidate = *diagnosis.add_candidates();
  candidate.set_effect("gauge-position:g3");
  candidate.set_parameter("delta");
  candidate.set_unit("m");
  candidate.set_strength(0.005);
  candidate.set_sd(0.0005);
  candidate.set_p_value(1e-9);
  candidate.set_log_p(-20.75);
  candidate.set_gain(100.5);
  candidate.set_held_out_gain(90.5);
  candidate.set_smallest_detectable(0.003);
  candidate.set_smallest_identifiable(0.006);
  candidate.set_nearest_rival("channel-delay:g3");
  candidate.set_verdict("tied");
  v1::NextExperiment& next = *diagnosis.add_next_experiment();
  next.set_change("swap channels");
  next.add_separates("gauge-position:g3");
  diagnosis.add_notes("a note");
  diagnosis.set_unexplained_log_p(-1.5);
  diagnosis.set_stored_as("d1.json");
  return diagnosis;
}

template <class Choose>
v1::ControlRequest request(const Choose& choose) {
  v1::ControlRequest request;
  request.set_request_id("request-1");
  request.set_client_id("someone@somewhere");
  request.set_schema_version(1);
  request.set_boot_id(kBootId);
  choose(request);
  return request;
}

template <class Choose>
v1::ControlReply reply(const Choose& choose) {
  v1::ControlReply reply;
  reply.set_request_id("request-1");
  reply.set_ok(true);
  reply.set_boot_id(kBootId);
  reply.set_schema_version(1);
  choose(reply);
  return reply;
}

void fill_shots(v1::ControlReply& reply) {
  v1::ShotSummary& summary = *reply.mutable_shots()->add_shots();
  summary.set_id("20240102T030405.678901-1");
  summary.set_utc_ns(2);
  summary.set_capture("1.h5");
  summary.set_verdict(v1::Quality::FAIL);
  summary.set_reducible(true);
  summary.set_reason("no reason");
  summary.set_peak_stress_pa(1.5e8);
  summary.set_peak_strain(0.0625);
}

void fill_refusal(v1::ControlReply& reply) {
  reply.set_ok(false);
  reply.set_error("disk: 1 MB is free; free 2 GB");
  reply.set_repeated_request(true);
  reply.set_refusal(v1::NOT_DONE);
  reply.mutable_problem()->set_place("disk");
  reply.mutable_problem()->set_what("1 MB is free");
  reply.mutable_problem()->set_mend("free 2 GB");
  v1::PreflightCheck& check = *reply.mutable_preflight()->add_checks();
  check.set_name("disk");
  check.set_ok(true);
  check.set_text("1 MB is free");
}

/// Of a daemon that compares shots with a model.
v1::Status status_with_model() {
  v1::Status own = status();
  own.set_model_path("m.toml");
  *own.mutable_comparison() = comparison();
  *own.mutable_diagnosis() = diagnosis().summary();
  return own;
}

void fill_snapshot_with_model(v1::ControlReply& reply) {
  v1::Snapshot& snapshot = *reply.mutable_snapshot();
  *snapshot.mutable_status() = status_with_model();
  *snapshot.mutable_last_comparison() = comparison();
  *snapshot.mutable_last_diagnosis() = diagnosis();
}

void fill_snapshot(v1::ControlReply& reply) {
  v1::Snapshot& snapshot = *reply.mutable_snapshot();
  *snapshot.mutable_status() = status();
  *snapshot.mutable_last_shot() = shot();
  *snapshot.mutable_last_result() = result();
  *snapshot.mutable_last_fault() = fault();
  (*snapshot.mutable_last_sequence())["shot"] = 20;
  snapshot.set_boot_id(kBootId);
}

template <class Message>
Fixture fixture(const std::string& name, Message message) {
  return {name, std::make_shared<const Message>(std::move(message))};
}

std::vector<Fixture> request_fixtures() {
  return {
      fixture("request_status", request([](auto& r) { r.mutable_status(); })),
      fixture("request_arm", request([](auto& r) { r.mutable_arm(); })),
      fixture("request_disarm", request([](auto& r) { r.mutable_disarm(); })),
      fixture("request_force_trigger", request([](auto& r) { r.mutable_force_trigger(); })),
      fixture("request_fire", request([](auto& r) { r.mutable_fire(); })),
      fixture("request_list_shots", request([](auto& r) { r.mutable_list_shots()->set_most(7); })),
      fixture("request_get_shot", request([](auto& r) { r.mutable_get_shot()->set_id("s1"); })),
      fixture("request_reload", request([](auto& r) { r.mutable_reload(); })),
      fixture("request_stop", request([](auto& r) { r.mutable_stop(); })),
      fixture("request_release", request([](auto& r) { r.mutable_release(); })),
      fixture("request_snapshot", request([](auto& r) { r.mutable_snapshot(); })),
      fixture("request_diagnose", request([](auto& r) {
                r.mutable_diagnose()->set_shots(5);
                r.mutable_diagnose()->add_ids("s1");
              })),
      fixture("request_cancel_diagnosis", request([](auto& r) { r.mutable_cancel_diagnosis(); })),
      fixture("request_diagnosis", request([](auto& r) { r.mutable_diagnosis(); })),
  };
}

std::vector<Fixture> reply_fixtures() {
  return {
      fixture("reply_status", reply([](auto& r) { *r.mutable_status() = status(); })),
      fixture("reply_shots", reply(fill_shots)),
      fixture("reply_ball_shots", reply(fill_ball_shots)),
      fixture("reply_shot", reply([](auto& r) {
                *r.mutable_shot()->mutable_shot() = shot();
                *r.mutable_shot()->mutable_result() = result();
              })),
      fixture("reply_refusal", reply(fill_refusal)),
      fixture("reply_snapshot", reply(fill_snapshot)),
      fixture("reply_snapshot_model", reply(fill_snapshot_with_model)),
      fixture("reply_diagnosis", reply([](auto& r) { *r.mutable_diagnosis() = diagnosis(); })),
  };
}

std::string type_of(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return field.message_type()->full_name();
    case FieldDescriptor::CPPTYPE_ENUM:
      return field.enum_type()->full_name();
    default:
      return field.type_name();
  }
}

void describe(const EnumDescriptor& type, std::vector<std::string>& lines) {
  for (int i = 0; i < type.value_count(); ++i) {
    lines.push_back("value " + type.full_name() + "." + type.value(i)->name() + " = " +
                    std::to_string(type.value(i)->number()));
  }
}

void describe(const Descriptor& type, std::vector<std::string>& lines) {
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const auto* choice = field.containing_oneof();
    lines.push_back("field " + field.full_name() + " = " + std::to_string(field.number()) +
                    (field.is_repeated() ? " repeated " : " ") + type_of(field) +
                    (choice == nullptr ? "" : " in " + choice->name()));
  }
  for (int i = 0; i < type.nested_type_count(); ++i) {
    describe(*type.nested_type(i), lines);
  }
  for (int i = 0; i < type.enum_type_count(); ++i) {
    describe(*type.enum_type(i), lines);
  }
}

}  // namespace

std::vector<Fixture> fixtures() {
  std::vector<Fixture> all = {
      fixture("envelope", envelope()),
      fixture("status", status()),
      fixture("preview", preview()),
      fixture("shot", shot()),
      fixture("shot_identified", shot_identified()),
      fixture("shot_asked", asked_shot()),
      fixture("shot_solid", shot_of_another_solid()),
      fixture("result", result()),
      fixture("result_asked", asked_result()),
      fixture("result_quiet", result_with_quiet()),
      fixture("result_separated", separated_result()),
      fixture("result_irreducible", irreducible()),
      fixture("result_ball", ball_result()),
      fixture("fault", fault()),
      fixture("comparison", comparison()),
      fixture("diagnosis", diagnosis()),
      fixture("status_full_disk", status_of_full_disk()),
  };
  std::ranges::move(request_fixtures(), std::back_inserter(all));
  std::ranges::move(reply_fixtures(), std::back_inserter(all));
  return all;
}

std::string deterministic_bytes(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&coded);
  }
  return bytes;
}

std::vector<std::string> schema_lines() {
  std::vector<std::string> lines;
  const auto& file = *v1::Envelope::descriptor()->file();
  for (int i = 0; i < file.message_type_count(); ++i) {
    describe(*file.message_type(i), lines);
  }
  for (int i = 0; i < file.enum_type_count(); ++i) {
    describe(*file.enum_type(i), lines);
  }
  std::ranges::sort(lines);
  return lines;
}

}  // namespace kolsky::golden
