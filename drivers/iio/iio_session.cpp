#include "drivers/iio/iio_session.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "drivers/iio/iio_attributes.hpp"
#include "drivers/iio/iio_uri.hpp"
#include "drivers/iio/sampling_rate.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr double kLongestBlock_s = 0.2;
constexpr double kKernelBuffers_s = 0.2;
constexpr double kFewestBuffers = 4;
constexpr double kMostBuffers = 128;

/// Whatever is asked for, a block must come before a read times out.
std::size_t block_samples(const DigitiserOptions& options, double arrival_Hz) {
  const auto longest = static_cast<std::size_t>(std::max(1.0, kLongestBlock_s * arrival_Hz));
  const std::size_t wanted =
      options.block_samples != 0 ? options.block_samples : default_block(arrival_Hz);
  return std::clamp<std::size_t>(wanted, 1, longest);
}

/// Only a simulated device says that its time runs faster or slower than ours.
double speed_of(const AttributeOwner& device) {
  const double speed = device.has("speed") ? read_number(device, "speed").value_or(1.0) : 1.0;
  return speed >= 0.0 ? speed : 1.0;
}

unsigned int kernel_buffers_for(double arrival_Hz, std::size_t block) {
  const double wanted = std::ceil(kKernelBuffers_s * arrival_Hz / static_cast<double>(block));
  return static_cast<unsigned int>(std::clamp(wanted, kFewestBuffers, kMostBuffers));
}

SampleFormat narrowest(const std::vector<ScanChannel>& channels) {
  const bool small = std::all_of(channels.begin(), channels.end(), [](const ScanChannel& channel) {
    return channel.info.code_min >= INT16_MIN && channel.info.code_max <= INT16_MAX;
  });
  return small ? SampleFormat::int16 : SampleFormat::int32;
}

[[noreturn]] void throw_no_buffer(const std::string& uri, const std::string& device, int error) {
  const std::string reason = " (" + error_text(-error) + ")";
  if (error == EBUSY) {
    throw InputError(uri, device + " is in use" + reason, "stop the other program that reads it");
  }
  if (error == ENOSYS || error == EPERM || error == EACCES || error == EINVAL) {
    throw InputError(uri, device + " does not stream" + reason,
                     "check with iio_readdev, also whether its channels may be read together");
  }
  throw InputError(uri, device + " cannot be opened" + reason,
                   "check the connection with iio_info -u");
}

}  // namespace

IioSession::IioSession(const std::string& uri, const DigitiserOptions& options)
    : context_(open_context(uri)) {
  const SigpipeBlocked guard;
  try {
    choose(options);
    find_loss_reports();
    const double rate_Hz = settle_sampling_rate(device_, channels_, options.sampling_frequency_Hz);
    info_ = describe(uri, rate_Hz, options);
  } catch (const InputError& error) {
    throw error.inside(uri);
  }
  for (const ScanChannel& channel : channels_) {
    decoders_.emplace_back(channel.format, info_.format);
  }
}

void IioSession::choose(const DigitiserOptions& options) {
  device_ = choose_device(context_.get(), options);
  channels_ = choose_channels(device_, options);
  for (const ScanChannel& channel : channels_) {
    least_scan_bytes_ += channel.format.storage_bytes;
  }
}

void IioSession::find_loss_reports() {
  counter_ = find_counter(device_);
  if (counter_ != nullptr) {
    counter_format_ = scan_format(counter_);
    least_scan_bytes_ += counter_format_->storage_bytes;
    return;
  }
  overflow_.emplace(device_);
  if (!overflow_->works()) {
    overflow_.reset();
  }
}

StreamInfo IioSession::describe(const std::string& uri, double rate_Hz,
                                const DigitiserOptions& options) const {
  StreamInfo info;
  info.uri = uri;
  info.description = device_title(device_) + ", " + iio_context_get_description(context_.get()) +
                     "; lost samples: " + loss_report();
  info.rate = SampleRate::from_Hz(rate_Hz);
  info.format = narrowest(channels_);
  for (const ScanChannel& channel : channels_) {
    info.channels.push_back(channel.info);
  }
  const AttributeOwner device{device_, nullptr};
  info.simulated = device.has("fire");
  info.speed = info.simulated ? speed_of(device) : 1.0;
  info.max_block_samples = block_samples(options, arrival_rate_Hz(info));
  return info;
}

std::string IioSession::loss_report() const {
  if (counter_ != nullptr) {
    return std::string("counted by ") + iio_channel_get_id(counter_);
  }
  return overflow_ ? "flagged by the overflow register, not counted"
                   : "estimated against the clock, not counted";
}

void IioSession::enable_channels() {
  for (unsigned int i = 0; i < iio_device_get_channels_count(device_); ++i) {
    iio_channel_disable(iio_device_get_channel(device_, i));
  }
  for (const ScanChannel& channel : channels_) {
    iio_channel_enable(channel.channel);
  }
  if (counter_ != nullptr) {
    iio_channel_enable(counter_);
  }
}

void IioSession::start() {
  const SigpipeBlocked guard;
  const unsigned int wanted = kernel_buffers_for(arrival_rate_Hz(info_), info_.max_block_samples);
  if (iio_device_set_kernel_buffers_count(device_, wanted) == 0) {
    kernel_buffers_ = wanted;
  }
  enable_channels();
  errno = 0;
  buffer_.reset(iio_device_create_buffer(device_, info_.max_block_samples, false));
  if (!buffer_) {
    throw_no_buffer(info_.uri, device_title(device_), errno);
  }
}

ssize_t IioSession::refill() noexcept {
  const SigpipeBlocked guard;
  return buffer_ ? iio_buffer_refill(buffer_.get()) : -EBADF;
}

IioSession::Scans IioSession::scans() const noexcept {
  const auto* start = static_cast<const std::byte*>(iio_buffer_start(buffer_.get()));
  const auto* end = static_cast<const std::byte*>(iio_buffer_end(buffer_.get()));
  const std::ptrdiff_t stride = iio_buffer_step(buffer_.get());
  if (stride < least_scan_bytes_ || (end - start) % stride != 0) {
    return {};
  }
  return {static_cast<std::size_t>((end - start) / stride), stride, true};
}

void IioSession::decode(std::size_t channel, const Scans& scans, std::byte* out) const noexcept {
  decoders_[channel].decode(first_value(channels_[channel].channel), scans.stride, scans.count,
                            out);
}

const std::byte* IioSession::counter_values() const noexcept {
  return first_value(counter_);
}

const std::byte* IioSession::first_value(const iio_channel* channel) const noexcept {
  return static_cast<const std::byte*>(iio_buffer_first(buffer_.get(), channel));
}

void IioSession::cancel() noexcept {
  if (buffer_) {
    iio_buffer_cancel(buffer_.get());
  }
}

}  // namespace kolsky
