#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "drivers/digitiser/open.hpp"
#include "drivers/iio/iio_uri.hpp"
#include "drivers/iio/monotonic.hpp"
#include "drivers/iio/overflow_register.hpp"
#include "tests/conformance/pattern.hpp"
#include "tests/conformance/reading.hpp"
#include "tests/conformance/rig.hpp"
#include "tests/conformance/scripted_scans.hpp"
#include "tests/conformance/simulated_device.hpp"

namespace kolsky {
namespace {

using std::chrono::milliseconds;

std::unique_ptr<Digitiser> open_started(const std::string& uri) {
  auto digitiser = open_digitiser(uri, pattern_options());
  digitiser->start();
  return digitiser;
}

/// Sends scans whose counter starts at the given numbers, one refill each, then the last of them
/// going on.
class CountedRefills {
 public:
  explicit CountedRefills(std::vector<Tick> starts) : starts_(std::move(starts)) {}

  void operator()(ScriptedClient& client, std::size_t bytes, int call) {
    const auto i = static_cast<std::size_t>(call);
    next_ = i < starts_.size() ? starts_[i] : next_;
    const std::size_t samples = bytes / 8;
    client.send(first_chunk(7, pattern_scans(next_, samples, 2, true)));
    next_ += static_cast<Tick>(samples);
  }

 private:
  std::vector<Tick> starts_;
  Tick next_ = 0;
};

constexpr Tick kBlock = Rig::kBlockSamples;

TEST(CountedLosses, AreKnownToTheSample) {
  ScriptedIiod server(counting_device(), CountedRefills({500, 500 + kBlock + 37}));
  const auto digitiser = open_started(server.uri());
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.first_tick, 0);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::none) << "nothing was before the first";
  EXPECT_EQ(digitiser->read(block), ReadStatus::overflow);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::known);
  EXPECT_EQ(block.missing_before.samples, 37);
  EXPECT_EQ(block.first_tick, kBlock + 37);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::none);
}

TEST(CountedLosses, InsideARefillCutItInTwo) {
  const auto send = [](ScriptedClient& client, std::size_t bytes, int) {
    const std::size_t rest = bytes / 8 - 301;
    client.send(first_chunk(7, pattern_scans(0, 300, 2, true) + pattern_scans(400, 1, 2, true) +
                                   pattern_scans(402, rest, 2, true)));
  };
  ScriptedIiod server(counting_device(), send);
  const auto digitiser = open_started(server.uri());
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.samples, 300U);
  EXPECT_EQ(digitiser->read(block), ReadStatus::overflow);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.first_tick, 400);
  EXPECT_EQ(block.missing_before.samples, 100);
  EXPECT_EQ(block.samples, 1U);
  EXPECT_EQ(digitiser->read(block), ReadStatus::overflow);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.first_tick, 402);
  EXPECT_EQ(block.missing_before.samples, 1);
  EXPECT_EQ(code_at(digitiser->info(), block, 1, 5), pattern_code(1, 407));
}

TEST(CountedLosses, AreNoneWhenTheCounterGoesRound) {
  ScriptedIiod server(counting_device(), CountedRefills({(Tick{1} << 32) - 1500}));
  const auto digitiser = open_started(server.uri());
  Block block;
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
    EXPECT_EQ(block.missing_before.kind, Missing::Kind::none);
    EXPECT_EQ(block.first_tick, i * kBlock);
  }
}

TEST(CountedLosses, AcrossTheRoundAreCountedToo) {
  const Tick start = (Tick{1} << 32) - 1500;
  ScriptedIiod server(counting_device(), CountedRefills({start, start + kBlock + 2000}));
  const auto digitiser = open_started(server.uri());
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  ASSERT_EQ(digitiser->read(block), ReadStatus::overflow);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.samples, 2000);
}

