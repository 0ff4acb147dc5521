#include <algorithm>
#include <cstring>

#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kRunSamples = 1024;

bool enabled(const std::vector<std::uint32_t>& mask, std::size_t channel) {
  return channel / 32 < mask.size() && ((mask[channel / 32] >> (channel % 32)) & 1U) != 0;
}

template <typename Integer>
void interleave(std::span<const std::int32_t> codes, std::byte* out, std::size_t stride) {
  for (const std::int32_t code : codes) {
    const auto stored = static_cast<Integer>(code);
    std::memcpy(out, &stored, sizeof(stored));
    out += stride;
  }
}

void interleave_counter(Tick first, std::size_t samples, std::byte* out, std::size_t stride) {
  for (std::size_t i = 0; i < samples; ++i) {
    const auto count = static_cast<std::uint32_t>(first + static_cast<Tick>(i));
    std::memcpy(out, &count, sizeof(count));
    out += stride;
  }
}

}  // namespace

AdcStream::AdcStream(SimulatedAdc& adc, std::vector<std::uint32_t> mask, Tick block_samples)
    : adc_(adc),
      mask_(std::move(mask)),
      block_samples_(block_samples),
      buffers_(std::max(adc.now_tick(), adc.planned_until_), adc.buffers_count_),
      position_(buffers_.block_start()),
      codes_(kRunSamples) {
  lay_out_scan();
}

AdcStream::~AdcStream() {
  const std::lock_guard lock(adc_.mutex_);
  adc_.stream_ = nullptr;
}

/// As the kernel does: each element at a multiple of its own size, the scan a multiple of the
/// largest.
void AdcStream::lay_out_scan() {
  const std::size_t voltage_bytes = adc_.settings_.bits <= 16 ? 2 : 4;
  std::size_t largest = 1;
  for (std::size_t channel = 0; channel < adc_.scan_elements(); ++channel) {
    if (!enabled(mask_, channel)) {
      continue;
    }
    Element element;
    element.channel = channel;
    element.counter = channel == adc_.settings_.channels.size();
    element.bytes = element.counter ? sizeof(std::uint32_t) : voltage_bytes;
    element.offset = (scan_bytes_ + element.bytes - 1) / element.bytes * element.bytes;
    scan_bytes_ = element.offset + element.bytes;
    largest = std::max(largest, element.bytes);
    elements_.push_back(element);
  }
  scan_bytes_ = (scan_bytes_ + largest - 1) / largest * largest;
}

SimulatedAdc::Clock::time_point AdcStream::due() {
  const std::lock_guard lock(adc_.mutex_);
  if (planned_) {
    return SimulatedAdc::Clock::time_point::min();
  }
  const auto complete = adc_.time_of(buffers_.block_start() + block_samples_);
  if (complete <= SimulatedAdc::Clock::now()) {
    plan_block();
  }
  return complete;
}

/// Fixes what the block holds: it is complete, so every shot in it has been fired.
void AdcStream::plan_block() {
  planned_ = true;
  position_ = buffers_.block_start();
  block_end_ = position_ + block_samples_;
  adc_.fire_due_shots(block_end_);
  adc_.planned_until_ = std::max(adc_.planned_until_, block_end_);
}

std::size_t AdcStream::available() const noexcept {
  return planned_ ? static_cast<std::size_t>(block_end_ - position_) : 0;
}

void AdcStream::read(std::span<std::byte> out) {
  while (!out.empty()) {
    const std::lock_guard lock(adc_.mutex_);
    const std::size_t samples = std::min(out.size() / scan_bytes_, kRunSamples);
    read_run(position_, out.first(samples * scan_bytes_));
    position_ += static_cast<Tick>(samples);
    out = out.subspan(samples * scan_bytes_);
  }
  const std::lock_guard lock(adc_.mutex_);
  if (position_ == block_end_) {
    buffers_.finish_block(block_end_, std::max(adc_.now_tick(), block_end_));
    planned_ = false;
    adc_.note_lost(buffers_.lost_before());
  }
}

void AdcStream::read_run(Tick first, std::span<std::byte> out) {
  const std::size_t samples = out.size() / scan_bytes_;
  std::fill(out.begin(), out.end(), std::byte{0});
  const std::span<std::int32_t> codes(codes_.data(), samples);
  for (const Element& element : elements_) {
    std::byte* const place = out.data() + element.offset;
    if (element.counter) {
      interleave_counter(first, samples, place, scan_bytes_);
      continue;
    }
    adc_.source_->convert(element.channel, first, codes);
    if (element.bytes == 2) {
      interleave<std::int16_t>(codes, place, scan_bytes_);
    } else {
      interleave<std::int32_t>(codes, place, scan_bytes_);
    }
  }
}

}  // namespace kolsky
