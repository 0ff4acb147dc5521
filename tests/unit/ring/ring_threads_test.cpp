#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include "daemon/acquisition/sample_ring.hpp"

namespace kolsky {
namespace {

using CopyStatus = SampleRing::CopyStatus;
using std::chrono::milliseconds;

constexpr std::size_t kChannels = 2;
constexpr std::size_t kCapacity = 2048;
constexpr std::size_t kBlock = 100;

template <class Code>
Code code_at(std::size_t channel, Tick tick) {
  const auto mixed = (static_cast<std::uint64_t>(tick) + 977 * channel) * 0x9E3779B97F4A7C15ULL;
  return static_cast<Code>(mixed >> 40);
}

template <class Code>
void write_until(SampleRing& ring, const std::atomic<bool>& stop) {
  std::vector<std::vector<Code>> codes(kChannels, std::vector<Code>(kBlock));
  std::vector<RunStatistics> statistics(kChannels);
  Block block;
  block.samples = kBlock;
  for (const auto& channel : codes) block.channels.push_back(std::as_bytes(std::span(channel)));
  while (!stop.load()) {
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      for (std::size_t i = 0; i < kBlock; ++i) {
        codes[channel][i] = code_at<Code>(channel, block.first_tick + static_cast<Tick>(i));
      }
    }
    ring.write(block, statistics);
    block.first_tick += kBlock;
  }
}

struct Outcome {
  long copied = 0;
  long overwritten = 0;
  long not_yet = 0;
  long wrong = 0;  ///< samples of windows said to be good
};

template <class Code>
Outcome read_until(const SampleRing& ring, const std::atomic<bool>& stop, unsigned seed) {
  Outcome outcome;
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::size_t> length(1, kCapacity);
  std::uniform_int_distribution<Tick> back(0, kCapacity + kBlock);
  std::vector<std::int32_t> window(kCapacity);
  while (!stop.load()) {
    const std::size_t channel = random() % kChannels;
    const Tick first = std::max(Tick{0}, ring.end_tick() - back(random));
    const std::span<std::int32_t> codes(window.data(), length(random));
    switch (ring.copy(channel, first, codes)) {
      case CopyStatus::copied:
        ++outcome.copied;
        for (std::size_t i = 0; i < codes.size(); ++i) {
          outcome.wrong += codes[i] != code_at<Code>(channel, first + static_cast<Tick>(i)) ? 1 : 0;
        }
        break;
      case CopyStatus::overwritten:
        ++outcome.overwritten;
        break;
      case CopyStatus::not_yet:
        ++outcome.not_yet;
        break;
    }
  }
  return outcome;
}

template <class Code>
void lap_readers(SampleFormat format) {
  SampleRing ring(format, kChannels, kCapacity);
  std::atomic<bool> stop{false};
  std::vector<Outcome> outcomes(2);
  std::vector<std::thread> threads;
  threads.emplace_back([&] { write_until<Code>(ring, stop); });
  for (unsigned reader = 0; reader < outcomes.size(); ++reader) {
    threads.emplace_back([&, reader] { outcomes[reader] = read_until<Code>(ring, stop, reader); });
  }
  std::this_thread::sleep_for(milliseconds(400));
  stop.store(true);
  for (std::thread& thread : threads) thread.join();
  for (const Outcome& outcome : outcomes) {
    EXPECT_EQ(outcome.wrong, 0);
    EXPECT_GT(outcome.copied, 0);
    EXPECT_GT(outcome.overwritten, 0);
    EXPECT_GT(outcome.not_yet, 0);
  }
}

TEST(SampleRingThreads, NoTornWindowPassesForAGoodOne) {
  lap_readers<std::int16_t>(SampleFormat::int16);
  lap_readers<std::int32_t>(SampleFormat::int32);
}

}  // namespace
}  // namespace kolsky
