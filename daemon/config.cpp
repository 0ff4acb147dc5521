#include "daemon/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>

#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/settings/toml_table.hpp"
#include "drivers/files/tables/shot_facts.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/reduction/requested.hpp"

namespace kolsky {

namespace {

// The ring holds a window four times, and at its start the daemon reduces one.
constexpr std::int64_t kLongestWindow = std::int64_t{1} << 21;
constexpr std::int64_t kLongestHoldOff = std::int64_t{1} << 26;
constexpr std::int64_t kLongestJournal_bytes = std::int64_t{1} << 40;
constexpr std::string_view kReplay = "replay:";

// Absolute, because clients that run elsewhere are told of it.
std::filesystem::path beside(const std::filesystem::path& file, const std::filesystem::path& path) {
  return (std::filesystem::absolute(file).parent_path() / path).lexically_normal();
}

double number_within(const TomlTable& table, const std::string& key, double otherwise, double least,
                     double most) {
  const double value = table.optional_number(key).value_or(otherwise);
  if (value < least || value > most) {
    throw table.error(key, fmt::format("{} is out of range", value),
                      fmt::format("give {} to {}", least, most));
  }
  return value;
}

std::int64_t integer_within(const TomlTable& table, const std::string& key, std::int64_t otherwise,
                            std::int64_t least, std::int64_t most) {
  const std::int64_t value = table.optional_integer(key).value_or(otherwise);
  if (value < least || value > most) {
    throw table.error(key, fmt::format("{} is out of range", value),
                      fmt::format("give {} to {}", least, most));
  }
  return value;
}

void check_uri(const TomlTable& table, const std::string& uri) {
  constexpr std::array<std::string_view, 5> kSchemes{"ip:", "usb:", "serial:", "local:", kReplay};
  const auto* scheme = std::find_if(kSchemes.begin(), kSchemes.end(),
                                    [&](std::string_view known) { return uri.starts_with(known); });
  if (scheme == kSchemes.end()) {
    throw table.error("uri", fmt::format("'{}' is no digitiser URI", uri),
                      "give ip:HOST:PORT, usb:..., local: or replay:CAPTURE-OR-FOLDER");
  }
  if (uri == "ip:" || uri == "serial:") {
    throw table.error("uri", fmt::format("'{}' names no digitiser", uri),
                      fmt::format("give {}{}", uri, uri == "ip:" ? "HOST:PORT" : "DEVICE"));
  }
}

DigitiserConfig read_digitiser(const TomlTable& table, const std::filesystem::path& file) {
  table.expect({"uri", "device", "channels", "block_samples", "speed"});
  DigitiserConfig digitiser;
  digitiser.uri = table.text("uri");
  check_uri(table, digitiser.uri);
  if (digitiser.uri.starts_with(kReplay)) {
    const std::string source = digitiser.uri.substr(kReplay.size());
    if (source.empty()) {
      throw table.error("uri", "names nothing to replay", "give replay:CAPTURE-OR-FOLDER");
    }
    digitiser.uri = std::string(kReplay) + beside(file, source).string();
  }
  digitiser.device = table.optional_text("device").value_or("");
  digitiser.channels = table.optional_texts("channels").value_or(std::vector<std::string>{});
  if (std::set(digitiser.channels.begin(), digitiser.channels.end()).size() !=
      digitiser.channels.size()) {
    throw table.error("channels", "names a channel twice", "give each gauge a channel of its own");
  }
  if (table.has("block_samples")) {
    digitiser.block_samples = integer_within(table, "block_samples", 16, 16, 1 << 22);
  }
  digitiser.speed = number_within(table, "speed", 0.0, 0.0, 1e6);
  if (table.has("speed") && !digitiser.uri.starts_with(kReplay)) {
    throw table.error("speed", "is of a replay, and this digitiser has its own",
                      "leave it out, or give a replay: URI");
  }
  return digitiser;
}

std::optional<double> optional_within(const TomlTable& table, const std::string& key, double least,
                                      double most) {
  if (!table.has(key)) {
    return std::nullopt;
  }
  return number_within(table, key, least, least, most);
}

std::optional<std::int64_t> optional_integer_within(const TomlTable& table, const std::string& key,
                                                    std::int64_t least, std::int64_t most) {
  if (!table.has(key)) {
    return std::nullopt;
  }
  return integer_within(table, key, least, least, most);
}

TriggerConfig read_trigger(const TomlTable& table) {
  table.expect({"channel", "level_sigma", "hysteresis_share", "pre_samples", "post_samples",
                "hold_off_samples", "learn_samples", "minimum_width_s", "maximum_rise_s"});
  TriggerConfig trigger;
  trigger.channel = table.text("channel");
  trigger.level_sigma = number_within(table, "level_sigma", trigger.level_sigma, 3.0, 1e4);
  constexpr std::int64_t kByRate = TriggerConfig::kByRate;
  trigger.pre_samples =
      optional_integer_within(table, "pre_samples", 0, kLongestWindow).value_or(kByRate);
  trigger.post_samples =
      optional_integer_within(table, "post_samples", 16, kLongestWindow).value_or(kByRate);
  if (trigger.pre_samples + trigger.post_samples > kLongestWindow) {
    throw table.error("post_samples", "makes the window longer than the ring holds",
                      fmt::format("give at most {} together with pre_samples", kLongestWindow));
  }
  trigger.hysteresis_share = optional_within(table, "hysteresis_share", 0.05, 0.95);
  trigger.minimum_width_s = optional_within(table, "minimum_width_s", 0.0, 1.0);
  trigger.maximum_rise_s = optional_within(table, "maximum_rise_s", 0.0, 1.0);
  trigger.hold_off_samples = optional_integer_within(table, "hold_off_samples", 0, kLongestHoldOff);
  trigger.learn_samples = optional_integer_within(table, "learn_samples", 16, 1 << 20);
  return trigger;
}

/// Of tcp://ADDRESS:PORT; * asks for any that is free.
bool is_port(std::string_view text) {
  int port = -1;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, port);
  return text == "*" || (error == std::errc{} && stopped == end && port >= 0 && port <= 65535);
}

std::string read_endpoint(const TomlTable& table, const std::string& key,
                          const std::string& otherwise) {
  std::string endpoint = table.optional_text(key).value_or(otherwise);
  constexpr std::array<std::string_view, 3> kTransports{"tcp://", "ipc://", "inproc://"};
  const bool known = std::any_of(kTransports.begin(), kTransports.end(),
                                 [&](std::string_view t) { return endpoint.starts_with(t); });
  if (!known) {
    throw table.error(key, fmt::format("'{}' is no ZeroMQ endpoint", endpoint),
                      "give tcp://ADDRESS:PORT or ipc://PATH");
  }
  if (endpoint.starts_with(kTransports[0]) &&
      !is_port(std::string_view(endpoint).substr(endpoint.rfind(':') + 1))) {
    throw table.error(key, fmt::format("'{}' does not end in a port", endpoint),
                      "give tcp://ADDRESS:PORT, a port from 0 to 65535 or *");
  }
  return endpoint;
}

EndpointConfig read_endpoints(const TomlTable& table) {
  table.expect({"results", "preview", "control"});
  EndpointConfig endpoints;
  endpoints.results = read_endpoint(table, "results", endpoints.results);
  endpoints.preview = read_endpoint(table, "preview", endpoints.preview);
  endpoints.control = read_endpoint(table, "control", endpoints.control);
  const auto once = [&](const char* key, const std::string& one, const std::string& other) {
    if (one == other && !one.ends_with(":*")) {
      throw table.error(key, fmt::format("{} serves two purposes", one),
                        "give results, preview and control an endpoint each");
    }
  };
  once("preview", endpoints.results, endpoints.preview);
  once("control", endpoints.results, endpoints.control);
  once("control", endpoints.preview, endpoints.control);
  return endpoints;
}

std::string meta_value(const TomlTable& table, const std::string& key) {
  try {
    return table.text(key);
  } catch (const InputError&) {
    return fmt::format("{}", table.number(key));
  }
}

std::map<std::string, std::string> read_meta(const TomlTable& table,
                                             const std::filesystem::path& file) {
  std::map<std::string, std::string> meta;
  for (const std::string& key : table.keys()) {
    meta[key] = meta_value(table, key);
  }
  try {
    check_shot_facts(meta);
  } catch (const InputError& error) {
    throw error.inside(file.string());
  }
  return meta;
}

// What `kolsky reduce` takes for one capture means nothing for all to come.
void refuse_of_one_capture(const TomlTable& table) {
  for (const char* key : {"arrival", "arrival_s", "uncertainty", "draws", "softening", "bench",
                          "save", "svg", "csv"}) {
    if (table.has(key)) {
      throw table.error(key, "is of one capture, and this is for all to come",
                        "leave it out here and give it to `kolsky reduce`");
    }
  }
}

ReductionRequest read_reduction(const TomlTable& table) {
  refuse_of_one_capture(table);
  table.expect({"dispersion", "separate", "stress", "inertia", "friction", "band_limit_Hz",
                "duration_s", kRequestTrue});
  ReductionRequest request;
  for (const auto& [key, word] : kRequestWords) {
    request.*word = table.optional_text(key);
  }
  for (const auto& [key, number] : kRequestNumbers) {
    request.*number = table.optional_number(key);
  }
  request.with_true = table.optional_flag(kRequestTrue).value_or(false);
  try {
    static_cast<void>(options_of(request));
  } catch (const InputError& error) {
    throw table.error(error.place(), error.problem(), error.mend());
  }
  return request;
}

void check_reduction(const DaemonConfig& config, const Apparatus& apparatus) {
  const std::string place = config.file.string() + ": reduction";
  try {
    require_suits(config.reduction, apparatus.bench, apparatus.bar_model);
  } catch (const InputError& error) {
    throw InputError(error.place().empty() ? place : place + "." + error.place(), error.problem(),
                     error.mend());
  }
  const double window_s =
      static_cast<double>(config.trigger.pre_samples + config.trigger.post_samples) /
      apparatus.bench.sampling_frequency_Hz;
  if (config.reduction.duration_s && *config.reduction.duration_s > window_s) {
    throw InputError(place + ".duration_s",
                     fmt::format("is longer than the window of {:.4g} s", window_s),
                     "give less, or longer trigger.post_samples");
  }
}

void check_gauges(const DaemonConfig& config, const Bench& bench) {
  const std::string place = config.bench.string();
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    try {
      const BridgeConversion conversion(gauge, bench.bar_of(gauge), bench.positive);
    } catch (const InputError& error) {
      throw error.inside(fmt::format("{}: gauges[{}]", place, i));
    }
  }
}

