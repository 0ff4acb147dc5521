#include "drivers/iio/device_selection.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include "drivers/iio/iio_attributes.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

bool is_input_scan(const iio_channel* channel) {
  return iio_channel_is_scan_element(channel) && !iio_channel_is_output(channel);
}

bool is_voltage_input(const iio_channel* channel) {
  return is_input_scan(channel) && iio_channel_get_type(channel) == IIO_VOLTAGE;
}

template <typename Predicate>
std::vector<iio_channel*> channels_of(const iio_device* device, Predicate wanted) {
  std::vector<iio_channel*> found;
  for (unsigned int i = 0; i < iio_device_get_channels_count(device); ++i) {
    iio_channel* channel = iio_device_get_channel(device, i);
    if (wanted(channel)) {
      found.push_back(channel);
    }
  }
  return found;
}

std::vector<iio_device*> devices_of(const iio_context* context) {
  std::vector<iio_device*> found;
  for (unsigned int i = 0; i < iio_context_get_devices_count(context); ++i) {
    found.push_back(iio_context_get_device(context, i));
  }
  return found;
}

bool same(const char* text, const std::string& name) {
  return text != nullptr && name == text;
}

/// Newer kernels show a `label` attribute, which libiio hands on as an attribute like any other.
bool labelled(const AttributeOwner& owner, const std::string& name) {
  const std::optional<std::string> label = read_text(owner, "label");
  return label && *label == name;
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text.empty() ? "none" : text;
}

std::string channel_list(const iio_device* device) {
  std::vector<std::string> ids;
  for (const iio_channel* channel : channels_of(device, is_voltage_input)) {
    ids.emplace_back(iio_channel_get_id(channel));
  }
  return join(ids);
}

std::string device_list(const iio_context* context) {
  std::vector<std::string> titles;
  for (const iio_device* device : devices_of(context)) {
    titles.push_back(device_title(device));
  }
  return join(titles);
}

iio_device* find_device(const iio_context* context, const std::string& name) {
  for (iio_device* device : devices_of(context)) {
    if (same(iio_device_get_id(device), name) || same(iio_device_get_name(device), name) ||
        same(iio_device_get_label(device), name)) {
      return device;
    }
  }
  return nullptr;
}

iio_channel* find_channel(const iio_device* device, const std::string& name) {
  const auto inputs =
      channels_of(device, [](const iio_channel* c) { return !iio_channel_is_output(c); });
  const auto named = [&](const iio_channel* channel) {
    return same(iio_channel_get_id(channel), name) || same(iio_channel_get_name(channel), name);
  };
  const auto with_label = [&](const iio_channel* channel) {
    return labelled({device, channel}, name);
  };
  auto found = std::find_if(inputs.begin(), inputs.end(), named);
  if (found == inputs.end()) {
    found = std::find_if(inputs.begin(), inputs.end(), with_label);
  }
  return found == inputs.end() ? nullptr : *found;
}

std::vector<iio_channel*> first_voltage_channels(const iio_device* device, std::size_t count) {
  std::vector<iio_channel*> found = channels_of(device, is_voltage_input);
  if (found.empty() || found.size() < count) {
    throw InputError(device_title(device),
                     "has " + std::to_string(found.size()) + " voltage inputs that stream, " +
                         std::to_string(std::max<std::size_t>(count, 1)) + " are needed",
                     "take fewer gauges or another device");
  }
  if (count != 0) {
    found.resize(count);
  }
  return found;
}

std::vector<iio_channel*> named_channels(const iio_device* device,
                                         const std::vector<std::string>& names) {
  std::vector<iio_channel*> found;
  for (const std::string& name : names) {
    iio_channel* channel = find_channel(device, name);
    const std::string place = device_title(device) + ": channel " + name;
    if (channel == nullptr) {
      throw InputError(place, "is not there", "choose from " + channel_list(device));
    }
    if (!is_input_scan(channel)) {
      throw InputError(place, "cannot be streamed", "choose from " + channel_list(device));
    }
    if (std::find(found.begin(), found.end(), channel) != found.end()) {
      throw InputError(place, "is asked for twice", "give each gauge a channel of its own");
    }
    found.push_back(channel);
  }
  return found;
}

double volts_per_code(const AttributeOwner& owner) {
  if (iio_channel_get_type(owner.channel) != IIO_VOLTAGE) {
    throw InputError(owner.id(), "measures no voltage", "choose a voltage channel");
  }
  const std::optional<double> scale_mV = read_number(owner, "scale");
  if (!scale_mV) {
    throw InputError(owner.id(), "has no scale attribute, so its codes cannot become volts",
                     "use a device that states its scale");
  }
  return *scale_mV / 1000.0;
}

