#include "drivers/files/tables/table_import.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/tables/quantise.hpp"
#include "drivers/files/tables/scope_table.hpp"
#include "drivers/files/tables/shot_facts.hpp"
#include "drivers/files/tables/table_cells.hpp"
#include "drivers/files/tables/time_axis.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/bridge/bridge.hpp"

namespace kolsky {

namespace {

constexpr double kRateTolerance = 0.01;

// A column and the table it is in.
struct Channel {
  const ScopeTable* table;
  const TableColumn* column;

  [[nodiscard]] std::string place() const { return table->file + ": column " + column->header; }
};

std::vector<Channel> all_channels(const std::vector<ScopeTable>& tables) {
  std::vector<Channel> channels;
  for (const ScopeTable& table : tables) {
    for (const TableColumn& column : table.columns) {
      channels.push_back({&table, &column});
    }
  }
  return channels;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

std::string headers_of(const std::vector<Channel>& channels) {
  std::vector<std::string> names(channels.size());
  std::transform(channels.begin(), channels.end(), names.begin(),
                 [](const Channel& channel) { return channel.column->header; });
  return listed(names);
}

std::string names_of(const std::vector<BenchChannel>& gauges) {
  std::vector<std::string> names(gauges.size());
  std::transform(gauges.begin(), gauges.end(), names.begin(),
                 [](const BenchChannel& gauge) { return gauge.name; });
  return listed(names);
}

bool is_called(const Channel& channel, const std::string& gauge) {
  const std::string name = lower_case(gauge);
  return lower_case(channel.column->header) == name || lower_case(channel.column->name) == name;
}

std::vector<Channel> channels_called(const std::vector<Channel>& channels,
                                     const std::string& gauge) {
  std::vector<Channel> found;
  std::copy_if(channels.begin(), channels.end(), std::back_inserter(found),
               [&](const Channel& channel) { return is_called(channel, gauge); });
  return found;
}

// In the bench's order: by name if any column is called like a gauge, else as the columns come.
std::vector<Channel> channels_of_gauges(const std::vector<Channel>& channels,
                                        const std::vector<BenchChannel>& gauges) {
  std::vector<Channel> chosen;
  std::string missing;
  for (const BenchChannel& gauge : gauges) {
    const std::vector<Channel> found = channels_called(channels, gauge.name);
    if (found.size() > 1) {
      throw InputError(found[1].place(),
                       "is gauge " + gauge.name + ", and so is " + found[0].place(),
                       "give each gauge one column");
    }
    if (found.empty()) {
      missing = missing.empty() ? gauge.name : missing;
    } else {
      chosen.push_back(found.front());
    }
  }
  const std::string& file = channels.front().table->file;
  if (!chosen.empty() && !missing.empty()) {
    throw InputError(
        file, "has no column for gauge " + missing + " (columns: " + headers_of(channels) + ")",
        "name a column for each gauge of the bench: " + names_of(gauges));
  }
  if (chosen.empty() && channels.size() != gauges.size()) {
    throw InputError(file,
                     "there are " + std::to_string(channels.size()) + " columns (" +
                         headers_of(channels) + ") for " + std::to_string(gauges.size()) +
                         " gauges (" + names_of(gauges) + ")",
                     "name the columns after the gauges, or give one for each in their order");
  }
  return chosen.empty() ? channels : chosen;
}

double unit_factor(const Channel& channel, const BenchChannel& gauge) {
  const bool strain = gauge.unit == "strain";
  if (!channel.column->unit) {
    return 1.0;
  }
  // A gauge that is called like the whole header has no unit in its name.
  if (lower_case(channel.column->header) == lower_case(gauge.name) &&
      channel.column->name != channel.column->header) {
    return 1.0;
  }
  const ColumnUnit& unit = *channel.column->unit;
  if ((unit.quantity == ColumnUnit::Quantity::strain) != strain) {
    throw InputError(channel.place(),
                     std::string("is in ") + (strain ? "volts" : "strain") + ", and gauge " +
                         gauge.name + " has unit = \"" + gauge.unit + "\"",
                     "correct the gauge's unit in the bench file");
  }
  return unit.factor;
}

// No bar survives a tenth of strain, no amplifier gives kilovolts: the column is in another unit.
void require_plausible(const Channel& channel, const BenchChannel& gauge,
                       const std::vector<double>& values) {
  const bool strain = gauge.unit == "strain";
  const double most = strain ? 0.1 : 1000.0;
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](double value) { return std::abs(value) > most; });
  if (found != values.end()) {
    throw InputError(channel.table->place(static_cast<std::size_t>(found - values.begin())) +
                         ": column " + channel.column->header,
                     "reads " + in_words(*found, gauge.unit) + ", beyond " + in_words(most, ""),
                     strain ? "name the unit in the header, as \"" + gauge.name + "/microstrain\""
                            : "name the unit in the header, as \"" + gauge.name + "/mV\"");
  }
}

// Full scale of an imported photo-sensor's channel.
constexpr double kPhotoSensorRange_V = 15.0;

// Full scale of an imported gauge, whatever the record: captures of one bench then have one scale
// and replay as one stream. Few bars take more strain, and a step of it, 7e-6 microstrain, is below
// every noise; a record that goes beyond has a coarser scale.
double full_scale_of(const Gauge& gauge, const Bench& bench) {
  constexpr double kStrain = 0.0155;
  try {
    const BridgeConversion conversion(gauge, bench.bar_of(gauge), bench.positive);
    return kStrain / std::abs(conversion.sensitivity());
  } catch (const InputError&) {
    return 0.0;  // nothing converts it to strain, here or later: the record's own largest value
  }
}

ChannelRecord record_of(const Channel& channel, const BenchChannel& gauge, double full_scale,
                        const EvenTimes& even) {
  std::vector<double> values = channel.column->values;
  const double factor = unit_factor(channel, gauge);
  for (double& value : values) {
    value *= factor;
  }
  require_plausible(channel, gauge, values);
  if (farthest_off(*channel.table, even) > 0.0) {
    values = interpolated(channel.table->time_s, values, even);
  }
  QuantisedValues quantised = quantise(values, full_scale);
  ChannelRecord record;
  record.gauge = gauge.name;
  record.unit = gauge.unit;
  record.scale = quantised.scale;
  record.bits = 32;
  record.code_min = std::numeric_limits<std::int32_t>::min();
  record.code_max = std::numeric_limits<std::int32_t>::max();
  record.codes = std::move(quantised.codes);
  return record;
}

double agreed_rate_Hz(const std::vector<ScopeTable>& tables, double bench_rate_Hz) {
  const double rate_Hz = measured_rate_Hz(tables.front());
  for (const ScopeTable& table : tables) {
    (void)measured_rate_Hz(table);
    require_same_time_axis(tables.front(), table);
  }
  // A time column that is stretched by as much has a rate that is off by a little less.
  if (std::max(rate_Hz / bench_rate_Hz, bench_rate_Hz / rate_Hz) > 1.0 + kRateTolerance - 1e-9) {
    throw InputError(tables.front().file + ": time",
                     "gives " + in_words(rate_Hz, "samples/s") + " where the bench has " +
                         in_words(bench_rate_Hz, "Hz"),
                     "correct sampling_frequency_Hz, or name time's unit in the header");
  }
  return rate_Hz;
}

std::string digits(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::set<std::string> reserved_meta() {
  return {"source_file",    "source_sha256",   "measured_rate_Hz",
          "first_sample_s", "ignored_columns", kInterpolatedFrom};
}

void check_meta(const std::map<std::string, std::string>& meta) {
  check_shot_facts(meta);
  for (const auto& [key, text] : meta) {
    if (reserved_meta().contains(key)) {
      throw InputError("meta " + key, "is filed by the import itself", "choose another name");
    }
  }
}

void file_source(const std::vector<ScopeTable>& tables, double rate_Hz, Shot& shot) {
  std::vector<std::string> files;
  std::vector<std::string> digests;
  for (const ScopeTable& table : tables) {
    files.push_back(std::filesystem::path(table.file).filename().string());
    digests.push_back(table.sha256);
  }
  shot.meta["source_file"] = listed(files);
  shot.meta["source_sha256"] = listed(digests);
  shot.meta["measured_rate_Hz"] = digits(rate_Hz);
  shot.meta["first_sample_s"] = digits(tables.front().time_s.front());
}

// A record has the bench's rate; where a table has another, the values at its times are meant.
void file_interpolated(const std::vector<ScopeTable>& tables, const EvenTimes& even, Shot& shot) {
  double farthest = 0.0;
  for (const ScopeTable& table : tables) farthest = std::max(farthest, farthest_off(table, even));
  if (farthest > 0.0) shot.meta[kInterpolatedFrom] = digits(farthest);
}

void file_ignored(const std::vector<Channel>& channels, const std::vector<Channel>& chosen,
                  Shot& shot) {
  std::vector<std::string> ignored;
  for (const Channel& channel : channels) {
    const bool taken = std::any_of(chosen.begin(), chosen.end(), [&](const Channel& other) {
      return other.column == channel.column;
    });
    if (!taken) {
      ignored.push_back(channel.column->header);
    }
  }
  if (!ignored.empty()) {
    shot.meta[kIgnoredColumns] = listed(ignored);
  }
}

void file_columns_in_order(const std::vector<Channel>& chosen,
                           const std::vector<BenchChannel>& gauges, Shot& shot) {
  const bool named = std::ranges::any_of(gauges, [&](const BenchChannel& gauge) {
    return !channels_called(chosen, gauge.name).empty();
  });
  if (named) {
    return;
  }
  std::vector<std::string> headers;
  for (const Channel& channel : chosen) {
    headers.push_back(channel.column->header);
  }
  shot.meta[kColumnsInOrder] = listed(headers);
}

// Ids name files, so they keep to what every file system takes.
std::string id_from(const std::string& stem) {
  constexpr std::size_t kLongest = 100;
  std::string id = stem.substr(0, kLongest);
  for (char& c : id) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '-' || c == '_' || c == '.';
    c = plain ? c : '_';
  }
  return id.empty() || id.front() == '.' ? "shot" + id : id;
}

std::int64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace

Shot import_tables(const TableImport& request) {
  if (request.tables.empty()) {
    throw InputError("import", "no table is given", "name at least one file");
  }
  check_meta(request.meta);
  BenchFile bench = read_bench(request.bench);
  std::vector<ScopeTable> tables;
  std::set<std::filesystem::path> read;
  for (const std::filesystem::path& path : request.tables) {
    if (!read.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(path))).second) {
      throw InputError(path.string(), "is given twice", "name each table once");
    }
    tables.push_back(read_scope_table(path));
  }
  const std::vector<Channel> channels = all_channels(tables);
  const std::vector<BenchChannel> wanted = bench.bench.channels();
  const std::vector<Channel> chosen = channels_of_gauges(channels, wanted);
  Shot shot;
  shot.meta = request.meta;
  file_source(tables, agreed_rate_Hz(tables, bench.bench.sampling_frequency_Hz), shot);
  const EvenTimes even = even_times(tables.front(), bench.bench.sampling_frequency_Hz);
  file_interpolated(tables, even, shot);
  file_ignored(channels, chosen, shot);
  file_columns_in_order(chosen, wanted, shot);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double full_scale = i < bench.bench.gauges.size()
                                  ? full_scale_of(bench.bench.gauges[i], bench.bench)
                                  : kPhotoSensorRange_V;
    shot.channels.push_back(record_of(chosen[i], wanted[i], full_scale, even));
  }
  shot.id = id_from(tables.front().stem);
  shot.rate = SampleRate::from_Hz(bench.bench.sampling_frequency_Hz);
  shot.bench = std::move(bench.bench);
  shot.bench_toml = std::move(bench.text);
  shot.utc_ns = request.utc_ns ? *request.utc_ns : now_ns();
  shot.software_version = KOLSKY_VERSION;
  return shot;
}

}  // namespace kolsky
