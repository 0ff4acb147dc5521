#include "clients/cli/reports/reduced_shot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/reduction/requested.hpp"

namespace kolsky::cli {
std::string absolute_name(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path absolute = std::filesystem::weakly_canonical(path, ignored);
  return (absolute.empty() ? path : absolute).string();
}

bool assumes_bar_model(const Shot& shot, const ReductionOptions& options) {
  return takes_bar_model(shot.bench) && !options.bar_model.has_value() &&
         !shot.bar_model.has_value();
}

void rebench(Shot& shot, const std::filesystem::path& path) {
  const BenchFile file = read_bench(path);
  const std::vector<BenchChannel> gauges = file.bench.channels();
  if (gauges.size() != shot.channels.size()) {
    throw InputError(path.string() + ": gauges",
                     std::to_string(gauges.size()) + " are filed but the capture has " +
                         std::to_string(shot.channels.size()) + " channels",
                     "file one gauge per channel, in their order");
  }
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    if (gauges[i].name != shot.channels[i].gauge || gauges[i].unit != shot.channels[i].unit) {
      throw InputError(path.string() + ": gauges[" + std::to_string(i) + "]",
                       gauges[i].name + " in " + gauges[i].unit + " stands where the capture has " +
                           shot.channels[i].gauge + " in " + shot.channels[i].unit,
                       "keep the gauges' names, units and order: they name the capture's channels");
    }
  }
  const double off = file.bench.sampling_frequency_Hz / shot.rate.Hz() - 1.0;
  if (std::abs(off) > 1e-9) {
    throw InputError(path.string() + ": sampling_frequency_Hz",
                     "is not the rate that the capture was taken at",
                     "give the capture's own rate; import the table again for another");
  }
  shot.bench = file.bench;
  shot.bench_toml = file.text;
}

namespace {

ReductionOptions options_with(const Asked& asked, const ReductionRequest& request) {
  ReductionOptions options = options_of(request);
  options.arrival_s = asked.arrival_s;
  options.bar_model = asked.bar_model;
  return options;
}

}  // namespace

ReducedShot reduce_capture(const std::filesystem::path& capture, const Asked& asked) {
  ReducedShot reduced;
  reduced.shot = read_capture(capture);
  reduced.capture = absolute_name(capture);
  try {
    reduced.request = asked.as_filed ? asked.request.over(reduced.shot.reduction) : asked.request;
    reduced.options = options_with(asked, reduced.request);
    if (asked.bench.has_value()) {
      reduced.bench = absolute_name(*asked.bench);
      reduced.as_filed = Reducer(reduced.options).reduce(reduced.shot);
      rebench(reduced.shot, *asked.bench);
    }
    require_own_band_known(reduced.shot.bench, reduced.options.band_limit_Hz);
    reduced.default_bar_model = assumes_bar_model(reduced.shot, reduced.options);
    reduced.reduction = Reducer(reduced.options).reduce(reduced.shot);
  } catch (const InputError& error) {
    throw error.inside(capture.string());
  }
  return reduced;
}

std::string verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "pass";
    case Verdict::warn:
      return "warn";
    case Verdict::fail:
      return "fail";
  }
  return "fail";
}

Ink verdict_ink(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return Ink::good;
    case Verdict::warn:
      return Ink::doubtful;
    case Verdict::fail:
      return Ink::bad;
  }
  return Ink::bad;
}

}  // namespace kolsky::cli