double strain_per_code(const AttributeOwner& owner) {
  const std::optional<double> scale = read_number(owner, "strain_scale");
  if (!scale) {
    throw InputError(owner.id(),
                     "gives volts only (no strain_scale attribute), the gauge's unit is strain",
                     "set the gauge's unit to \"V\" and state its bridge in the bench file");
  }
  return *scale;
}

ChannelInfo describe(const AttributeOwner& owner, const ScanFormat& format,
                     const std::string& unit) {
  ChannelInfo info;
  info.name = owner.id();
  info.unit = unit;
  info.scale = unit == "strain" ? strain_per_code(owner) : volts_per_code(owner);
  if (info.scale == 0.0) {
    throw InputError(owner.id(), "has a scale of 0", "mend the device's driver");
  }
  info.offset = read_number(owner, "offset").value_or(0.0) + static_cast<double>(format.bias());
  info.bits = static_cast<int>(format.bits);
  info.code_min = format.code_min();
  info.code_max = format.code_max();
  return info;
}

std::string unit_of(const DigitiserOptions& options, std::size_t i) {
  std::string unit = i < options.units.size() ? options.units[i] : "V";
  if (unit != "V" && unit != "strain") {
    throw InputError("unit of channel " + std::to_string(i + 1), "\"" + unit + "\" is not known",
                     "give \"V\" or \"strain\"");
  }
  return unit;
}

}  // namespace

iio_device* choose_device(const iio_context* context, const DigitiserOptions& options) {
  if (!options.device.empty()) {
    iio_device* device = find_device(context, options.device);
    if (device == nullptr) {
      throw InputError("device " + options.device, "is not there",
                       "choose from " + device_list(context));
    }
    return device;
  }
  const std::size_t needed =
      std::max<std::size_t>({options.channels.size(), options.channel_count, 1});
  for (iio_device* device : devices_of(context)) {
    if (channels_of(device, is_voltage_input).size() >= needed) {
      return device;
    }
  }
  throw InputError("devices " + device_list(context),
                   "none has " + std::to_string(needed) + " voltage inputs that stream",
                   "check the digitiser with iio_info -u");
}

std::vector<ScanChannel> choose_channels(const iio_device* device,
                                         const DigitiserOptions& options) {
  const std::vector<iio_channel*> channels =
      options.channels.empty() ? first_voltage_channels(device, options.channel_count)
                               : named_channels(device, options.channels);
  std::vector<ScanChannel> chosen;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const AttributeOwner owner{device, channels[i]};
    try {
      const ScanFormat format = scan_format(channels[i]);
      chosen.push_back({channels[i], format, describe(owner, format, unit_of(options, i))});
    } catch (const InputError& error) {
      throw error.inside(device_title(device));
    }
  }
  return chosen;
}

ScanFormat scan_format(const iio_channel* channel) {
  const iio_data_format* stated = iio_channel_get_data_format(channel);
  ScanFormat format;
  format.storage_bytes = stated->length / 8;
  format.bits = stated->bits;
  format.shift = stated->shift;
  format.is_signed = stated->is_signed;
  format.big_endian = stated->is_be;
  const std::string id = iio_channel_get_id(channel);
  if (stated->repeat > 1) {
    throw InputError(id, "has " + std::to_string(stated->repeat) + " values in each sample",
                     "choose a channel that has one");
  }
  const bool counts = iio_channel_get_type(channel) == IIO_COUNT;
  if (stated->length % 8 != 0 || !format.valid() || (!counts && format.bits > 32)) {
    throw InputError(id,
                     "streams " + std::to_string(stated->bits) + " bits in " +
                         std::to_string(stated->length) + " shifted by " +
                         std::to_string(stated->shift) + ", which cannot be read",
                     "choose a channel of at most 32 bits in 8, 16, 32 or 64");
  }
  return format;
}

iio_channel* find_counter(const iio_device* device) {
  // By id: other channels of type "count" count other things, an encoder's steps for one.
  iio_channel* channel = iio_device_find_channel(device, "count0", false);
  const bool counts =
      channel != nullptr && is_input_scan(channel) && iio_channel_get_type(channel) == IIO_COUNT;
  return counts ? channel : nullptr;
}

std::string device_title(const iio_device* device) {
  const char* name = iio_device_get_name(device);
  const std::string id = iio_device_get_id(device);
  return name == nullptr ? id : std::string(name) + " (" + id + ")";
}

}  // namespace kolsky
