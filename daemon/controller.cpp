#include "daemon/controller.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "daemon/log.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/codec.hpp"

namespace kolsky {

namespace {

std::uint64_t free_bytes(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? 0 : space.available;
}

v1::Quality::Verdict wire_verdict(const std::string& verdict) {
  if (verdict == "pass") {
    return v1::Quality::PASS;
  }
  if (verdict == "warn") {
    return v1::Quality::WARN;
  }
  return v1::Quality::FAIL;  // also of a capture that is damaged or missing
}

}  // namespace

Controller::Controller(Station& station) : station_(station) {}

int Controller::state() const {
  const Acquirer& acquirer = station_.acquirer();
  if (!station_.started()) {
    return v1::STARTING;
  }
  if (station_.ended()) {
    return v1::ENDED;
  }
  if (!acquirer.connected()) {
    return v1::DISCONNECTED;
  }
  if (acquirer.capturing() || acquirer.ended()) {
    return v1::CAPTURING;  // also while the last windows of a replay are on their way
  }
  return acquirer.armed() ? v1::ARMED : v1::DISARMED;
}

void Controller::status(v1::Status& status) {
  const Acquirer::Counters read = station_.acquirer().counters();
  const ShotRecorder::Counters recorded = station_.recorder().counters();
  const StreamInfo& stream = station_.stream();
  status.set_state(static_cast<v1::DaemonState>(state()));
  status.set_digitiser_uri(stream.uri);
  status.set_digitiser_description(stream.description);
  status.set_simulated(stream.simulated);
  status.set_sampling_frequency_hz(stream.rate.Hz());
  status.set_samples_read(read.samples_read);
  status.set_samples_missing(read.samples_missing);
  status.set_gaps_of_unknown_length(read.gaps_of_unknown_length);
  status.set_overflows(read.overflows);
  status.set_reconnects(read.reconnects);
  status.set_ring_overruns(recorded.ring_overruns + read.windows_refused);
  status.set_triggers(read.triggers);
  status.set_shots_journaled(recorded.shots_journaled);
  status.set_journal_failures(recorded.journal_failures);
  status.set_shots_stored(station_.archivist().stored());
  status.set_last_shot_id(station_.recorder().last_shot_id());
  status.set_disk_free_bytes(free_bytes(station_.store().root));
  status.set_software_version(KOLSKY_VERSION);
  status.set_bench_path(station_.settings()->bench_path);
  status.set_store_folder(station_.store().root.string());
  status.set_results_endpoint(station_.publisher().results_endpoint());
  status.set_preview_endpoint(station_.publisher().preview_endpoint());
  for (const StageDuration& lap : station_.recorder().last_timings()) {
    v1::StageTiming& timing = *status.add_timings();
    timing.set_stage(lap.stage);
    timing.set_duration_s(lap.duration_s);
  }
  fill_channels(status);
  fill_criticism(status);
}

void Controller::fill_criticism(v1::Status& status) {
  if (const auto model = station_.critic().model()) {
    status.set_model_path(model->path.string());
  }
  v1::Comparison comparison;
  if (station_.critic().last(comparison)) {
    *status.mutable_comparison() = std::move(comparison);
  }
  v1::Diagnosis diagnosis;
  if (station_.diagnoses().last(diagnosis)) {
    *status.mutable_diagnosis() = diagnosis.summary();
  }
}

void Controller::diagnose(const v1::Diagnose& request, v1::Diagnosis& diagnosis) {
  station_.diagnoses().begin(station_.critic().model(), request, diagnosis);
}

void Controller::diagnosis(v1::Diagnosis& diagnosis) {
  if (!station_.diagnoses().last(diagnosis)) {
    throw InputError("diagnosis", "none was asked for yet", "`kolsky diagnose-live` asks for one");
  }
}

void Controller::fill_channels(v1::Status& status) {
  const std::shared_ptr<const ShotSettings> settings = station_.settings();
  for (std::size_t i = 0; i < settings->blank.channels.size(); ++i) {
    const ChannelRecord& channel = settings->blank.channels[i];
    const SignalLevel level = station_.acquirer().level(i);
    v1::ChannelStatus& shown = *status.add_channels();
    shown.set_gauge(channel.gauge);
    shown.set_unit(channel.unit);
    shown.set_baseline((level.baseline_codes + channel.offset) * channel.scale);
    shown.set_noise_rms(level.noise_codes * std::abs(channel.scale));
    shown.set_trigger_level(level.level_codes * std::abs(channel.scale));
  }
}

void Controller::name_operator(std::function<std::string()> name) {
  const std::lock_guard lock(operator_mutex_);
  operator_ = std::move(name);
}

void Controller::publish_status() {
  v1::Status message;
  status(message);
  {
    const std::lock_guard lock(operator_mutex_);
    if (operator_) {
      message.set_operator_id(operator_());
    }
  }
  station_.publisher().publish_status(std::move(message));
}

void Controller::snapshot(v1::Snapshot& snapshot) {
  publish_status();
  station_.publisher().snapshot(snapshot);
}

PreflightFacts Controller::facts() {
  const std::shared_ptr<const ShotSettings> settings = station_.settings();
  PreflightFacts facts;
  facts.connected = station_.acquirer().connected();
  facts.ended = station_.acquirer().ended();
  facts.streaming = station_.acquirer().counters().samples_read > 0;
  facts.disk_free_bytes = free_bytes(station_.store().root);
  facts.window_samples = static_cast<std::size_t>(settings->pre_samples + settings->post_samples);
  facts.shot_bytes = facts.window_samples * settings->blank.channels.size() *
                     sample_bytes(station_.stream().format);
  facts.ring_samples = station_.ring().capacity_samples();
  facts.block_samples = station_.stream().max_block_samples;
  for (std::size_t i = 0; i < settings->blank.channels.size(); ++i) {
    const SignalLevel level = station_.acquirer().level(i);
    facts.channels.push_back({.baseline_codes = level.baseline_codes,
                              .noise_codes = level.noise_codes,
                              .constant_samples = level.constant_samples,
                              .learned = level.learned});
  }
  return facts;
}

std::vector<PreflightItem> Controller::try_arm() {
  std::vector<PreflightItem> items = preflight(facts(), station_.settings()->blank);
  if (passed(items)) {
    station_.acquirer().arm(true);
    log::info("armed");
  }
  return items;
}

void Controller::arm(v1::Preflight& preflight) {
  const std::vector<PreflightItem> items = try_arm();
  for (const PreflightItem& item : items) {
    v1::PreflightCheck& check = *preflight.add_checks();
    check.set_name(item.name);
    check.set_ok(item.ok);
    check.set_text(item.text);
  }
  publish_status();
  if (!passed(items)) {
    throw InputError("arm", failures(items), "mend that and arm again");
  }
}

void Controller::disarm() {
  station_.acquirer().arm(false);
  log::info("disarmed");
  publish_status();
}

void Controller::need_stream(const char* command) const {
  if (station_.acquirer().ended()) {
    throw InputError(command, "the replay is over", "start the daemon again to replay once more");
  }
  if (!station_.acquirer().connected()) {
    throw InputError(command, "the digitiser is disconnected", "wait until it is back");
  }
}

void Controller::force_trigger() {
  need_stream("force-trigger");
  station_.acquirer().force();
}

void Controller::fire() {
  if (!station_.stream().simulated) {
    throw InputError("fire", "the digitiser is not simulated, and nothing here actuates a gun",
                     "use force-trigger for a window without a shot");
  }
  need_stream("fire");
  if (!station_.acquirer().armed()) {
    throw InputError("fire", "the daemon is disarmed and would not see the shot", "arm first");
  }
  wait_for_trigger();
  station_.digitiser().fire();
}

/// After a shot the trigger holds off and learns anew: a pulse of that time would be lost.
void Controller::wait_for_trigger() const {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kLongest(3);
  const Clock::time_point until = Clock::now() + kLongest;
  while (!station_.acquirer().watching()) {
    if (Clock::now() > until) {
      throw InputError("fire", "the trigger is still held off or learning, and would miss the shot",
                       "fire again when it is quiet, or shorten trigger.hold_off_samples");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void Controller::reload() {
  const Acquirer& acquirer = station_.acquirer();
  if (acquirer.armed() || acquirer.capturing()) {
    throw InputError("reload", "the daemon is armed", "disarm first");
  }
  if (acquirer.recording()) {
    // It was taken with the bench as it was.
    throw InputError("reload", "a shot is being recorded", "ask again in a moment");
  }
  station_.reload();
  log::info("configuration reloaded");
  publish_status();
}

void Controller::list_shots(std::size_t most, v1::ShotList& shots) {
  for (const CatalogueEntry& entry : station_.archivist().newest(most)) {
    v1::ShotSummary& shot = *shots.add_shots();
    shot.set_id(entry.id);
    shot.set_utc_ns(entry.utc_ns);
    shot.set_capture((station_.store().shots() / entry.capture).string());
    shot.set_verdict(wire_verdict(entry.verdict));
    shot.set_reducible(entry.reducible);
    shot.set_reason(entry.reason);
    shot.set_peak_stress_pa(entry.peak_stress_Pa);
    shot.set_peak_strain(entry.peak_strain);
    shot.set_peak_force_n(entry.peak_force_N);
    shot.set_restitution(entry.restitution);
  }
}

void Controller::get_shot(const std::string& id, v1::ShotAndResult& shot) {
  const StoredShot stored = station_.archivist().get(id);
  wire::encode(stored.shot, stored.capture, *shot.mutable_shot());
  wire::encode(stored.reduction, stored.shot.id, *shot.mutable_result());
}

}  // namespace kolsky
