#include "drivers/iio/iio_attributes.hpp"

#include <charconv>
#include <cmath>
#include <vector>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr const char* kWhiteSpace = " \t\r\n";

std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of(kWhiteSpace) + 1);
  text.erase(0, text.find_first_not_of(kWhiteSpace));
  return text;
}

}  // namespace

bool AttributeOwner::has(const char* name) const {
  return channel != nullptr ? iio_channel_find_attr(channel, name) != nullptr
                            : iio_device_find_attr(device, name) != nullptr;
}

std::string AttributeOwner::id() const {
  return channel != nullptr ? iio_channel_get_id(channel) : iio_device_get_id(device);
}

std::optional<std::string> read_text(const AttributeOwner& owner, const char* name) {
  if (!owner.has(name)) {
    return std::nullopt;
  }
  std::vector<char> text(4096);  // a page: the most that an IIO attribute has
  const ssize_t length =
      owner.channel != nullptr
          ? iio_channel_attr_read(owner.channel, name, text.data(), text.size() - 1)
          : iio_device_attr_read(owner.device, name, text.data(), text.size() - 1);
  if (length < 0) {
    return std::nullopt;
  }
  return trimmed(std::string(text.data()));
}

std::optional<double> read_number(const AttributeOwner& owner, const char* name) {
  const std::optional<std::string> text = read_text(owner, name);
  if (!text) {
    return std::nullopt;
  }
  double value = 0.0;
  const char* end = text->data() + text->size();
  const auto parsed = std::from_chars(text->data(), end, value);
  if (parsed.ec != std::errc{} || parsed.ptr != end || !std::isfinite(value)) {
    throw InputError(owner.id() + " " + name, "\"" + *text + "\" is no number",
                     "mend the device's driver or choose another channel");
  }
  return value;
}

long write_text(const AttributeOwner& owner, const char* name, const std::string& text) {
  const ssize_t written = owner.channel != nullptr
                              ? iio_channel_attr_write(owner.channel, name, text.c_str())
                              : iio_device_attr_write(owner.device, name, text.c_str());
  return written < 0 ? written : 0;
}

std::string plain_number(double value) {
  char text[400];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed);
  return {text, end.ptr};
}

}  // namespace kolsky
