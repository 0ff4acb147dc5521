#include <fmt/format.h>

#include "clients/cli/daemon_text.hpp"
#include "clients/cli/time_text.hpp"

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
                    {"shots_stored", count(status.shots_stored())},
                    {"disk_free_bytes", count(status.disk_free_bytes())},
                    {"bench", status.bench_path()},
                    {"store", status.store_folder()},
                    {"software_version", status.software_version()},
                    {"boot_id", hexadecimal(status.boot_id())},
                    {"results_endpoint", status.results_endpoint()},
                    {"preview_endpoint", status.preview_endpoint()},
                    {"channels", list_of(status.channels())},
                    {"timings", list_of(status.timings())}};
}

JsonValue describe(const v1::ShotSummary& shot) {
  return JsonObject{{"id", shot.id()},
                    {"time", iso_time(shot.utc_ns())},
                    {"capture", shot.capture()},
                    {"verdict", verdict_name(shot.verdict())},
                    {"reducible", shot.reducible()},
                    {"reason", shot.reason()},
                    {"peak_stress_Pa", shot.peak_stress_pa()},
                    {"peak_strain", shot.peak_strain()},
                    {"peak_force_N", shot.peak_force_n()},
                    {"restitution", shot.restitution()}};
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
