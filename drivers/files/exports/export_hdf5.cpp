#include <algorithm>
#include <set>

#include "drivers/files/captures/gauge_values.hpp"
#include "drivers/files/captures/hdf5_handles.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/exports/export_table.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr mode_t kMode = 0644;

/// The first column is the axis, the second what is plotted first.
void put_table(hid_t entry, const std::string& name, const ExportTable& table) {
  const auto group = hdf5::make_group(entry, name, "NXdata");
  std::set<std::string> used;
  std::vector<std::string> names;
  for (const ExportColumn& column : table) {
    names.push_back(hdf5::link_name(column.name, used));
    const auto dataset = hdf5::put_array(group, names.back(), column.values);
    hdf5::put_attribute(dataset, "units", column.unit);
    hdf5::put_attribute(dataset, "long_name", column.meaning);
  }
  hdf5::put_attribute(group, "axes", names.front());
  hdf5::put_attribute(group, "signal", names.at(1));
  if (names.size() > 2) {
    hdf5::put_attribute(group, "auxiliary_signals",
                        std::vector<std::string>(names.begin() + 2, names.end()));
  }
}

void put_quality(hid_t entry, const Reduction& reduction) {
  const auto group = hdf5::make_group(entry, "quality", "NXcollection");
  hdf5::put_attribute(group, "reducible", reduction.quality.reducible ? 1 : 0);
  hdf5::put_attribute(group, "reason", reduction.quality.reason);
  std::set<std::string> used;
  for (const Check& check : reduction.quality.checks) {
    const auto dataset = hdf5::put_number(group, hdf5::link_name(check.name, used), check.value);
    hdf5::put_attribute(dataset, "units", check.unit);
    hdf5::put_attribute(dataset, "limit", check.limit);
    hdf5::put_attribute(dataset, "verdict", verdict_name(check.verdict));
    hdf5::put_attribute(dataset, "text", check.text);
  }
}

void put_entry(hid_t file, const Shot& shot, const Reduction& reduction) {
  const bool reduced = !reduction.time_s.empty() || reduction.ball;
  const auto entry = hdf5::make_group(file, "entry", "NXentry");
  hdf5::put_attribute(entry, "default", reduced ? "histories" : "gauges");
  hdf5::put_text(entry, "title", shot.id);
  hdf5::put_text(entry, "start_time", iso8601_utc(shot.utc_ns));
  hdf5::put_text(entry, "bench_toml", shot.bench_toml);
  put_table(entry, "gauges", gauge_table(shot));
  if (reduced) {
    put_table(entry, "histories", history_table(reduction));
    hdf5::put_text(entry, "bar_model", reduction.bar_model);
  }
  put_quality(entry, reduction);
}

std::vector<std::byte> hdf5_bytes(const Shot& shot, const Reduction& reduction) {
  const hdf5::Session session;
  std::vector<std::byte> bytes;
  auto file = hdf5::create_file(bytes);
  hdf5::put_attribute(file, "NX_class", "NXroot");
  hdf5::put_attribute(file, "default", "entry");
  put_entry(file, shot, reduction);
  hdf5::close(std::move(file));
  return bytes;
}

}  // namespace

void export_hdf5(const Shot& shot, const Reduction& reduction, const std::filesystem::path& path) {
  NewFile file(path);
  try {
    file.write(hdf5_bytes(shot, reduction));
  } catch (const hdf5::Failure& failure) {
    throw InputError(path.string() + ": " + failure.object(), failure.problem(),
                     "check the length of the shot's texts");
  }
  file.publish(kMode);
}

}  // namespace kolsky