void check_trigger(const DaemonConfig& config, const Bench& bench) {
  try {
    check(trigger_options(config.trigger, bench.sampling_frequency_Hz));
  } catch (const InputError& error) {
    throw error.inside(config.file.string() + ": trigger");
  }
}

// A window as long at any rate, as far as memory for it is cheap.
void choose_window(TriggerConfig& trigger, double sample_rate_Hz) {
  constexpr double kBefore_s = 0.4e-3;
  constexpr double kAfter_s = 3.6e-3;
  constexpr double kMost = 100e3;
  const auto samples = [&](double duration_s, double least) {
    return std::llround(std::clamp(duration_s * sample_rate_Hz, least, kMost));
  };
  if (trigger.pre_samples == TriggerConfig::kByRate) {
    trigger.pre_samples = samples(kBefore_s, 0.0);
  }
  if (trigger.post_samples == TriggerConfig::kByRate) {
    trigger.post_samples = samples(kAfter_s, 16.0);
  }
}

/// Without a bar model the paper's PMMA is assumed: said to be wrong now, and not shot by shot.
void require_bars_assumable(const DaemonConfig& config, const Bench& bench) {
  try {
    (void)assumed_bars(bench);
  } catch (const InputError& error) {
    throw error.inside(config.bench.string());
  }
}

