#include <fmt/format.h>

#include <map>

#include "clients/cli/reports/daemon_text.hpp"
#include "clients/cli/reports/time_text.hpp"
#include "proto/light.hpp"

namespace kolsky::cli {
namespace {

JsonValue describe(const v1::ChannelStatus& channel) {
  return JsonObject{{"gauge", channel.gauge()},
                    {"unit", channel.unit()},
                    {"baseline", channel.baseline()},
                    {"noise_rms", channel.noise_rms()},
                    {"trigger_level", channel.trigger_level()}};
}

JsonValue describe(const v1::StageTiming& timing) {
  return JsonObject{{"stage", timing.stage()}, {"duration_s", timing.duration_s()}};
}

JsonValue describe(const v1::Misfit& misfit) {
  return JsonObject{{"chi2_reduced", misfit.chi2_reduced()},
                    {"repeatable_share", misfit.repeatable_share()},
                    {"noise_floor_share", misfit.noise_floor_share()}};
}

JsonValue describe(const v1::DiagnosisCandidate& candidate) {
  return JsonObject{{"effect", candidate.effect()},
                    {"parameter", candidate.parameter()},
                    {"unit", candidate.unit()},
                    {"strength", candidate.strength()},
                    {"sd", candidate.sd()},
                    {"p_value", candidate.p_value()},
                    {"log_p", candidate.log_p()},
                    {"gain", candidate.gain()},
                    {"held_out_gain", candidate.held_out_gain()},
                    {"smallest_detectable", candidate.smallest_detectable()},
                    {"smallest_identifiable", candidate.smallest_identifiable()},
                    {"nearest_rival", candidate.nearest_rival()},
                    {"verdict", candidate.verdict()}};
}

template <typename Texts>
std::vector<std::string> texts(const Texts& list) {
  return {list.begin(), list.end()};
}

JsonValue describe(const v1::NextExperiment& next) {
  return JsonObject{{"change", next.change()}, {"separates", texts(next.separates())}};
}

template <typename Messages>
JsonList list_of(const Messages& messages) {
  JsonList list;
  for (const auto& message : messages) {
    list.push_back(describe(message));
  }
  return list;
}

// 64 bits do not fit a JSON reader's double.
std::string hexadecimal(std::uint64_t number) {
  return fmt::format("{:016x}", number);
}

JsonValue count(std::uint64_t number) {
  return {number};
}

}  // namespace

JsonValue describe(const v1::Status& status) {
  return JsonObject{{"state", state_name(status.state())},
                    {"digitiser_uri", status.digitiser_uri()},
                    {"digitiser_description", status.digitiser_description()},
                    {"simulated", status.simulated()},
                    {"sampling_frequency_Hz", status.sampling_frequency_hz()},
                    {"operator", status.operator_id()},
                    {"last_shot_id", status.last_shot_id()},
                    {"samples_read", count(status.samples_read())},
                    {"samples_missing", count(status.samples_missing())},
                    {"gaps_of_unknown_length", count(status.gaps_of_unknown_length())},
                    {"overflows", count(status.overflows())},
                    {"reconnects", count(status.reconnects())},
                    {"ring_overruns", count(status.ring_overruns())},
                    {"triggers", count(status.triggers())},
                    {"shots_journaled", count(status.shots_journaled())},
                    {"journal_failures", count(status.journal_failures())},
                    {"shots_stored", count(status.shots_stored())},
                    {"disk_free_bytes", count(status.disk_free_bytes())},
                    {"bench", status.bench_path()},
                    {"store", status.store_folder()},
                    {"software_version", status.software_version()},
                    {"boot_id", hexadecimal(status.boot_id())},
                    {"results_endpoint", status.results_endpoint()},
                    {"preview_endpoint", status.preview_endpoint()},
                    {"channels", list_of(status.channels())},
                    {"timings", list_of(status.timings())},
                    {"model", status.model_path()},
                    {"comparison", describe(status.comparison())},
                    {"diagnosis", describe(status.diagnosis())}};
}

JsonValue describe(const v1::Comparison& comparison) {
  JsonList places;
  for (const v1::MisfitPlace& place : comparison.places()) {
    places.push_back(JsonObject{{"gauge", place.gauge()},
                                {"window", place.window()},
                                {"band_Hz", std::vector<double>{place.low_hz(), place.high_hz()}},
                                {"sigma", place.sigma()},
                                {"share", place.share()}});
  }
  return JsonObject{
      {"shot", comparison.shot_id()},
      {"model", comparison.model_path()},
      {"model_sha256", comparison.model_sha256()},
      {"comparable", comparison.comparable()},
      {"reason", comparison.reason()},
      {"misfit", describe(comparison.misfit())},
      {"excess_share", comparison.excess_share()},
      {"light", wire::name_of(comparison.light())},
      {"rule", comparison.rule()},
      {"where", std::move(places)},
      {"trend", std::vector<double>(comparison.trend().begin(), comparison.trend().end())},
      {"duration_s", comparison.duration_s()}};
}

JsonValue describe(const v1::DiagnosisSummary& summary) {
  return JsonObject{{"id", summary.id()},
                    {"state", diagnosis_state(summary.state())},
                    {"step", summary.step()},
                    {"verdict", summary.verdict()},
                    {"effects", texts(summary.effects())}};
}

JsonValue describe(const v1::Diagnosis& diagnosis) {
  JsonObject ties;
  // In the order of their names, whatever the map's.
  const std::map<std::string, v1::TextList> sorted(diagnosis.tied_with().begin(),
                                                   diagnosis.tied_with().end());
  for (const auto& [id, others] : sorted) {
    ties.push_back({id, texts(others.items())});
  }
  const v1::HeldOut& held_out = diagnosis.misfit().held_out();
  JsonObject object{{"id", diagnosis.summary().id()},
                    {"state", diagnosis_state(diagnosis.summary().state())},
                    {"step", diagnosis.summary().step()},
                    {"shots", texts(diagnosis.shots())},
                    {"model", diagnosis.model_path()},
                    {"verdict", diagnosis.summary().verdict()},
                    {"effects", texts(diagnosis.summary().effects())},
                    {"tied_with", std::move(ties)},
                    {"misfit", JsonObject{{"before", describe(diagnosis.misfit().before())},
                                          {"after", describe(diagnosis.misfit().after())},
                                          {"held_out", JsonObject{{"before", held_out.before()},
                                                                  {"after", held_out.after()},
                                                                  {"floor", held_out.floor()}}}}},
                    {"candidates", list_of(diagnosis.candidates())},
                    {"next_experiment", list_of(diagnosis.next_experiment())},
                    {"unexplained_log_p", diagnosis.unexplained_log_p()},
                    {"notes", texts(diagnosis.notes())},
                    {"stored_as", diagnosis.stored_as()}};
  return object;
}

/// Null where there is no such number.
JsonValue if_any(bool known, double number) {
  return known ? JsonValue(number) : JsonValue(nullptr);
}

JsonValue describe(const v1::ShotSummary& shot) {
  const bool ball = shot.peak_force_n() > 0.0;
  const bool specimen = shot.reducible() && !ball;
  return JsonObject{{"id", shot.id()},
                    {"time", iso_time(shot.utc_ns())},
                    {"capture", shot.capture()},
                    {"verdict", verdict_name(shot.verdict())},
                    {"reducible", shot.reducible()},
                    {"reason", shot.reason()},
                    {"peak_stress_Pa", if_any(specimen, shot.peak_stress_pa())},
                    {"peak_strain", if_any(specimen, shot.peak_strain())},
                    {"peak_force_N", if_any(ball, shot.peak_force_n())},
                    {"restitution", if_any(shot.restitution() > 0.0, shot.restitution())}};
}

JsonValue describe(const v1::Preflight& preflight) {
  JsonList checks;
  for (const v1::PreflightCheck& check : preflight.checks()) {
    checks.push_back(
        JsonObject{{"name", check.name()}, {"ok", check.ok()}, {"text", check.text()}});
  }
  return checks;
}

}  // namespace kolsky::cli
