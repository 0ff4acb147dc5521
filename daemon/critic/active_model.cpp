#include "daemon/critic/active_model.hpp"

#include <algorithm>
#include <span>

#include "drivers/files/settings/file_bytes.hpp"
#include "drivers/files/sha256.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 26U;

void require_gauges(const ActiveModel& model, const Bench& bench) {
  for (const EffectUse& use : model.file.model.effects) {
    const bool there = use.gauge.empty() ||
                       std::any_of(bench.gauges.begin(), bench.gauges.end(),
                                   [&](const Gauge& gauge) { return gauge.name == use.gauge; });
    if (!there) {
      std::string names;
      for (const Gauge& gauge : bench.gauges) {
        names += (names.empty() ? "" : ", ") + gauge.name;
      }
      throw InputError(model.path.string() + ": effect " + use.id(),
                       "names a gauge that the bench does not have: its gauges are " + names,
                       "fit a model to captures of this bench");
    }
  }
}

}  // namespace

std::shared_ptr<const ActiveModel> read_active_model(const DaemonConfig& config,
                                                     const Bench& bench) {
  if (!config.model) {
    return nullptr;
  }
  auto model = std::make_shared<ActiveModel>();
  model->path = *config.model;
  model->rule = config.light;
  const std::string text = read_file_bytes(model->path, kMostBytes);
  model->sha256 = sha256_hex(std::as_bytes(std::span(text)));
  model->file = parse_model(text, model->path.string());
  if (model->file.model.kind != bench.kind) {
    throw InputError(model->path.string() + ": kind",
                     "is " + name_of(model->file.model.kind) + ", and " + config.bench.string() +
                         " is of kind " + name_of(bench.kind),
                     "make one with `kolsky model new --bench`");
  }
  const auto& history = model->file.history;
  if (std::none_of(history.begin(), history.end(),
                   [](const ModelStep& step) { return !step.data_sha256.empty(); })) {
    throw InputError(model->path.string(), "was never fitted, so that no misfit means anything",
                     "fit it with `kolsky fit`");
  }
  require_gauges(*model, bench);
  return model;
}

}  // namespace kolsky