TEST(CountedLosses, AreUnknownWhenTheDeviceCountsFromAnew) {
  const auto send = [](ScriptedClient& client, std::size_t bytes, int call) {
    if (call == 1) {
      client.hang_up();
      return;
    }
    const Tick start = call == 0 ? 3'000'000'000 : (call - 2) * kBlock;
    client.send(first_chunk(7, pattern_scans(start, bytes / 8, 2, true)));
  };
  ScriptedIiod server(counting_device(), send);
  const auto digitiser = open_started(server.uri());
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  ASSERT_EQ(digitiser->read(block), ReadStatus::disconnected);
  ASSERT_TRUE(comes_back(*digitiser));
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::unknown);
  EXPECT_EQ(block.first_tick, kBlock);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::none);
}

TEST(CountedLosses, AcrossADisconnectionAreKnownWhenTheDeviceCountsOn) {
  SimulatedDevice device;
  const auto digitiser = open_started(device.uri());
  Block block;
  ASSERT_TRUE(next_block(*digitiser, block));
  const Tick anchor = pattern_tick(code_at(digitiser->info(), block, 0, 0)) - block.first_tick;
  device.switch_off();
  EXPECT_EQ(read_while(*digitiser, [](const Block&) { return true; }), ReadStatus::disconnected);
  std::this_thread::sleep_for(milliseconds(200));
  device.switch_on();
  ASSERT_TRUE(comes_back(*digitiser));
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples)
      << "no overflow: the disconnection said it";
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::known);
  EXPECT_GT(block.missing_before.samples, 200'000);
  EXPECT_EQ(code_at(digitiser->info(), block, 0, 0), pattern_code(0, anchor + block.first_tick));
}

TEST(CountedLosses, AnEncoderIsNoSampleCounter) {
  ScriptedDevice device;
  device.channels.push_back({"count1", "le:u32/32>>0", {}});
  ScriptedIiod server(device, [](ScriptedClient& client, std::size_t bytes, int) {
    client.send(first_chunk(3, pattern_scans(0, bytes / 4)));
  });
  const auto digitiser = open_started(server.uri());
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.samples, Rig::kBlockSamples);
}

AdcSettings without_counter() {
  AdcSettings settings = SimulatedDevice::pattern_settings();
  settings.counter = false;
  return settings;
}

TEST(FlaggedLosses, AreFlaggedByTheRegisterAndMarkEveryBlockThatMayHaveThem) {
  SimulatedDevice device(without_counter());
  const auto digitiser = open_started(device.uri());
  const auto place = [&](const Block& block) {
    return static_cast<std::uint16_t>(pattern_tick(code_at(digitiser->info(), block, 0, 0)) -
                                      block.first_tick);
  };
  Block block;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
    ASSERT_EQ(block.missing_before.kind, Missing::Kind::none);
  }
  std::uint16_t before = place(block);
  std::this_thread::sleep_for(milliseconds(300));
  int overflows = 0;
  int marked = 0;
  int holes = 0;
  for (int i = 0; i < 800; ++i) {
    const ReadStatus status = digitiser->read(block);
    overflows += status == ReadStatus::overflow ? 1 : 0;
    if (status != ReadStatus::samples) {
      continue;
    }
    const bool hole = place(block) != before;
    before = place(block);
    holes += hole ? 1 : 0;
    marked += block.missing_before.kind == Missing::Kind::unknown ? 1 : 0;
    EXPECT_TRUE(!hole || block.missing_before.kind == Missing::Kind::unknown);
    EXPECT_EQ(block.missing_before.samples, 0);
  }
  EXPECT_GT(overflows, 0);
  EXPECT_GT(holes, 0);
  EXPECT_GE(marked, 129);
  EXPECT_LT(marked, 800) << "the marks must end";
}

