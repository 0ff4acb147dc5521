#include "drivers/files/captures/shot_codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/files/captures/byte_stream.hpp"
#include "drivers/files/captures/gauge_values.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::uint32_t kVersion = 1;
/// With what an identification files of the bar model beside its numbers. Others are still written
/// as they were: their checksums stand in stored captures.
constexpr std::uint32_t kVersionIdentified = 2;
/// With how the shot is to be reduced, where that is not as usual.
constexpr std::uint32_t kVersionReduction = 3;
/// With a bar model of another family of solids than three elements, and a reduction that may be as
/// usual.
constexpr std::uint32_t kVersionSolid = 4;
constexpr std::size_t kGapBytes = 17;
constexpr std::size_t kLeastMetaBytes = 8;
constexpr std::size_t kLeastChannelBytes = 45;
constexpr std::size_t kLongestId = 200;
/// Ticks and times stay this far from overflow: 146 years in nanoseconds.
constexpr std::int64_t kLargestTick = std::int64_t{1} << 62;

void require(bool good, const std::string& place, const std::string& what,
             const std::string& mend) {
  if (!good) {
    throw InputError(place, what, mend);
  }
}

void require_text(const std::string& text, const std::string& place) {
  require(text.find('\0') == std::string::npos, place, "has a NUL character in it", "leave it out");
  require(text.size() <= std::numeric_limits<std::uint32_t>::max(), place, "is 4 GiB or longer",
          "shorten it");
}

void require_tick(Tick tick, const std::string& place) {
  require(tick > -kLargestTick && tick < kLargestTick, place, "is beyond 2^62",
          "count ticks from the start of the stream");
}

void check_id(const std::string& id) {
  const bool printable = std::none_of(id.begin(), id.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '/';
  });
  require(!id.empty() && id.size() <= kLongestId && id.front() != '.' && printable, "id",
          "cannot name a file",
          "use 1 to 200 characters, no slash, no control character, no dot in front");
}

void check_channel(const ChannelRecord& channel, std::size_t samples, const std::string& place) {
  require_text(channel.gauge, place + ".gauge");
  require_text(channel.unit, place + ".unit");
  require(std::isfinite(channel.scale) && channel.scale != 0.0, place + ".scale",
          "is not a finite number other than 0", "give the unit per code");
  require(std::isfinite(channel.offset), place + ".offset", "is not finite", "give it in codes");
  require(channel.bits >= 1 && channel.bits <= 32, place + ".bits",
          "is " + std::to_string(channel.bits), "give the converter's bits, 1 to 32");
  require(channel.code_min < channel.code_max, place + ".code_min", "is not below code_max",
          "give the converter's lowest and highest code");
  require(channel.codes.size() == samples, place + ".codes",
          std::to_string(channel.codes.size()) + " samples beside " + std::to_string(samples) +
              " in the first channel",
          "give all channels the same window");
}

void check_model(const Material& model) {
  require_text(model.source, "bar_model.source");
  try {
    check(model);
  } catch (const InputError& error) {
    throw error.inside("bar_model");
  }
}

void check_request(const ReductionRequest& request) {
  for (const auto& [key, word] : kRequestWords) {
    require_text((request.*word).value_or(""), std::string("reduction.") + key);
  }
  for (const auto& [key, number] : kRequestNumbers) {
    require(std::isfinite((request.*number).value_or(0.0)), std::string("reduction.") + key,
            "is not finite", "give what `kolsky reduce` takes");
  }
}

void check_trigger(const TriggerEvent& trigger) {
  require_tick(trigger.tick, "trigger.tick");
  require(trigger.fraction >= 0.0 && trigger.fraction < 1.0, "trigger.fraction", "is not in [0, 1)",
          "put whole samples into the tick");
  require(std::isfinite(trigger.sigma_samples) && trigger.sigma_samples >= 0.0,
          "trigger.sigma_samples", "is not a finite number from 0 up", "give one sigma in samples");
}

/// 2 where every code fits into 16 bits, else 4.
std::uint8_t code_bytes(const ChannelRecord& channel) {
  return fits_16_bits(channel) ? 2 : 4;
}

std::uint32_t version_of(const Shot& shot) {
  if (shot.bar_model && shot.bar_model->solid != SolidKind::three_element) {
    return kVersionSolid;
  }
  if (shot.reduction.asks()) {
    return kVersionReduction;
  }
  return shot.bar_model && (shot.bar_model->covariance || shot.bar_model->identified)
             ? kVersionIdentified
             : kVersion;
}

void put_optional(ByteWriter& writer, const std::optional<double>& number) {
  writer.put(static_cast<std::uint8_t>(number ? 1 : 0));
  if (number) {
    writer.put(*number);
  }
}

