#include "daemon/station.hpp"

#include <fmt/format.h>

#include <new>
#include <stdexcept>
#include <utility>

#include "daemon/log.hpp"
#include "daemon/shots/shot_context.hpp"
#include "drivers/digitiser/open.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

StoreLayout created(const std::filesystem::path& folder) {
  StoreLayout store{folder};
  store.create();
  return store;
}

PublisherOptions publisher_options(const EndpointConfig& endpoints) {
  PublisherOptions options;
  options.results_endpoint = endpoints.results;
  options.preview_endpoint = endpoints.preview;
  return options;
}

std::shared_ptr<const ShotSettings> make_settings(const DaemonConfig& config,
                                                  const Apparatus& apparatus,
                                                  const StreamInfo& stream) {
  auto settings = std::make_shared<ShotSettings>();
  settings->blank = blank_shot(config, apparatus, stream);
  settings->bench_path = config.bench.string();
  settings->pre_samples = config.trigger.pre_samples;
  settings->post_samples = config.trigger.post_samples;
  return settings;
}

std::size_t longest(const StreamInfo& stream) {
  std::size_t samples = 0;
  for (const PlayedCapture& capture : stream.captures) {
    samples = std::max(samples, capture.samples);
  }
  return samples;
}

/// Of another bench file: that may be what is wanted, or a mistake that nothing else shows.
void name_other_benches(const StreamInfo& stream, const Apparatus& apparatus,
                        const DaemonConfig& config) {
  std::vector<std::string> others;
  for (const PlayedCapture& capture : stream.captures) {
    if (capture.bench_toml != apparatus.bench_toml) {
      others.push_back(capture.id);
    }
  }
  if (!others.empty()) {
    log::warning(fmt::format(
        "{} of {} captures were filed with a bench file that reads otherwise, {} first: {} is used",
        others.size(), stream.captures.size(), others.front(), config.bench.string()));
  }
}

void name_doubtful_bars(const Apparatus& apparatus) {
  const std::string doubt =
      apparatus.bar_model ? poorly_identified(*apparatus.bar_model) : std::string();
  if (!doubt.empty()) {
    log::warning("the bar model was " + doubt);
  }
}

SampleRing make_ring(const DaemonConfig& config, const StreamInfo& stream) {
  const std::size_t samples =
      ring_samples(config, arrival_rate_Hz(stream), stream.max_block_samples, longest(stream));
  try {
    return SampleRing(stream.format, stream.channels.size(), samples);
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  throw InputError(config.file.string() + ": ring.seconds",
                   fmt::format("a ring of {} samples does not fit the memory", samples),
                   "give less");
}

/// Recovers before a journal of this run is opened.
std::uint64_t recovered(const StoreLayout& store, std::uint64_t boot_id) {
  const StoreReport report = recover_store(store, DoneJournals::prune);
  for (const std::string& id : report.recovered) {
    log::info(fmt::format("shot {} was in a journal only; its capture is written now", id));
  }
  for (const std::string& name : report.set_aside) {
    log::warning(name + ": was damaged; its shot is restored from the journal");
  }
  if (report.pruned_shots != 0) {
    log::info(fmt::format("removed of journals: {}; shots in them, read back from captures: {}",
                          report.pruned.size(), report.pruned_shots));
  }
  for (const StoreReport::Problem& problem : report.problems) {
    log::warning(problem.file + ": " + problem.text);
  }
  return boot_id;
}

void check_unchanged(const DaemonConfig& was, const DaemonConfig& now) {
  const auto check = [&](bool same, const char* key) {
    if (!same) {
      throw InputError(now.file.string() + ": " + key, "cannot change while the daemon runs",
                       "restart kolskyd to take it");
    }
  };
  check(was.digitiser == now.digitiser, "digitiser");
  check(was.endpoints == now.endpoints, "endpoints");
  check(was.store == now.store, "store.folder");
  check(was.journal_limit_bytes == now.journal_limit_bytes, "store.journal_limit_bytes");
  check(was.ring_s == now.ring_s, "ring.seconds");
}

}  // namespace

