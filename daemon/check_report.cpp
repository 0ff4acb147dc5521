#include "daemon/check_report.hpp"

#include <fmt/format.h>

#include "processing/base/bar_model_check.hpp"

namespace kolsky {

namespace {

const char* name_of(BenchKind kind) {
  switch (kind) {
    case BenchKind::bar:
      return "bar";
    case BenchKind::shpb:
      return "shpb";
    case BenchKind::impact:
      break;
  }
  return "impact";
}

std::string gauges_line(const DaemonConfig& config, const Apparatus& apparatus) {
  std::string line;
  for (std::size_t i = 0; i < apparatus.bench.gauges.size(); ++i) {
    const Gauge& gauge = apparatus.bench.gauges[i];
    const std::string channel =
        config.digitiser.channels.empty() ? "" : " on " + config.digitiser.channels[i];
    line += fmt::format("{}{}{} ({} bar, {} m, {})", i == 0 ? "" : ", ", gauge.name, channel,
                        gauge.bar, gauge.position_m.value, gauge.unit);
  }
  return line;
}

std::string reduction_line(const ReductionRequest& request) {
  std::string line;
  const auto add = [&](const std::string& text) { line += (line.empty() ? "" : ", ") + text; };
  for (const auto& [key, word] : kRequestWords) {
    if (request.*word) {
      add(fmt::format("{} {}", key, *(request.*word)));
    }
  }
  for (const auto& [key, number] : kRequestNumbers) {
    if (request.*number) {
      add(fmt::format("{} {}", key, *(request.*number)));
    }
  }
  if (request.with_true) {
    add("true strain and stress too");
  }
  return line.empty() ? "as usual" : line;
}

}  // namespace

std::string check_report(const DaemonConfig& config, const Apparatus& apparatus) {
  const double rate_Hz = apparatus.bench.sampling_frequency_Hz;
  const TriggerConfig& trigger = config.trigger;
  const std::size_t block = config.digitiser.block_samples != 0
                                ? static_cast<std::size_t>(config.digitiser.block_samples)
                                : default_block(rate_Hz);
  const std::size_t ring = ring_samples(config, rate_Hz, block);
  const TriggerOptions options = trigger_options(trigger, rate_Hz);
  const auto milliseconds = [&](auto samples) {
    return 1e3 * static_cast<double>(samples) / rate_Hz;
  };
  std::string model = apparatus.bench.input.youngs_modulus_Pa ? "elastic, as in the bench"
                      : apparatus.bar_model                   ? apparatus.bar_model->source
                                                              : paper_pmma().source;
  if (apparatus.bench.output && apparatus.bench.output->material) {
    model += "; output bar by itself: " + apparatus.bench.output->material->source;
  }
  const std::string doubt =
      apparatus.bar_model ? poorly_identified(*apparatus.bar_model) : std::string();
  return fmt::format(
      "bench      {}: {}, {:.6g} MS/s\n"
      "bars       {}\n"
      "gauges     {}\n"
      "digitiser  {}, blocks of {} samples ({:.4g} ms)\n"
      "trigger    {} above {:.4g} sigma for {:.4g} us, hold-off {:.4g} ms\n"
      "window     {} + {} samples ({:.4g} + {:.4g} ms)\n"
      "ring       {} samples ({:.4g} s)\n"
      "store      {}\n"
      "model      {}\n"
      "reduction  {}\n"
      "endpoints  results {}, preview {}, control {}\n",
      config.bench.string(), name_of(apparatus.bench.kind), rate_Hz * 1e-6,
      doubt.empty() ? model : model + " (" + doubt + ")", gauges_line(config, apparatus),
      config.digitiser.uri, block, milliseconds(block), trigger.channel, trigger.level_sigma,
      1e3 * milliseconds(options.minimum_width_samples), milliseconds(options.hold_off_samples),
      trigger.pre_samples, trigger.post_samples, milliseconds(trigger.pre_samples),
      milliseconds(trigger.post_samples), ring, 1e-3 * milliseconds(ring), config.store.string(),
      config.model ? config.model->string() : "none, shots are not compared",
      reduction_line(config.reduction), config.endpoints.results, config.endpoints.preview,
      config.endpoints.control);
}

}  // namespace kolsky
