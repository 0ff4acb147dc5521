#include <filesystem>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/daemon_shot.hpp"
#include "clients/cli/json_value.hpp"
#include "clients/cli/reduced_shot.hpp"
#include "drivers/files/export.hpp"

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

ReducedShot find(const std::string& what, const std::string& endpoint) {
  const bool is_file =
      std::filesystem::exists(what) || what.find('/') != std::string::npos || what.ends_with(".h5");
  if (is_file) {
    return reduce_capture(what, {});
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
  return {
      "export",
      "write a shot and its result for other programs: CSV, MATLAB or HDF5\n"
      "SI units, named in every column. CSV makes two files: the histories, and <name>-gauges.csv.",
      "  kolsky export shot.h5 --format csv -o shot.csv\n"
      "  kolsky export last --format mat -o shot.mat\n",
      true,
      {{"CAPTURE|ID",
        "CAPTURE|ID",
        "a capture file, or a shot's id (or last) from the daemon",
        &settings->what,
        true,
        {}},
       {"--format",
        "csv|mat|hdf5",
        "one of csv, mat, hdf5",
        &settings->format,
        true,
        {"csv", "mat", "hdf5"}},
       {"-o,--output",
        "FILE",
        "the file to write; an existing one is never overwritten",
        &settings->output,
        true,
        {}}},
      [settings](Context& context) { return run(*settings, context); }};
}

}  // namespace kolsky::cli
