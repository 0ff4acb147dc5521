#include <sys/stat.h>

#include <algorithm>
#include <set>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/capture_layout.hpp"
#include "drivers/files/captures/capture_seal.hpp"
#include "drivers/files/captures/gauge_values.hpp"
#include "drivers/files/captures/hdf5_handles.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/sha256.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

namespace layout = capture_layout;

std::vector<std::string> link_names(const std::vector<ChannelRecord>& channels) {
  std::set<std::string> used{layout::kTime};
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const ChannelRecord& channel : channels) {
    names.push_back(hdf5::link_name(channel.gauge, used));
  }
  return names;
}

/// What h5web, silx and nexpy plot: every gauge over time, in its unit.
void put_gauges(hid_t entry, const Shot& shot, const std::vector<std::string>& names) {
  const auto group = hdf5::make_group(entry, layout::kGauges, "NXdata");
  hdf5::put_attribute(group, "signal", names.front());
  if (names.size() > 1) {
    hdf5::put_attribute(group, "auxiliary_signals",
                        std::vector<std::string>(names.begin() + 1, names.end()));
  }
  hdf5::put_attribute(group, "axes", std::string(layout::kTime));
  const auto time = hdf5::put_array(group, layout::kTime, sample_times_s(shot));
  hdf5::put_attribute(time, "units", "s");
  hdf5::put_attribute(time, "long_name",
                      shot.trigger ? "time from the trigger" : "time from the first sample");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ChannelRecord& channel = shot.channels[i];
    const auto values = hdf5::put_array(group, names[i], gauge_values(channel));
    hdf5::put_attribute(values, "units", channel.unit);
    hdf5::put_attribute(values, "long_name", "gauge " + channel.gauge);
  }
}

template <typename Code>
void put_codes(hid_t raw, const std::string& name, const ChannelRecord& channel) {
  std::vector<Code> codes(channel.codes.size());
  std::transform(channel.codes.begin(), channel.codes.end(), codes.begin(),
                 [](std::int32_t code) { return static_cast<Code>(code); });
  const auto dataset = hdf5::put_array(raw, name, std::span<const Code>(codes));
  hdf5::put_fixed_attribute(dataset, "gauge", channel.gauge);
  hdf5::put_fixed_attribute(dataset, "unit", channel.unit);
  hdf5::put_attribute(dataset, "scale", channel.scale);
  hdf5::put_attribute(dataset, "offset", channel.offset);
  hdf5::put_attribute(dataset, "bits", channel.bits);
  hdf5::put_attribute(dataset, "code_min", channel.code_min);
  hdf5::put_attribute(dataset, "code_max", channel.code_max);
  hdf5::put_fixed_attribute(dataset, "sha256", sha256_hex(std::as_bytes(std::span(codes))));
}

void put_raw(hid_t entry, const Shot& shot, const std::vector<std::string>& names) {
  const auto group = hdf5::make_group(entry, layout::kRaw, "NXcollection");
  hdf5::put_fixed_attribute(group, layout::kChannels, names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (shot.channels[i].bits <= 16 && fits_16_bits(shot.channels[i])) {
      put_codes<std::int16_t>(group, names[i], shot.channels[i]);
    } else {
      put_codes<std::int32_t>(group, names[i], shot.channels[i]);
    }
  }
}

void put_trigger(hid_t group, const TriggerEvent& trigger) {
  hdf5::put_number(group, "trigger_tick", trigger.tick);
  hdf5::put_number(group, "trigger_fraction", trigger.fraction);
  hdf5::put_number(group, "trigger_sigma_samples", trigger.sigma_samples);
  hdf5::put_text(group, "trigger_kind",
                 layout::kTriggerKinds.at(static_cast<std::size_t>(trigger.kind)));
}

void put_gaps(hid_t group, const std::vector<Gap>& gaps) {
  std::vector<std::int64_t> rows;
  for (const Gap& gap : gaps) {
    rows.insert(rows.end(), {gap.first_tick, gap.samples, gap.known ? 1 : 0});
  }
  const auto table = hdf5::put_table(group, "gaps", rows, layout::kGapColumns);
  hdf5::put_attribute(table, "columns", std::vector<std::string>{"first_tick", "samples", "known"});
}

