#include "proto/waveform.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "processing/base/error.hpp"

namespace kolsky::wire {
namespace {

static_assert(std::endian::native == std::endian::little,
              "waveforms are little endian on the wire and packed by copying");
static_assert(std::numeric_limits<double>::is_iec559 && sizeof(double) == 8);

constexpr int kShortBits = 16;
constexpr std::size_t kMaxElements = std::size_t{1} << 26;

template <class Element>
std::vector<Element> elements_of(const v1::Waveform& waveform, const std::string& place) {
  const std::string& data = waveform.data();
  if (data.size() % sizeof(Element) != 0) {
    throw InputError(place + ".data",
                     std::to_string(data.size()) + " bytes are no whole number of elements of " +
                         std::to_string(sizeof(Element)) + " bytes",
                     "send every element whole");
  }
  const std::size_t count = data.size() / sizeof(Element);
  if (count > kMaxElements) {
    throw InputError(place + ".data",
                     std::to_string(count) + " elements are more than a window can have",
                     "send at most " + std::to_string(kMaxElements));
  }
  std::vector<Element> elements(count);
  if (count > 0) {
    std::memcpy(elements.data(), data.data(), data.size());
  }
  return elements;
}

[[noreturn]] void refuse_dtype(const v1::Waveform& waveform, const std::string& place,
                               const std::string& mend) {
  const std::string said = v1::Waveform::DType_IsValid(waveform.dtype())
                               ? v1::Waveform::DType_Name(waveform.dtype())
                               : "the unknown " + std::to_string(waveform.dtype());
  throw InputError(place + ".dtype", "it is " + said, mend);
}

std::vector<std::int32_t> codes_of(const v1::Waveform& waveform, const std::string& place) {
  if (waveform.dtype() == v1::Waveform::INT32) {
    return elements_of<std::int32_t>(waveform, place);
  }
  if (waveform.dtype() != v1::Waveform::INT16) {
    refuse_dtype(waveform, place, "raw codes are INT16 or INT32");
  }
  const std::vector<std::int16_t> shorts = elements_of<std::int16_t>(waveform, place);
  return {shorts.begin(), shorts.end()};
}

void check_conversion(const v1::Waveform& waveform, const std::string& place) {
  if (!std::isfinite(waveform.scale()) || waveform.scale() == 0.0) {
    throw InputError(place + ".scale", "it is " + std::to_string(waveform.scale()),
                     "give the unit per code, finite and not 0");
  }
  if (!std::isfinite(waveform.offset())) {
    throw InputError(place + ".offset", "it is " + std::to_string(waveform.offset()),
                     "give a finite number of codes");
  }
}

void check_converter(const v1::Waveform& waveform, const std::string& place) {
  if (!waveform.has_converter()) {
    throw InputError(place + ".converter", "it is missing", "raw codes need their bits and ends");
  }
  const v1::Converter& converter = waveform.converter();
  if (converter.bits() < 1 || converter.bits() > 32) {
    throw InputError(place + ".converter.bits", "it is " + std::to_string(converter.bits()),
                     "converters have 1 to 32 bits");
  }
  const bool is_short = converter.bits() <= kShortBits;
  if (is_short != (waveform.dtype() == v1::Waveform::INT16)) {
    refuse_dtype(waveform, place, "up to 16 bits are INT16, more are INT32");
  }
  if (converter.code_min() >= converter.code_max()) {
    throw InputError(place + ".converter.code_min",
                     std::to_string(converter.code_min()) + " is not below code_max " +
                         std::to_string(converter.code_max()),
                     "give the converter's lowest and highest code");
  }
}

template <class Element>
void pack_bytes(const std::vector<Element>& elements, std::string& data) {
  data.assign(reinterpret_cast<const char*>(elements.data()), elements.size() * sizeof(Element));
}

void pack_shorts(const ChannelRecord& channel, std::string& data) {
  data.resize(channel.codes.size() * sizeof(std::int16_t));
  char* out = data.data();
  // Folded into one test after the loop, so that the loop itself is vectorised.
  std::uint32_t beyond = 0;
  for (const std::int32_t code : channel.codes) {
    const auto narrow = static_cast<std::int16_t>(code);
    beyond |= static_cast<std::uint32_t>(code ^ narrow);
    std::memcpy(out, &narrow, sizeof narrow);
    out += sizeof narrow;
  }
  if (beyond != 0) {
    throw InputError("channel \"" + channel.gauge + "\"",
                     "codes go beyond the 16-bit integers that " + std::to_string(channel.bits) +
                         " bits are stored as",
                     "state the converter's true number of bits");
  }
}

}  // namespace

void pack_codes(const ChannelRecord& channel, v1::Waveform& waveform) {
  waveform.set_name(channel.gauge);
  waveform.set_unit(channel.unit);
  waveform.set_scale(channel.scale);
  waveform.set_offset(channel.offset);
  v1::Converter& converter = *waveform.mutable_converter();
  converter.set_bits(channel.bits);
  converter.set_code_min(channel.code_min);
  converter.set_code_max(channel.code_max);
  if (channel.bits <= kShortBits) {
    waveform.set_dtype(v1::Waveform::INT16);
    pack_shorts(channel, *waveform.mutable_data());
  } else {
    waveform.set_dtype(v1::Waveform::INT32);
    pack_bytes(channel.codes, *waveform.mutable_data());
  }
}

ChannelRecord unpack_codes(const v1::Waveform& waveform, const std::string& place) {
  ChannelRecord channel;
  channel.codes = codes_of(waveform, place);
  check_conversion(waveform, place);
  check_converter(waveform, place);
  channel.gauge = waveform.name();
  channel.unit = waveform.unit();
  channel.scale = waveform.scale();
  channel.offset = waveform.offset();
  channel.bits = waveform.converter().bits();
  channel.code_min = waveform.converter().code_min();
  channel.code_max = waveform.converter().code_max();
  return channel;
}

void pack_values(const std::string& name, const std::string& unit,
                 const std::vector<double>& values, v1::Waveform& waveform) {
  waveform.set_name(name);
  waveform.set_unit(unit);
  waveform.set_dtype(v1::Waveform::FLOAT64);
  waveform.set_scale(1.0);
  waveform.set_offset(0.0);
  pack_bytes(values, *waveform.mutable_data());
}

std::vector<double> unpack_values(const v1::Waveform& waveform, const std::string& place) {
  if (waveform.dtype() != v1::Waveform::FLOAT64) {
    refuse_dtype(waveform, place, "histories are FLOAT64");
  }
  // Any other conversion would round, and the promise is the same bits.
  if (waveform.scale() != 1.0 || waveform.offset() != 0.0) {
    throw InputError(place + ".scale", "FLOAT64 elements are the values themselves",
                     "use scale 1 and offset 0");
  }
  return elements_of<double>(waveform, place);
}

}  // namespace kolsky::wire