std::size_t find_trigger_channel(const DaemonConfig& config, const Bench& bench) {
  std::string known;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    if (bench.gauges[i].name == config.trigger.channel) {
      return i;
    }
    known += (known.empty() ? "" : ", ") + bench.gauges[i].name;
  }
  throw InputError(
      config.file.string() + ": trigger.channel",
      fmt::format("{} has no gauge '{}'", config.bench.string(), config.trigger.channel),
      "name one of " + known);
}

std::size_t whole_samples(double duration_s, double sample_rate_Hz) {
  // A duration of 5e-6 s at 1 MS/s is five samples, whatever the last bit says.
  return static_cast<std::size_t>(std::max(1.0, std::ceil(duration_s * sample_rate_Hz - 1e-6)));
}

}  // namespace

DaemonConfig read_config(const std::filesystem::path& path) {
  const TomlTable root = TomlTable::open(path);
  root.expect({"bench", "bar_model", "auto_arm", "digitiser", "trigger", "store", "endpoints",
               "ring", "meta", "model", "reduction"});
  DaemonConfig config;
  config.file = path;
  config.bench = beside(path, root.text("bench"));
  if (const auto model = root.optional_text("bar_model")) {
    config.bar_model = beside(path, *model);
  }
  config.auto_arm = root.optional_flag("auto_arm").value_or(false);
  config.digitiser = read_digitiser(root.table("digitiser"), path);
  config.trigger = read_trigger(root.table("trigger"));
  const TomlTable store = root.table("store");
  store.expect({"folder", "journal_limit_bytes"});
  const std::string folder = store.text("folder");
  if (folder.empty()) {
    throw store.error("folder", "is empty", "name the folder that takes the shots");
  }
  config.store = beside(path, folder);
  if (std::filesystem::exists(config.store) && !std::filesystem::is_directory(config.store)) {
    throw store.error("folder", config.store.string() + " is a file", "name a folder");
  }
  config.journal_limit_bytes = integer_within(
      store, "journal_limit_bytes", config.journal_limit_bytes, 4096, kLongestJournal_bytes);
  if (const auto endpoints = root.optional_table("endpoints")) {
    config.endpoints = read_endpoints(*endpoints);
  }
  if (const auto ring = root.optional_table("ring")) {
    ring->expect({"seconds"});
    config.ring_s = number_within(*ring, "seconds", 2.0, 1e-6, 3600.0);
  }
  if (const auto model = root.optional_table("model")) {
    model->expect({"file", "green_chi2", "amber_share"});
    config.model = beside(path, model->text("file"));
    config.light.green_chi2 =
        number_within(*model, "green_chi2", config.light.green_chi2, 1.0, 1e6);
    config.light.amber_share =
        number_within(*model, "amber_share", config.light.amber_share, 0.0, 1.0);
  }
  if (const auto reduction = root.optional_table("reduction")) {
    config.reduction = read_reduction(*reduction);
  }
  if (const auto meta = root.optional_table("meta")) {
    config.meta = read_meta(*meta, path);
  }
  root.finish();
  return config;
}