TEST(FlaggedLosses, OnTheWayToTheQueueAreMarkedAtMostHalfAQueueLate) {
  AdcSettings settings = without_counter();
  for (int i = 1; i <= 5; ++i) {
    settings.faults.push_back({.kind = FaultKind::lose, .time_s = 0.2 * i, .samples = 100 + i});
  }
  SimulatedDevice device(settings);
  const auto digitiser = open_started(device.uri());
  std::optional<Tick> next;
  int holes = 0;
  int unmarked_blocks = 0;  ///< since the last hole that is not marked yet
  int overflows = 0;
  Block block;
  while (!next || block.first_tick < 1'300'000) {
    const ReadStatus status = digitiser->read(block);
    overflows += status == ReadStatus::overflow ? 1 : 0;
    ASSERT_NE(status, ReadStatus::disconnected);
    for (std::size_t i = 0; status == ReadStatus::samples && i < block.samples; ++i) {
      const Tick tick = pattern_tick(code_at(digitiser->info(), block, 0, i));
      const bool hole = next && tick != *next % 65'536;
      holes += hole ? 1 : 0;
      unmarked_blocks += hole ? 1 : 0;
      next = tick + 1;
    }
    if (status == ReadStatus::samples) {
      const bool marked = block.missing_before.kind == Missing::Kind::unknown;
      unmarked_blocks = marked ? 0 : unmarked_blocks + (unmarked_blocks > 0 ? 1 : 0);
      EXPECT_LE(unmarked_blocks, 64);
    }
  }
  EXPECT_GE(overflows, 5);
  EXPECT_GE(holes, 5);
}

TEST(FlaggedLosses, PollsTakeAThirdOfTheTimeAtMostAndAreMade) {
  SimulatedDevice device(without_counter());
  const ContextHandle context = open_context(device.uri());
  OverflowRegister flag(iio_context_get_device(context.get(), 0));
  ASSERT_TRUE(flag.works());
  const std::int64_t begin_ns = monotonic_ns();
  std::int64_t polling_ns = 0;
  int polls = 0;
  std::int64_t now_ns = begin_ns;
  while (now_ns - begin_ns < 200'000'000) {
    const bool polled = flag.poll(now_ns, false) != OverflowRegister::Answer::not_due;
    const std::int64_t done_ns = monotonic_ns();
    polling_ns += polled ? done_ns - now_ns : 0;
    polls += polled ? 1 : 0;
    now_ns = done_ns;
  }
  EXPECT_LT(static_cast<double>(polling_ns), 0.4 * static_cast<double>(now_ns - begin_ns));
  EXPECT_GT(polls, 10);
  EXPECT_EQ(flag.poll(now_ns, true), OverflowRegister::Answer::clear) << "at once, if asked";
  EXPECT_EQ(flag.poll(now_ns, true), OverflowRegister::Answer::clear);
}

TEST(FlaggedLosses, NoOtherRegisterIsTakenForTheFlagOrWritten) {
  for (const char* value : {"0x80", "0xffffffff"}) {
    ScriptedDevice device;
    device.debug_attributes = {"direct_reg_access"};
    device.texts["DEBUG/direct_reg_access"] = value;
    device.sticks = false;
    ScriptedIiod server(device, [](ScriptedClient& client, std::size_t bytes, int) {
      client.send(first_chunk(3, pattern_scans(0, bytes / 4)));
    });
    const auto digitiser = open_started(server.uri());
    EXPECT_NE(digitiser->info().description.find("clock"), std::string::npos);
    Block block;
    ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
    const auto lines = server.lines();
    const auto reads =
        std::count(lines.begin(), lines.end(), "READ iio:device0 DEBUG direct_reg_access");
    EXPECT_EQ(reads, 1);
  }
}

TEST(FlaggedLosses, ControlConnectionThatBreaksIsADisconnection) {
  ScriptedDevice device;
  device.debug_attributes = {"direct_reg_access"};
  device.texts["DEBUG/direct_reg_access"] = "0x0";
  device.sticks = false;
  device.breaks_on_poll = 3;
  ScriptedIiod server(device, [](ScriptedClient& client, std::size_t bytes, int) {
    client.send(first_chunk(3, pattern_scans(0, bytes / 4)));
  });
  const auto digitiser = open_started(server.uri());
  EXPECT_EQ(read_while(*digitiser, [](const Block&) { return true; }), ReadStatus::disconnected);
}

}  // namespace
}  // namespace kolsky
