#include <algorithm>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/capture_layout.hpp"
#include "drivers/files/captures/capture_seal.hpp"
#include "drivers/files/captures/hdf5_reading.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/sha256.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

namespace layout = capture_layout;

template <typename Code>
void read_codes(const hdf5::DatasetReader& dataset, hid_t type, std::vector<std::int32_t>& codes) {
  const auto stored = dataset.values<Code>(type, 1);
  if (sha256_hex(std::as_bytes(std::span(stored))) != dataset.text_attribute("sha256")) {
    throw hdf5::Failure(dataset.place(), "the codes differ from their SHA-256");
  }
  codes.assign(stored.begin(), stored.end());
}

ChannelRecord read_channel(const hdf5::DatasetReader& dataset) {
  ChannelRecord channel;
  channel.gauge = dataset.text_attribute("gauge");
  channel.unit = dataset.text_attribute("unit");
  channel.scale = dataset.number_attribute("scale");
  channel.offset = dataset.number_attribute("offset");
  channel.bits = dataset.integer_attribute("bits");
  channel.code_min = dataset.integer_attribute("code_min");
  channel.code_max = dataset.integer_attribute("code_max");
  if (dataset.stores(H5T_STD_I16LE)) {
    read_codes<std::int16_t>(dataset, H5T_STD_I16LE, channel.codes);
  } else {
    read_codes<std::int32_t>(dataset, H5T_STD_I32LE, channel.codes);
  }
  return channel;
}

TriggerEvent read_trigger(const hdf5::GroupReader& group) {
  TriggerEvent trigger;
  trigger.tick = group.integer("trigger_tick");
  trigger.fraction = group.number("trigger_fraction");
  trigger.sigma_samples = group.number("trigger_sigma_samples");
  const auto kinds = std::span(layout::kTriggerKinds);
  const auto* kind =
      std::find(kinds.data(), kinds.data() + kinds.size(), group.text("trigger_kind"));
  if (kind == kinds.data() + kinds.size()) {
    throw hdf5::Failure("/entry/shot/trigger_kind", "is none of incident, forced, marked");
  }
  trigger.kind = static_cast<TriggerKind>(kind - kinds.data());
  return trigger;
}

std::vector<Gap> read_gaps(const hdf5::GroupReader& group) {
  const auto rows = group.table("gaps", layout::kGapColumns);
  std::vector<Gap> gaps;
  for (std::size_t i = 0; i < rows.size(); i += layout::kGapColumns) {
    gaps.push_back({rows[i], rows[i + 1], rows[i + 2] != 0});
  }
  return gaps;
}

std::map<std::string, std::string> read_meta(const hdf5::GroupReader& group) {
  std::map<std::string, std::string> meta;
  for (const std::string& name : group.names()) {
    const auto dataset = group.dataset(name);
    const std::string key =
        dataset.has_attribute(layout::kMetaKey) ? dataset.text_attribute(layout::kMetaKey) : name;
    if (!meta.emplace(key, dataset.text()).second) {
      throw hdf5::Failure(dataset.place(), "repeats a key");
    }
  }
  return meta;
}

ReductionRequest read_request(const hdf5::GroupReader& group) {
  ReductionRequest request;
  for (const auto& [name, word] : kRequestWords) {
    if (group.has(name)) {
      request.*word = group.text(name);
    }
  }
  for (const auto& [name, number] : kRequestNumbers) {
    if (group.has(name)) {
      request.*number = group.number(name);
    }
  }
  request.with_true = group.has(kRequestTrue) && group.integer(kRequestTrue) != 0;
  return request;
}

void read_shot_group(const hdf5::GroupReader& group, const std::string& file, Shot& shot) {
  if (const auto format = group.integer_attribute("format"); format != layout::kFormat) {
    throw hdf5::Failure(
        "/entry/shot/@format",
        "is " + std::to_string(format) + ", this program reads " + std::to_string(layout::kFormat));
  }
  shot.id = group.text("id");
  shot.software_version = group.text("software_version");
  shot.bench_toml = group.text("bench_toml");
  if (group.has(layout::kBarModel)) {
    shot.bar_model =
        parse_material(group.text(layout::kBarModel), file + ": /entry/shot/" + layout::kBarModel);
  }
  if (group.has(layout::kReduction)) {
    shot.reduction = read_request(group.group(layout::kReduction));
  }
  shot.rate = {group.integer("rate_numerator"), group.integer("rate_denominator")};
  shot.first_tick = group.integer("first_tick");
  shot.utc_ns = group.integer("utc_ns");
  shot.monotonic_ns = group.integer("monotonic_ns");
  if (group.has("trigger_tick")) {
    shot.trigger = read_trigger(group);
  }
  shot.gaps = read_gaps(group);
  shot.meta = read_meta(group.group("meta"));
}

Shot read_entry(const std::filesystem::path& path, std::uint64_t bytes) {
  const hdf5::Session session;
  const auto file = hdf5::open_file(path);
  const auto entry = hdf5::GroupReader(file, bytes).group(layout::kEntry);
  Shot shot;
  const auto group = entry.group(layout::kShot);
  read_shot_group(group, path.string(), shot);
  const auto raw = entry.group(layout::kRaw);
  for (const std::string& name : raw.texts_attribute(layout::kChannels)) {
    shot.channels.push_back(read_channel(raw.dataset(name)));
  }
  if (sha256_hex(encode_metadata(shot)) != group.text_attribute("sha256")) {
    throw hdf5::Failure("/entry/shot", "differs from its SHA-256");
  }
  return shot;
}

}  // namespace

Shot read_capture(const std::filesystem::path& path) {
  const std::uint64_t bytes = check_seal(path);
  try {
    Shot shot = read_entry(path, bytes);
    try {
      check_storable(shot);
    } catch (const InputError& error) {
      throw error.inside(path.string());
    }
    attach_bench(shot, path.string() + ": /entry/shot/bench_toml");
    return shot;
  } catch (const hdf5::Failure& failure) {
    throw InputError(path.string() + ": " + failure.object(), failure.problem(),
                     "take the file from a backup, or use the Kolsky that wrote it");
  }
}

std::vector<std::filesystem::path> captures_in(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) {
    if (!std::filesystem::exists(path, error)) {
      throw InputError(path.string(), "does not exist", "name a capture (.h5) or a folder of them");
    }
    return {path};
  }
  std::vector<std::filesystem::path> captures;
  const std::filesystem::directory_iterator items(path, error);
  if (error) {
    throw InputError(path.string(), "cannot be read (" + error.message() + ")",
                     "check the folder's permissions");
  }
  for (const auto& item : items) {
    const auto name = item.path().filename().string();
    if (item.path().extension() == ".h5" && name.front() != '.') {
      captures.push_back(item.path());
    }
  }
  if (captures.empty()) {
    throw InputError(path.string(), "holds no captures (*.h5)",
                     "name a capture or a folder of them");
  }
  std::sort(captures.begin(), captures.end());
  return captures;
}

}  // namespace kolsky