Station::Station(DaemonConfig config)
    : endpoints_(config.endpoints),
      config_(std::move(config)),
      apparatus_(read_apparatus(config_)),
      store_(created(config_.store)),
      lock_(store_.root),
      publisher_(publisher_options(config_.endpoints)),
      journal_(store_, recovered(store_, publisher_.boot_id()),
               static_cast<std::uint64_t>(config_.journal_limit_bytes)),
      digitiser_(open_digitiser(config_.digitiser.uri, options_for_digitiser())),
      stream_(digitiser_->info()),
      settings_(make_settings(config_, apparatus_, stream_)),
      ring_(make_ring(config_, stream_)),
      acquirer_(*digitiser_, ring_, events_, plan(config_, apparatus_.trigger_channel)),
      archivist_(store_, journal_, [this](const std::string& text) { fault("store", text); }),
      critic_(publisher_),
      diagnoses_(publisher_, archivist_, store_),
      recorder_({.ring = ring_,
                 .events = events_,
                 .acquirer = acquirer_,
                 .journal = journal_,
                 .archivist = archivist_,
                 .publisher = publisher_,
                 .store = store_,
                 .real_time = !stream_.ends,
                 .captures = stream_.captures,
                 .published = [this](const auto& shot) { critic_.compare(shot); }},
                settings_) {
  name_other_benches(stream_, apparatus_, config_);
  name_doubtful_bars(apparatus_);
  critic_.change(read_active_model(config_, apparatus_.bench));
}

Station::~Station() {
  stop();
}

void Station::start() {
  archivist_.start();
  critic_.start();
  recorder_.start();
  digitiser_->start();
  acquirer_.start();
  started_.store(true);
}

void Station::stop() {
  if (std::exchange(stopped_, true)) {
    return;
  }
  acquirer_.stop();
  events_.close();
  recorder_.stop();
  critic_.stop();
  diagnoses_.stop();
  archivist_.stop();
}

std::shared_ptr<const ShotSettings> Station::settings() const {
  const std::lock_guard lock(settings_mutex_);
  return settings_;
}

DigitiserOptions Station::options_for_digitiser() {
  DigitiserOptions options = digitiser_options(config_, apparatus_.bench);
  options.tell = [this](const std::string& text) { fault("replay", text); };
  return options;
}

AcquisitionPlan Station::plan(const DaemonConfig& config, std::size_t trigger_channel) const {
  return {.trigger_channel = trigger_channel,
          .trigger = trigger_options(config.trigger, stream_.rate.Hz()),
          .pre_samples = config.trigger.pre_samples,
          .post_samples = config.trigger.post_samples};
}

void Station::reload() {
  DaemonConfig config = read_config(config_.file);
  check_unchanged(config_, config);
  Apparatus apparatus = read_apparatus(config);
  if (apparatus.bench.sampling_frequency_Hz != apparatus_.bench.sampling_frequency_Hz) {
    throw InputError(config.bench.string() + ": sampling_frequency_Hz",
                     "cannot change while the daemon runs", "restart kolskyd to take it");
  }
  if (stream_.ends && digitiser_options(config, apparatus.bench).gauges !=
                          digitiser_options(config_, apparatus_.bench).gauges) {
    // A replay takes its captures' channels by these names.
    throw InputError(config.bench.string() + ": gauges",
                     "cannot change their names or order during a replay",
                     "restart kolskyd to take them");
  }
  auto settings = make_settings(config, apparatus, stream_);
  auto model = read_active_model(config, apparatus.bench);
  recorder_.change(settings);
  critic_.change(std::move(model));
  acquirer_.change_plan(plan(config, apparatus.trigger_channel));
  config_ = std::move(config);
  apparatus_ = std::move(apparatus);
  name_doubtful_bars(apparatus_);
  const std::lock_guard lock(settings_mutex_);
  settings_ = std::move(settings);
}

void Station::fault(const char* kind, const std::string& text) {
  log::error(text);
  v1::Fault message;
  message.set_kind(kind);
  message.set_text(text);
  publisher_.publish_fault(message);
}

}  // namespace kolsky