Apparatus read_apparatus(DaemonConfig& config) {
  BenchFile file = read_bench(config.bench);
  Apparatus apparatus;
  apparatus.bench = std::move(file.bench);
  apparatus.bench_toml = std::move(file.text);
  try {
    require_own_material_holds(apparatus.bench);
  } catch (const InputError& error) {
    throw error.inside(config.bench.string());
  }
  if (config.bar_model) {
    apparatus.bar_model = read_material(*config.bar_model);
    require_bar_model_holds(*apparatus.bar_model, apparatus.bench, config.bar_model->string());
  } else if (apparatus.bench.kind == BenchKind::shpb) {
    require_bars_assumable(config, apparatus.bench);
  }
  const std::size_t asked = config.digitiser.channels.size();
  const std::size_t gauges = apparatus.bench.channels().size();
  if (asked != 0 && asked != gauges) {
    throw InputError(
        config.file.string() + ": digitiser.channels",
        fmt::format("names {} channels, {} has {} {}", asked, config.bench.string(), gauges,
                    apparatus.bench.photo_sensors.empty() ? "gauges" : "gauges and photo-sensors"),
        "name one channel for each gauge, in the bench's order");
  }
  check_gauges(config, apparatus.bench);
  apparatus.trigger_channel = find_trigger_channel(config, apparatus.bench);
  choose_window(config.trigger, apparatus.bench.sampling_frequency_Hz);
  check_trigger(config, apparatus.bench);
  check_reduction(config, apparatus);
  return apparatus;
}

TriggerOptions trigger_options(const TriggerConfig& config, double sample_rate_Hz) {
  TriggerOptions options = TriggerOptions::for_rate(sample_rate_Hz);
  options.level_sigma = config.level_sigma;
  options.hysteresis_share = config.hysteresis_share.value_or(options.hysteresis_share);
  if (config.minimum_width_s) {
    options.minimum_width_samples = whole_samples(*config.minimum_width_s, sample_rate_Hz);
  }
  if (config.maximum_rise_s) {
    options.maximum_rise_samples = whole_samples(*config.maximum_rise_s, sample_rate_Hz);
  }
  const auto post_samples = static_cast<std::size_t>(config.post_samples);
  options.hold_off_samples = config.hold_off_samples
                                 ? static_cast<std::size_t>(*config.hold_off_samples)
                                 : std::max(options.hold_off_samples, post_samples);
  if (config.learn_samples) {
    options.learn_samples = static_cast<std::size_t>(*config.learn_samples);
  }
  return options;
}

DigitiserOptions digitiser_options(const DaemonConfig& config, const Bench& bench) {
  DigitiserOptions options;
  options.channels = config.digitiser.channels;
  for (const BenchChannel& channel : bench.channels()) {
    options.gauges.push_back(channel.name);
    options.units.push_back(channel.unit);
  }
  options.channel_count = options.units.size();
  options.sampling_frequency_Hz = bench.sampling_frequency_Hz;
  options.block_samples = static_cast<std::size_t>(config.digitiser.block_samples);
  options.device = config.digitiser.device;
  options.replay_speed = config.digitiser.speed;
  return options;
}

std::size_t ring_samples(const DaemonConfig& config, double arrival_rate_Hz,
                         std::size_t max_block_samples, std::size_t longest_capture_samples) {
  constexpr double kDefault_s = 2.0;
  constexpr double kDefaultMost = 1 << 22;
  const auto window =
      static_cast<std::size_t>(config.trigger.pre_samples + config.trigger.post_samples);
  const std::size_t least =
      std::max(4 * (window + max_block_samples), longest_capture_samples + 2 * max_block_samples);
  const double wanted = config.ring_s ? *config.ring_s * arrival_rate_Hz
                                      : std::min(kDefault_s * arrival_rate_Hz, kDefaultMost);
  return std::max(least, static_cast<std::size_t>(wanted));
}

}  // namespace kolsky