void put_meta(hid_t group, const std::map<std::string, std::string>& meta) {
  const auto facts = hdf5::make_group(group, "meta", "NXcollection");
  std::set<std::string> used;
  for (const auto& [key, value] : meta) {
    const std::string name = hdf5::link_name(key, used);
    const auto dataset = hdf5::put_text(facts, name, value);
    if (name != key) {
      hdf5::put_fixed_attribute(dataset, layout::kMetaKey, key);
    }
  }
}

void put_request(hid_t group, const ReductionRequest& request) {
  const auto asked = hdf5::make_group(group, layout::kReduction, "NXcollection");
  for (const auto& [name, word] : kRequestWords) {
    if (request.*word) {
      hdf5::put_text(asked, name, *(request.*word));
    }
  }
  for (const auto& [name, number] : kRequestNumbers) {
    if (request.*number) {
      hdf5::put_number(asked, name, *(request.*number));
    }
  }
  if (request.with_true) {
    hdf5::put_number(asked, kRequestTrue, std::int64_t{1});
  }
}

void put_shot(hid_t entry, const Shot& shot) {
  const auto group = hdf5::make_group(entry, layout::kShot, "NXcollection");
  hdf5::put_attribute(group, "format", layout::kFormat);
  hdf5::put_fixed_attribute(group, "sha256", sha256_hex(encode_metadata(shot)));
  hdf5::put_text(group, "id", shot.id);
  hdf5::put_text(group, "software_version", shot.software_version);
  hdf5::put_text(group, "bench_toml", shot.bench_toml);
  if (shot.bar_model) {
    hdf5::put_text(group, layout::kBarModel, format_material(*shot.bar_model));
  }
  if (shot.reduction.asks()) {
    put_request(group, shot.reduction);
  }
  hdf5::put_number(group, "rate_numerator", shot.rate.numerator);
  hdf5::put_number(group, "rate_denominator", shot.rate.denominator);
  hdf5::put_number(group, "first_tick", shot.first_tick);
  hdf5::put_number(group, "utc_ns", shot.utc_ns);
  hdf5::put_number(group, "monotonic_ns", shot.monotonic_ns);
  if (shot.trigger) {
    put_trigger(group, *shot.trigger);
  }
  put_gaps(group, shot.gaps);
  put_meta(group, shot.meta);
}

void put_entry(hid_t file, const Shot& shot) {
  const auto entry = hdf5::make_group(file, layout::kEntry, "NXentry");
  hdf5::put_attribute(entry, "default", layout::kGauges);
  hdf5::put_text(entry, "title", shot.id);
  hdf5::put_text(entry, "start_time", iso8601_utc(shot.utc_ns));
  const auto names = link_names(shot.channels);
  put_gauges(entry, shot, names);
  put_raw(entry, shot, names);
  put_shot(entry, shot);
}

std::vector<std::byte> hdf5_bytes(const Shot& shot) {
  const hdf5::Session session;
  std::vector<std::byte> bytes;
  auto file = hdf5::create_file(bytes);
  hdf5::put_attribute(file, "NX_class", "NXroot");
  hdf5::put_attribute(file, "default", layout::kEntry);
  hdf5::put_attribute(file, "creator", "Kolsky " + shot.software_version);
  put_entry(file, shot);
  hdf5::close(std::move(file));
  return bytes;
}

}  // namespace

void write_capture(const Shot& shot, const std::filesystem::path& path) {
  try {
    check_storable(shot);
  } catch (const InputError& error) {
    throw error.inside(path.string());
  }
  NewFile file(path);
  std::vector<std::byte> bytes;
  try {
    bytes = hdf5_bytes(shot);
  } catch (const hdf5::Failure& failure) {
    throw InputError(path.string() + ": " + failure.object(), failure.problem(),
                     "check the length of the shot's texts");
  }
  file.write(bytes);
  file.write(seal_of(bytes));
  file.publish(S_IRUSR | S_IRGRP | S_IROTH);
}

}  // namespace kolsky
