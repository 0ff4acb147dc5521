#include "drivers/iio/sampling_rate.hpp"

#include <cmath>
#include <string>

#include "drivers/iio/iio_attributes.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr const char* kRate = "sampling_frequency";
constexpr double kTolerance = 1e-6;

std::optional<AttributeOwner> rate_owner(const iio_device* device,
                                         const std::vector<ScanChannel>& channels) {
  if (const AttributeOwner owner{device, nullptr}; owner.has(kRate)) {
    return owner;
  }
  for (const ScanChannel& channel : channels) {
    if (const AttributeOwner owner{device, channel.channel}; owner.has(kRate)) {
      return owner;
    }
  }
  return std::nullopt;
}

double rate_of(const AttributeOwner& owner) {
  const std::optional<double> rate_Hz = read_number(owner, kRate);
  if (!rate_Hz || *rate_Hz <= 0.0) {
    throw InputError(owner.id() + " " + kRate, "cannot be read",
                     "check the digitiser with iio_attr");
  }
  return *rate_Hz;
}

bool agrees(double rate_Hz, double asked_Hz) {
  return std::abs(rate_Hz - asked_Hz) <= kTolerance * asked_Hz;
}

std::string mend(const AttributeOwner& owner) {
  const std::optional<std::string> rates = read_text(owner, "sampling_frequency_available");
  return rates ? "set the bench's sampling_frequency_Hz to one of " + *rates
               : "set the bench's sampling_frequency_Hz to what the digitiser runs at";
}

double known_rate(double asked_Hz, const iio_device* device) {
  if (asked_Hz <= 0.0) {
    throw InputError(device_title(device), "does not say its sampling rate",
                     "state sampling_frequency_Hz in the bench file");
  }
  return asked_Hz;
}

}  // namespace

double settle_sampling_rate(const iio_device* device, const std::vector<ScanChannel>& channels,
                            double asked_Hz) {
  const std::optional<AttributeOwner> owner = rate_owner(device, channels);
  if (!owner) {
    return known_rate(asked_Hz, device);
  }
  const double before_Hz = rate_of(*owner);
  if (asked_Hz <= 0.0 || agrees(before_Hz, asked_Hz)) {
    return before_Hz;
  }
  const bool written = write_text(*owner, kRate, plain_number(asked_Hz)) == 0;
  const double rate_Hz = rate_of(*owner);
  if (!agrees(rate_Hz, asked_Hz)) {
    throw InputError(device_title(device),
                     "samples at " + plain_number(rate_Hz) + " Hz" +
                         (written ? "" : " and refuses another rate") + ", " +
                         plain_number(asked_Hz) + " Hz is asked",
                     mend(*owner));
  }
  return rate_Hz;
}

}  // namespace kolsky
