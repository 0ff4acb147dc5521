#include "daemon/acquisition/sample_ring.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kPage = 4096;
// Planes a power of two apart would share cache sets; an odd number of lines between them does not.
constexpr std::size_t kStagger = 192;

std::size_t power_of_two(std::size_t channels, std::size_t capacity_samples) {
  if (channels == 0) throw InputError("channels", "the ring has none", "enable a channel");
  constexpr std::size_t kMost = std::size_t{1} << 34;
  if (capacity_samples == 0 || capacity_samples > kMost / channels) {
    throw InputError(
        "capacity_samples", std::to_string(capacity_samples) + " cannot be held",
        "give the samples per channel that cover the longest window, a few times over");
  }
  return std::bit_ceil(capacity_samples);
}

std::byte* touched(std::size_t bytes) {
  const std::size_t whole_pages = (bytes + kPage - 1) / kPage * kPage;
  void* memory = std::aligned_alloc(kPage, whole_pages);
  if (memory == nullptr) {
    throw InputError("capacity_samples", std::to_string(bytes) + " bytes are not to be had",
                     "ask for fewer samples");
  }
  std::memset(memory, 0, whole_pages);
  return static_cast<std::byte*>(memory);
}

template <class Code>
std::span<const Code> codes_of(std::span<const std::byte> bytes, std::size_t samples) {
  return {reinterpret_cast<const Code*>(bytes.data()), samples};
}

// Samples are written while readers may be copying the ones they replace; such copies are found out
// afterwards and thrown away. The thread sanitizer knows no fences, so under it each sample carries
// the order itself; elsewhere fences do and the copy is as wide as the machine.
#ifdef KOLSKY_SANITIZED
constexpr auto kStore = std::memory_order_release;
constexpr auto kLoad = std::memory_order_acquire;
void order_after_claim() noexcept {}
void order_after_copy() noexcept {}

template <class Code>
void store(Code& slot, Code code) noexcept {
  std::atomic_ref<Code>(slot).store(code, kStore);
}

template <class Code>
RunStatistics store_all(std::span<const Code> from, std::span<Code> to) noexcept {
  for (std::size_t i = 0; i < from.size(); ++i) store(to[i], from[i]);
  return run_statistics(from);
}
#else
constexpr auto kLoad = std::memory_order_relaxed;
void order_after_claim() noexcept {
  std::atomic_thread_fence(std::memory_order_release);
}
void order_after_copy() noexcept {
  std::atomic_thread_fence(std::memory_order_acquire);
}

template <class Code>
void store(Code& slot, Code code) noexcept {
  slot = code;
}

template <class Code>
RunStatistics store_all(std::span<const Code> from, std::span<Code> to) noexcept {
  return copy_with_statistics(from, to);
}
#endif

}  // namespace

void SampleRing::Free::operator()(std::byte* memory) const noexcept {
  std::free(memory);
}

SampleRing::SampleRing(SampleFormat format, std::size_t channels, std::size_t capacity_samples)
    : format_(format),
      channels_(channels),
      capacity_(power_of_two(channels, capacity_samples)),
      stride_bytes_(capacity_ * sample_bytes(format) + kStagger),
      memory_(touched(channels * stride_bytes_)) {}

template <class Code>
std::span<Code> SampleRing::plane(std::size_t channel) const noexcept {
  return {reinterpret_cast<Code*>(memory_.get() + channel * stride_bytes_), capacity_};
}

void SampleRing::claim(Tick end) noexcept {
  claimed_.store(end, std::memory_order_relaxed);
  order_after_claim();
}

void SampleRing::publish(Tick end) noexcept {
  published_.store(end, std::memory_order_release);
}

void SampleRing::write(const Block& block, std::span<RunStatistics> statistics) noexcept {
  const Tick end = block.first_tick + static_cast<Tick>(block.samples);
  if (empty_) {
    begin_.store(block.first_tick, std::memory_order_relaxed);
    published_.store(block.first_tick, std::memory_order_release);
    empty_ = false;
  }
  claim(std::max(end, published_.load(std::memory_order_relaxed)));
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    if (format_ == SampleFormat::int16) {
      write_channel<std::int16_t>(channel, block, end, statistics[channel]);
    } else {
      write_channel<std::int32_t>(channel, block, end, statistics[channel]);
    }
  }
  if (end > published_.load(std::memory_order_relaxed)) publish(end);
}

template <class Code>
void SampleRing::write_channel(std::size_t channel, const Block& block, Tick end,
                               RunStatistics& statistics) noexcept {
  const std::span<Code> ring = plane<Code>(channel);
  const std::size_t mask = capacity_ - 1;
  const auto capacity = static_cast<Tick>(capacity_);
  const Tick written = published_.load(std::memory_order_relaxed);

  const Tick hole_end = block.first_tick;
  if (hole_end > written && written > begin_.load(std::memory_order_relaxed)) {
    const Code last = ring[static_cast<std::size_t>(written - 1) & mask];
    for (Tick tick = std::max(written, hole_end - capacity); tick < hole_end; ++tick) {
      store(ring[static_cast<std::size_t>(tick) & mask], last);
    }
  }

  const auto codes = codes_of<Code>(block.channels[channel], block.samples);
  const std::size_t known = static_cast<std::size_t>(
      std::clamp(written - block.first_tick, Tick{0}, end - block.first_tick));
  statistics = known > 0 ? run_statistics(codes.first(known)) : RunStatistics{};
  for (std::size_t done = known; done < codes.size();) {
    const std::size_t slot =
        static_cast<std::size_t>(block.first_tick + static_cast<Tick>(done)) & mask;
    const std::size_t samples = std::min(codes.size() - done, capacity_ - slot);
    statistics =
        statistics.joined(store_all(codes.subspan(done, samples), ring.subspan(slot, samples)));
    done += samples;
  }
}

SampleRing::CopyStatus SampleRing::copy(std::size_t channel, Tick first,
                                        std::span<std::int32_t> codes) const noexcept {
  const Tick end = first + static_cast<Tick>(codes.size());
  if (end > published_.load(std::memory_order_acquire)) return CopyStatus::not_yet;
  if (first < begin_.load(std::memory_order_relaxed) || codes.size() > capacity_) {
    return CopyStatus::overwritten;
  }
  if (format_ == SampleFormat::int16) {
    copy_out<std::int16_t>(channel, first, codes);
  } else {
    copy_out<std::int32_t>(channel, first, codes);
  }
  order_after_copy();
  const Tick claimed = claimed_.load(std::memory_order_relaxed);
  return first < claimed - static_cast<Tick>(capacity_) ? CopyStatus::overwritten
                                                        : CopyStatus::copied;
}

template <class Code>
void SampleRing::copy_out(std::size_t channel, Tick first,
                          std::span<std::int32_t> codes) const noexcept {
  const std::span<Code> ring = plane<Code>(channel);
  const std::size_t mask = capacity_ - 1;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::size_t slot = static_cast<std::size_t>(first + static_cast<Tick>(i)) & mask;
    codes[i] = std::atomic_ref<Code>(ring[slot]).load(kLoad);
  }
}

Tick SampleRing::end_tick() const noexcept {
  return published_.load(std::memory_order_acquire);
}

}  // namespace kolsky