std::optional<double> get_optional(ByteReader& reader) {
  return reader.get_flag() ? std::optional(reader.get<double>()) : std::nullopt;
}

void put_identification(ByteWriter& writer, const Material& material) {
  writer.put(static_cast<std::uint8_t>(material.covariance ? 1 : 0));
  if (material.covariance) {
    for (const double number : *material.covariance) {
      writer.put(number);
    }
  }
  writer.put(static_cast<std::uint8_t>(material.identified ? 1 : 0));
  if (material.identified) {
    put_optional(writer, material.identified->band_limit_Hz);
    put_optional(writer, material.identified->temperature_K);
  }
}

void get_identification(ByteReader& reader, Material& material) {
  if (reader.get_flag()) {
    const std::size_t count = material.parameters.size();
    for (double& number : material.covariance.emplace(count * count)) {
      number = reader.get<double>();
    }
  }
  if (reader.get_flag()) {
    // Not emplace(): what it requires is asked for before a nested class has its defaults.
    material.identified = Material::Identified{};
    Material::Identified& identified = *material.identified;
    identified.band_limit_Hz = get_optional(reader);
    identified.temperature_K = get_optional(reader);
  }
}

void put_word(ByteWriter& writer, const std::optional<std::string>& word) {
  writer.put(static_cast<std::uint8_t>(word ? 1 : 0));
  if (word) {
    writer.put_text(*word);
  }
}

std::optional<std::string> get_word(ByteReader& reader) {
  return reader.get_flag() ? std::optional(reader.get_text()) : std::nullopt;
}

void put_request(ByteWriter& writer, const ReductionRequest& request) {
  for (const auto& [key, word] : kRequestWords) {
    put_word(writer, request.*word);
  }
  for (const auto& [key, number] : kRequestNumbers) {
    put_optional(writer, request.*number);
  }
  writer.put(static_cast<std::uint8_t>(request.with_true ? 1 : 0));
}

ReductionRequest get_request(ByteReader& reader) {
  ReductionRequest request;
  for (const auto& [key, word] : kRequestWords) {
    request.*word = get_word(reader);
  }
  for (const auto& [key, number] : kRequestNumbers) {
    request.*number = get_optional(reader);
  }
  request.with_true = reader.get_flag();
  if (!request.asks()) {
    reader.refuse("a reduction that is as usual");
  }
  return request;
}

void put(ByteWriter& writer, const Measured& number) {
  writer.put(number.value);
  writer.put(number.sd);
}

Measured get_measured(ByteReader& reader) {
  const auto value = reader.get<double>();
  return {value, reader.get<double>()};
}

SolidKind get_solid(ByteReader& reader) {
  try {
    return solid_kind(reader.get_text());
  } catch (const InputError& error) {
    reader.refuse(error.problem());
  }
}

void put_material(ByteWriter& writer, const std::optional<Material>& material,
                  std::uint32_t version) {
  writer.put(static_cast<std::uint8_t>(material ? 1 : 0));
  if (!material) {
    return;
  }
  put(writer, material->density_kg_m3);
  put(writer, material->poisson_ratio);
  if (version == kVersionSolid) {
    writer.put_text(name_of(material->solid));
  }
  for (const Measured& number : material->parameters) {
    put(writer, number);
  }
  writer.put_text(material->source);
}

std::optional<Material> get_material(ByteReader& reader, std::uint32_t version) {
  if (!reader.get_flag()) {
    return std::nullopt;
  }
  Material material;
  material.density_kg_m3 = get_measured(reader);
  material.poisson_ratio = get_measured(reader);
  if (version == kVersionSolid) {
    material.solid = get_solid(reader);
    material.parameters.resize(parameters_of(material.solid).size());
  }
  for (Measured& number : material.parameters) {
    number = get_measured(reader);
  }
  material.source = reader.get_text();
  return material;
}

void put_trigger(ByteWriter& writer, const std::optional<TriggerEvent>& trigger) {
  writer.put(static_cast<std::uint8_t>(trigger ? 1 : 0));
  if (!trigger) {
    return;
  }
  writer.put(trigger->tick);
  writer.put(trigger->fraction);
  writer.put(trigger->sigma_samples);
  writer.put(static_cast<std::uint8_t>(trigger->kind));
}

std::optional<TriggerEvent> get_trigger(ByteReader& reader) {
  if (!reader.get_flag()) {
    return std::nullopt;
  }
  TriggerEvent trigger;
  trigger.tick = reader.get<Tick>();
  trigger.fraction = reader.get<double>();
  trigger.sigma_samples = reader.get<double>();
  const auto kind = reader.get<std::uint8_t>();
  if (kind > static_cast<std::uint8_t>(TriggerKind::marked)) {
    reader.refuse("there is no trigger kind " + std::to_string(kind));
  }
  trigger.kind = static_cast<TriggerKind>(kind);
  return trigger;
}

