#include <filesystem>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/daemon_shot.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/files/exports/export.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  std::string what;
  std::string format;
  std::string output;
};

ExportFormat format_of(const std::string& name) {
  if (name == "csv") {
    return ExportFormat::csv;
  }
  return name == "mat" ? ExportFormat::mat : ExportFormat::hdf5;
}

/// A bar by itself has gauges only, as has a shot that cannot be reduced.
ReducedShot exportable(const std::string& capture) {
  Shot shot = read_capture(capture);
  if (shot.bench.kind != BenchKind::bar) {
    return reduce_capture(capture);
  }
  ReducedShot bar;
  bar.shot = std::move(shot);
  bar.capture = absolute_name(capture);
  bar.reduction = not_reducible("a bar by itself has no specimen (see `kolsky identify bar`)",
                                "file bars.output and specimen, if there are");
  return bar;
}

ReducedShot find(const std::string& what, const std::string& endpoint) {
  const bool is_file =
      std::filesystem::exists(what) || what.find('/') != std::string::npos || what.ends_with(".h5");
  if (is_file) {
    return exportable(what);
  }
  ControlClient client = connect_patiently(endpoint);
  return fetch_shot(client, what);
}

int run(const Settings& settings, Context& context) {
  const ReducedShot reduced = find(settings.what, context.endpoint);
  export_shot(reduced.shot, reduced.reduction, format_of(settings.format), settings.output);
  if (context.json) {
    context.out << to_text(JsonObject{{"file", absolute_name(settings.output)},
                                      {"format", settings.format},
                                      {"shot", reduced.shot.id},
                                      {"capture", reduced.capture},
                                      {"reducible", reduced.reduction.quality.reducible},
                                      {"reason", reduced.reduction.quality.reason}})
                << "\n";
  } else {
    context.out << settings.output << ": " << reduced.shot.id << " as " << settings.format
                << (reduced.reduction.quality.reducible
                        ? ""
                        : ", gauges only: " + reduced.reduction.quality.reason)
                << "\n";
  }
  return kDone;
}

}  // namespace

Command export_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Argument format = needed("--format", "NAME", "csv, mat (MATLAB, version 5) or hdf5", &s.format);
  format.choices = {"csv", "mat", "hdf5"};
  Command command;
  command.name = "export";
  command.purpose =
      "write a shot and its result for other programs: CSV, MATLAB or HDF5\n"
      "SI units, named in every column. CSV makes two files: the histories, and <name>-gauges.csv.";
  command.examples =
      "  kolsky export shot.h5 --format csv -o shot.csv\n"
      "  kolsky export last --format mat -o shot.mat\n";
  command.uses_daemon = true;
  command.arguments = {
      needed("CAPTURE|ID", "", "a capture file, or a shot's id (or last) from the daemon", &s.what),
      format,
      needed("-o,--output", "FILE", "the file to write; an existing one is never overwritten",
             &s.output)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
