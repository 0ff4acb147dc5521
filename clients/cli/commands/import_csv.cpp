#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/figure/layout.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/files/tables/table_import.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  std::vector<std::string> tables;
  std::string bench;
  std::string output;
  std::vector<std::string> meta;
};

std::map<std::string, std::string> meta_of(const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> meta;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("kolsky import csv: --meta", "\"" + pair + "\" is not key=value",
                       "write for example --meta striker_speed_m_per_s=12.5, files before it");
    }
    if (!meta.emplace(pair.substr(0, equals), pair.substr(equals + 1)).second) {
      throw InputError("kolsky import csv: --meta", pair.substr(0, equals) + " is given twice",
                       "give each key once");
    }
  }
  return meta;
}

std::string meta_or_empty(const Shot& shot, const char* key) {
  const auto found = shot.meta.find(key);
  return found != shot.meta.end() ? found->second : std::string();
}

std::vector<std::string> channel_names(const Shot& shot) {
  std::vector<std::string> names;
  for (const ChannelRecord& channel : shot.channels) {
    names.push_back(channel.gauge);
  }
  return names;
}

int run(const Settings& settings, Context& context) {
  TableImport request;
  request.tables.assign(settings.tables.begin(), settings.tables.end());
  request.bench = settings.bench;
  request.meta = meta_of(settings.meta);
  const Shot shot = import_tables(request);
  write_capture(shot, settings.output);
  const std::vector<std::string> channels = channel_names(shot);
  const double length_s = static_cast<double>(shot.samples()) * shot.rate.period_s();
  if (context.json) {
    context.out << to_text(JsonObject{{"capture", absolute_name(settings.output)},
                                      {"shot", shot.id},
                                      {"samples", static_cast<std::uint64_t>(shot.samples())},
                                      {"channels", channels},
                                      {"sampling_frequency_Hz", shot.rate.Hz()},
                                      {"duration_s", length_s},
                                      {kColumnsInOrder, meta_or_empty(shot, kColumnsInOrder)},
                                      {kIgnoredColumns, meta_or_empty(shot, kIgnoredColumns)}})
                << "\n";
    return kDone;
  }
  context.out << fmt::format("{}: {} samples of {} at {}, {}\n", settings.output, shot.samples(),
                             joined(channels), with_unit(shot.rate.Hz(), "Hz"),
                             with_unit(length_s, "s"));
  if (const std::string columns = meta_or_empty(shot, kColumnsInOrder); !columns.empty()) {
    context.out << fmt::format("no column is called like a gauge: {} are taken for {}, in order\n",
                               columns, joined(channels));
  }
  if (const std::string columns = meta_or_empty(shot, kIgnoredColumns); !columns.empty()) {
    context.out << fmt::format("left out, for no gauge is called so: {}\n", columns);
  }
  if (const auto off = shot.meta.find(kInterpolatedFrom); off != shot.meta.end()) {
    const double samples = std::stod(off->second);
    const bool rate_is_another = samples > 1.0;
    context.out << fmt::format(
        "the table's times are up to {:.2f} samples off even ones{}: values are interpolated\n",
        samples,
        rate_is_another ? fmt::format(" at {} (by {:.2g} % at the end; is the bench's "
                                      "sampling_frequency_Hz that of this table?)",
                                      with_unit(shot.rate.Hz(), "Hz"),
                                      100.0 * samples / static_cast<double>(shot.samples()))
                        : "");
  }
  return kDone;
}

}  // namespace

Command import_csv_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "import csv";
  command.purpose =
      "make a capture of tables that a scope or a program wrote\n"
      "Takes time_s,<gauge>,... and what PicoScope, Tektronix and others write, decimal commas "
      "too;\n"
      "several files are channels of one shot. The time column must agree with the bench's rate.";
  command.examples =
      "  kolsky import csv shot.csv --bench bench.toml -o shot.h5 --meta "
      "striker_speed_m_per_s=12.5\n"
      "  kolsky import csv ch1.csv ch2.csv --bench bench.toml -o shot.h5\n";
  command.arguments = {
      needed("FILE", "", "the tables, in the order of the bench's gauges if there are several",
             &s.tables),
      needed("--bench", "BENCH.toml", "the bench file: rate, bars, gauges, specimen", &s.bench),
      needed("-o,--output", "CAPTURE.h5",
             "the capture to write; an existing file is never overwritten", &s.output),
      option("--meta", "KEY=VALUE", "facts of this shot, SI units in the key", &s.meta)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