void put_metadata(ByteWriter& writer, const Shot& shot) {
  const std::uint32_t version = version_of(shot);
  writer.put(version);
  writer.put_text(shot.id);
  writer.put_text(shot.bench_toml);
  put_material(writer, shot.bar_model, version);
  if (shot.bar_model && version != kVersion) {
    put_identification(writer, *shot.bar_model);
  }
  if (version == kVersionSolid) {
    writer.put(static_cast<std::uint8_t>(shot.reduction.asks() ? 1 : 0));
  }
  if (shot.reduction.asks()) {
    put_request(writer, shot.reduction);
  }
  writer.put(shot.rate.numerator);
  writer.put(shot.rate.denominator);
  writer.put(shot.first_tick);
  put_trigger(writer, shot.trigger);
  writer.put(static_cast<std::uint32_t>(shot.gaps.size()));
  for (const Gap& gap : shot.gaps) {
    writer.put(gap.first_tick);
    writer.put(gap.samples);
    writer.put(static_cast<std::uint8_t>(gap.known ? 1 : 0));
  }
  writer.put(static_cast<std::uint32_t>(shot.meta.size()));
  for (const auto& [key, value] : shot.meta) {
    writer.put_text(key);
    writer.put_text(value);
  }
  writer.put(shot.utc_ns);
  writer.put(shot.monotonic_ns);
  writer.put_text(shot.software_version);
  writer.put(static_cast<std::uint32_t>(shot.channels.size()));
  for (const ChannelRecord& channel : shot.channels) {
    writer.put_text(channel.gauge);
    writer.put_text(channel.unit);
    writer.put(channel.scale);
    writer.put(channel.offset);
    writer.put(static_cast<std::int32_t>(channel.bits));
    writer.put(channel.code_min);
    writer.put(channel.code_max);
    writer.put(static_cast<std::uint64_t>(channel.codes.size()));
    writer.put(code_bytes(channel));
  }
}

struct CodeExtent {
  std::uint64_t samples = 0;
  std::uint8_t bytes_each = 2;
};

CodeExtent get_channel(ByteReader& reader, ChannelRecord& channel) {
  channel.gauge = reader.get_text();
  channel.unit = reader.get_text();
  channel.scale = reader.get<double>();
  channel.offset = reader.get<double>();
  channel.bits = reader.get<std::int32_t>();
  channel.code_min = reader.get<std::int32_t>();
  channel.code_max = reader.get<std::int32_t>();
  const CodeExtent extent{reader.get<std::uint64_t>(), reader.get<std::uint8_t>()};
  if (extent.bytes_each != 2 && extent.bytes_each != 4) {
    reader.refuse("codes of " + std::to_string(extent.bytes_each) + " bytes");
  }
  return extent;
}

void get_lists(ByteReader& reader, Shot& shot) {
  shot.gaps.resize(reader.get_count(kGapBytes));
  for (Gap& gap : shot.gaps) {
    gap.first_tick = reader.get<Tick>();
    gap.samples = reader.get<std::int64_t>();
    gap.known = reader.get_flag();
  }
  const auto facts = reader.get_count(kLeastMetaBytes);
  for (std::uint32_t i = 0; i < facts; ++i) {
    std::string key = reader.get_text();
    if (!shot.meta.empty() && key <= shot.meta.rbegin()->first) {
      reader.refuse("meta keys are out of order or double");
    }
    shot.meta.emplace_hint(shot.meta.end(), std::move(key), reader.get_text());
  }
}

template <typename Code>
void put_codes(ByteWriter& writer, const ChannelRecord& channel) {
  std::vector<Code> narrow(channel.codes.size());
  std::transform(channel.codes.begin(), channel.codes.end(), narrow.begin(),
                 [](std::int32_t code) { return static_cast<Code>(code); });
  writer.put_bytes(std::as_bytes(std::span(narrow)));
}

template <typename Code>
void get_codes(ByteReader& reader, std::uint64_t samples, std::vector<std::int32_t>& codes) {
  if (samples > std::numeric_limits<std::uint64_t>::max() / sizeof(Code)) {
    reader.refuse("more codes than a file can hold");
  }
  const auto bytes = reader.get_bytes(samples * sizeof(Code));
  codes.resize(static_cast<std::size_t>(samples));
  for (std::size_t i = 0; i < codes.size(); ++i) {
    Code code{};
    std::memcpy(&code, bytes.data() + i * sizeof(Code), sizeof(Code));
    codes[i] = code;
  }
}

}  // namespace

