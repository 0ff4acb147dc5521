#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/digitiser/open.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/material.hpp"
#include "processing/base/reduction_request.hpp"
#include "processing/trigger/incident_trigger.hpp"

namespace kolsky {

/// What `[trigger]` asks for, in the units a person sets it in. What is not given follows from the
/// rate, as in TriggerOptions::for_rate.
struct TriggerConfig {
  static constexpr std::int64_t kByRate = -1;

  std::string channel;  ///< gauge whose record is watched
  double level_sigma = 8.0;
  std::int64_t pre_samples = kByRate;   ///< else of 0.4 ms, set by read_apparatus
  std::int64_t post_samples = kByRate;  ///< else of 3.6 ms, at most 100 000
  std::optional<double> hysteresis_share;
  std::optional<double> minimum_width_s;
  std::optional<double> maximum_rise_s;
  std::optional<std::int64_t> hold_off_samples;  ///< else at least post_samples, so that echoes
                                                 ///< stay in the window of their shot
  std::optional<std::int64_t> learn_samples;
};

struct DigitiserConfig {
  std::string uri;
  std::string device;
  std::vector<std::string> channels;
  std::int64_t block_samples = 0;  ///< 0: what arrives in about a millisecond
  double speed = 0.0;              ///< of a replay: factor on the real rate; 0: as fast as possible

  friend bool operator==(const DigitiserConfig&, const DigitiserConfig&) = default;
};

struct EndpointConfig {
  std::string results = "tcp://127.0.0.1:5600";
  std::string preview = "tcp://127.0.0.1:5601";
  std::string control = "tcp://127.0.0.1:5602";

  friend bool operator==(const EndpointConfig&, const EndpointConfig&) = default;
};

/// By what each shot's comparison with the active model is shown in a colour.
struct LightRule {
  double green_chi2 = 1.5;    ///< green up to this chi2 per degree of freedom
  double amber_share = 1e-3;  ///< else amber up to this misfit beyond noise, of the signal's energy

  friend bool operator==(const LightRule&, const LightRule&) = default;
};

/// What KOLSKYD.toml says. Paths are absolute; in the file
/// they are relative to the file.
struct DaemonConfig {
  std::filesystem::path file;
  std::filesystem::path bench;
  std::optional<std::filesystem::path> bar_model;
  std::optional<std::filesystem::path> model;  ///< what shots are compared with as they come
  LightRule light;
  ReductionRequest reduction;  ///< how shots are reduced as they come, filed with each of them
  std::filesystem::path store;
  std::int64_t journal_limit_bytes = 16 << 20;  ///< length at which a journal is ended
  DigitiserConfig digitiser;
  TriggerConfig trigger;
  EndpointConfig endpoints;
  std::optional<double>
      ring_s;             ///< how far back the ring reaches; none: what the window needs and more
  bool auto_arm = false;  ///< arm by itself as soon as the preflight passes
  std::map<std::string, std::string> meta;  ///< goes with every shot
};

/// @throws InputError: file, line, key and mend; unknown keys name the nearest known one
[[nodiscard]] DaemonConfig read_config(const std::filesystem::path& path);

/// The apparatus a configuration points to.
struct Apparatus {
  Bench bench;
  std::string bench_toml;
  std::optional<Material> bar_model;
  std::size_t trigger_channel = 0;  ///< index in bench.gauges
};

/// Reads the bench and the bar's material, and checks what only both files together can show: the
/// trigger channel is a gauge, as many digitiser channels as gauges, every gauge converts to
/// strain, shots of that bench can be reduced as asked. A window that was not given gets the
/// samples of its time at the bench's rate.
/// @throws InputError
[[nodiscard]] Apparatus read_apparatus(DaemonConfig& config);

/// The trigger's settings in samples at this rate.
[[nodiscard]] TriggerOptions trigger_options(const TriggerConfig& config, double sample_rate_Hz);

[[nodiscard]] DigitiserOptions digitiser_options(const DaemonConfig& config, const Bench& bench);

/// Samples per channel that the ring holds: `ring_s` where it is given, else two seconds, bounded
/// so that a fast scope does not take the memory; always several windows and blocks, and the
/// longest capture of a replay, which comes back whole.
/// @param arrival_rate_Hz  samples per second of the wall clock
[[nodiscard]] std::size_t ring_samples(const DaemonConfig& config, double arrival_rate_Hz,
                                       std::size_t max_block_samples,
                                       std::size_t longest_capture_samples = 0);

}  // namespace kolsky