void check_storable(const Shot& shot) {
  check_id(shot.id);
  require_text(shot.bench_toml, "bench_toml");
  require_text(shot.software_version, "software_version");
  if (shot.bar_model) {
    check_model(*shot.bar_model);
  }
  check_request(shot.reduction);
  require(shot.rate.numerator > 0 && shot.rate.denominator > 0, "rate", "is not positive",
          "give samples per seconds, as 1000000 / 1");
  require_tick(shot.first_tick, "first_tick");
  if (shot.trigger) {
    check_trigger(*shot.trigger);
  }
  for (const Gap& gap : shot.gaps) {
    require_tick(gap.first_tick, "gaps");
    require(gap.samples >= 0 && gap.samples < kLargestTick, "gaps", "a length is negative or huge",
            "give the samples missing, 0 where unknown");
  }
  for (const auto& [key, value] : shot.meta) {
    require_text(key, "meta");
    require_text(value, "meta." + key);
  }
  require(shot.samples() > 0, "channels", "hold no samples", "store a window with samples");
  for (std::size_t i = 0; i < shot.channels.size(); ++i) {
    check_channel(shot.channels[i], shot.samples(), "channels[" + std::to_string(i) + "]");
  }
}

std::vector<std::byte> encode_metadata(const Shot& shot) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  put_metadata(writer, shot);
  return bytes;
}

void encode_shot(const Shot& shot, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  put_metadata(writer, shot);
  for (const ChannelRecord& channel : shot.channels) {
    if (code_bytes(channel) == 2) {
      put_codes<std::int16_t>(writer, channel);
    } else {
      put_codes<std::int32_t>(writer, channel);
    }
  }
}

Shot decode_shot(std::span<const std::byte> bytes, const std::string& place) {
  ByteReader reader(bytes, place);
  const auto version = reader.get<std::uint32_t>();
  if (version < kVersion || version > kVersionSolid) {
    reader.refuse("shot of format " + std::to_string(version) + ", this program reads " +
                  std::to_string(kVersion) + " to " + std::to_string(kVersionSolid));
  }
  Shot shot;
  shot.id = reader.get_text();
  shot.bench_toml = reader.get_text();
  shot.bar_model = get_material(reader, version);
  if ((version == kVersionIdentified || version == kVersionSolid) && !shot.bar_model) {
    reader.refuse("an identification of no bar model");
  }
  if (version != kVersion && shot.bar_model) {
    get_identification(reader, *shot.bar_model);
  }
  if (version == kVersionReduction || (version == kVersionSolid && reader.get_flag())) {
    shot.reduction = get_request(reader);
  }
  shot.rate.numerator = reader.get<std::int64_t>();
  shot.rate.denominator = reader.get<std::int64_t>();
  shot.first_tick = reader.get<Tick>();
  shot.trigger = get_trigger(reader);
  get_lists(reader, shot);
  shot.utc_ns = reader.get<std::int64_t>();
  shot.monotonic_ns = reader.get<std::int64_t>();
  shot.software_version = reader.get_text();
  shot.channels.resize(reader.get_count(kLeastChannelBytes));
  std::vector<CodeExtent> extents;
  for (ChannelRecord& channel : shot.channels) {
    extents.push_back(get_channel(reader, channel));
  }
  for (std::size_t i = 0; i < extents.size(); ++i) {
    auto& codes = shot.channels[i].codes;
    if (extents[i].bytes_each == 2) {
      get_codes<std::int16_t>(reader, extents[i].samples, codes);
    } else {
      get_codes<std::int32_t>(reader, extents[i].samples, codes);
    }
  }
  reader.expect_end();
  try {
    check_storable(shot);
  } catch (const InputError& error) {
    throw error.inside(place);
  }
  return shot;
}

void attach_bench(Shot& shot, const std::string& place) {
  shot.bench = parse_bench(shot.bench_toml, place);
  const std::vector<BenchChannel> wanted = shot.bench.channels();
  const bool gauges_only = shot.bench.photo_sensors.empty();
  require(wanted.size() == shot.channels.size(), place + ": gauges",
          std::to_string(wanted.size()) + (gauges_only ? " gauges" : " gauges and photo-sensors") +
              " for " + std::to_string(shot.channels.size()) + " stored channels",
          gauges_only ? "store one channel per gauge, in the bench's order"
                      : "store one channel per gauge, then one per photo-sensor");
  for (std::size_t i = 0; i < shot.channels.size(); ++i) {
    require(wanted[i].name == shot.channels[i].gauge,
            place + ": gauges[" + std::to_string(i) + "].name",
            "\"" + wanted[i].name + "\" where the channel is of \"" + shot.channels[i].gauge + "\"",
            "store one channel per gauge, in the bench's order");
  }
}

}  // namespace kolsky
