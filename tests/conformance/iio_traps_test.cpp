// What libiio 0.24 and its protocol do that a caller does not expect, one guard a test.

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "drivers/digitiser/open.hpp"
#include "drivers/iio/iio_uri.hpp"
#include "drivers/iio/sigpipe_blocked.hpp"
#include "processing/base/error.hpp"
#include "tests/conformance/pattern.hpp"
#include "tests/conformance/reading.hpp"
#include "tests/conformance/rig.hpp"
#include "tests/conformance/scripted_scans.hpp"
#include "tests/conformance/simulated_device.hpp"

namespace kolsky {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Answers every READBUF whole, with the pattern going on.
class Streaming {
 public:
  explicit Streaming(bool counted = false) : counted_(counted) {}

  void operator()(ScriptedClient& client, std::size_t bytes) {
    const std::size_t samples = bytes / scan_bytes();
    client.send(first_chunk(mask(), pattern_scans(tick, samples, 2, counted_)));
    tick += static_cast<Tick>(samples);
  }
  [[nodiscard]] std::size_t scan_bytes() const { return counted_ ? 8 : 4; }
  [[nodiscard]] std::uint32_t mask() const { return counted_ ? 7 : 3; }

  Tick tick = 0;

 private:
  bool counted_;
};

std::unique_ptr<Digitiser> open_scripted(const ScriptedIiod& server) {
  auto digitiser = open_digitiser(server.uri(), pattern_options());
  digitiser->start();
  return digitiser;
}

::testing::AssertionResult shows_pattern(const Digitiser& digitiser, const Block& block,
                                         Tick first) {
  for (std::size_t channel = 0; channel < block.channels.size(); ++channel) {
    for (std::size_t i = 0; i < block.samples; ++i) {
      const Tick tick = first + static_cast<Tick>(i);
      if (code_at(digitiser.info(), block, channel, i) != pattern_code(channel, tick)) {
        return ::testing::AssertionFailure() << "channel " << channel << " sample " << i;
      }
    }
  }
  return ::testing::AssertionSuccess();
}

TEST(IioTraps, UriIsCopiedBecauseLibiioCutsItsPortOffInPlace) {
  SimulatedDevice device;
  const std::string uri = device.uri();
  const std::string same = std::string(uri.data(), uri.size());  // a buffer of its own
  const ContextHandle context = open_context(uri);
  EXPECT_EQ(uri, same);
  const auto digitiser = open_digitiser(uri, pattern_options());
  digitiser->start();
  EXPECT_TRUE(comes_back(*digitiser));
  EXPECT_EQ(uri, same);
  EXPECT_EQ(digitiser->info().uri, same);
}

TEST(IioTraps, SecondContextKeepsThePortThatACloneLoses) {
  SimulatedDevice device;
  ASSERT_NE(device.uri().substr(device.uri().rfind(':')), ":30431");
  const auto digitiser = open_digitiser(device.uri(), pattern_options());
  digitiser->start();
  std::thread other([&] { digitiser->fire(); });
  Block block;
  EXPECT_TRUE(next_block(*digitiser, block));
  other.join();
  EXPECT_EQ(device.shots(), 1);
}

void write_to_dropped_peer() {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  close(ends[1]);
  const char byte = 0;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(send(ends[0], &byte, 1, 0), -1);
    EXPECT_EQ(errno, EPIPE);
  }
  close(ends[0]);
}

TEST(IioTrapsDeathTest, SigpipeKillsWithoutTheGuard) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        std::signal(SIGPIPE, SIG_DFL);
        write_to_dropped_peer();
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGPIPE), "");
}

TEST(IioTraps, SigpipeOfADroppedPeerIsTakenBack) {
  const auto previous = std::signal(SIGPIPE, SIG_DFL);
  {
    const SigpipeBlocked guard;
    write_to_dropped_peer();
  }
  sigset_t pending;
  sigpending(&pending);
  EXPECT_EQ(sigismember(&pending, SIGPIPE), 0);
  std::signal(SIGPIPE, previous);
}

TEST(IioTraps, SigpipeDoesNotKillWhenTheDeviceIsSwitchedOff) {
  const auto previous = std::signal(SIGPIPE, SIG_DFL);
  AdcSettings settings = SimulatedDevice::pattern_settings();
  settings.counter = false;  // so that the overflow register is polled: a write, then EXIT another
  SimulatedDevice device(settings);
  const auto digitiser = open_digitiser(device.uri(), pattern_options());
  digitiser->start();
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  device.switch_off();
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(read_while(*digitiser, [](const Block&) { return true; }), ReadStatus::disconnected);
  EXPECT_FALSE(digitiser->reconnect());
  std::signal(SIGPIPE, previous);
}

TEST(IioTraps, StalledNetworkEndsTheSessionBecauseItsStreamIsOutOfStep) {
  Streaming stream;
  ScriptedIiod* server = nullptr;
  ScriptedIiod scripted({}, [&](ScriptedClient& client, std::size_t bytes, int call) {
    if (call != 1) {
      stream(client, bytes);
      return;
    }
    // Half a block, silence, and the other half too late: the next reader would take it for a
    // header.
    const std::string chunk = first_chunk(3, pattern_scans(stream.tick, bytes / 4));
    client.send(chunk.substr(0, chunk.size() / 2));
    server->pause(milliseconds(1500));
    client.send(chunk.substr(chunk.size() / 2));
  });
  server = &scripted;
  const auto digitiser = open_scripted(scripted);
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  const auto begin = Clock::now();
  ASSERT_EQ(digitiser->read(block), ReadStatus::disconnected);
  EXPECT_LT(seconds_since(begin), 1.4);
  ASSERT_TRUE(comes_back(*digitiser));
  std::this_thread::sleep_for(milliseconds(700));
  const Tick resumed = stream.tick;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::unknown);
  EXPECT_TRUE(shows_pattern(*digitiser, block, resumed));
}

TEST(IioTraps, ReadThatTimedOutMayHaveForgottenSamples) {
  Streaming stream;
  ScriptedIiod server({}, [&](ScriptedClient& client, std::size_t bytes, int call) {
    call == 1 ? static_cast<void>(client.send("-110\n")) : stream(client, bytes);
  });
  const auto digitiser = open_scripted(server);
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(digitiser->read(block), ReadStatus::timeout);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::unknown);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::none);
}

TEST(IioTraps, ReadThatTimedOutForgotNothingWhereTheDeviceCounts) {
  Streaming stream(true);
  ScriptedIiod server(counting_device(), [&](ScriptedClient& client, std::size_t bytes, int call) {
    call == 1 ? static_cast<void>(client.send("-110\n")) : stream(client, bytes);
  });
  const auto digitiser = open_scripted(server);
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(digitiser->read(block), ReadStatus::timeout);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.missing_before.kind, Missing::Kind::none);
}

TEST(IioTraps, ShortRefillIsABlock) {
  Streaming stream;
  ScriptedIiod server({}, [&](ScriptedClient& client, std::size_t bytes, int call) {
    if (call != 1) {
      stream(client, bytes);
      return;
    }
    stream(client, 400);
    client.send("0\n");
  });
  const auto digitiser = open_scripted(server);
  Block block;
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.samples, Rig::kBlockSamples);
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.samples, 100U);
  EXPECT_TRUE(shows_pattern(*digitiser, block, Rig::kBlockSamples));
  ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
  EXPECT_EQ(block.first_tick, static_cast<Tick>(Rig::kBlockSamples + 100));
  EXPECT_TRUE(shows_pattern(*digitiser, block, Rig::kBlockSamples + 100));
}

TEST(IioTraps, EmptyRefillIsATimeout) {
  ScriptedIiod server({}, [](ScriptedClient& client, std::size_t, int) { client.send("0\n"); });
  const auto digitiser = open_scripted(server);
  Block block;
  EXPECT_EQ(digitiser->read(block), ReadStatus::timeout);
}

TEST(IioTraps, StrideIsTakenAfterEveryRefillBecauseOtherChannelsMayComeIn) {
  ScriptedDevice device;
  device.channels.push_back({"voltage2"});
  device.texts["voltage2/scale"] = "1";
  Tick tick = 0;
  ScriptedIiod server(device, [&](ScriptedClient& client, std::size_t, int call) {
    const std::size_t channels = call % 2 == 0 ? 2 : 3;
    client.send(first_chunk(channels == 2 ? 3 : 7, pattern_scans(tick, 200, channels)));
    client.send("0\n");
    tick += 200;
  });
  const auto digitiser = open_scripted(server);
  Block block;
  for (int i = 0; i < 6; ++i) {
    ASSERT_EQ(digitiser->read(block), ReadStatus::samples);
    ASSERT_EQ(block.samples, 200U);
    ASSERT_EQ(block.channels.size(), 2U);
    EXPECT_TRUE(shows_pattern(*digitiser, block, Tick{200} * i));
  }
}

TEST(IioTraps, ScansThatLackAChannelOrAreCutAreNotDelivered) {
  for (const bool cut : {false, true}) {
    ScriptedIiod server({}, [&](ScriptedClient& client, std::size_t, int) {
      client.send(cut ? first_chunk(3, pattern_scans(0, 100).substr(1))
                      : first_chunk(1, pattern_scans(0, 100, 1)));
      client.send("0\n");
    });
    const auto digitiser = open_scripted(server);
    Block block;
    EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected) << (cut ? "cut" : "lacking");
  }
}

TEST(IioTraps, ScaleIsReadAsADoubleInMillivolts) {
  ScriptedDevice device;
  device.texts["voltage0/scale"] = "0.1234567890123456\n";
  device.texts["voltage0/offset"] = "-3.25";
  device.channels[0].attributes = {"scale", "offset"};
  ScriptedIiod server(device, [](ScriptedClient&, std::size_t, int) {});
  const auto digitiser = open_digitiser(server.uri(), pattern_options());
  const ChannelInfo& channel = digitiser->info().channels[0];
  EXPECT_EQ(channel.scale, 0.1234567890123456 / 1000.0);
  EXPECT_NE(channel.scale, static_cast<double>(0.1234567890123456F) / 1000.0);
  EXPECT_EQ(channel.offset, -3.25);
}

TEST(IioTraps, KernelBuffersAndChannelsAreSetBeforeTheBufferIsMade) {
  Streaming stream;
  ScriptedIiod server(
      {}, [&](ScriptedClient& client, std::size_t bytes, int) { stream(client, bytes); });
  const auto digitiser = open_scripted(server);
  const std::vector<std::string> lines = server.lines();
  const auto line = [&](const std::string& start) {
    return std::find_if(lines.begin(), lines.end(),
                        [&](const std::string& text) { return text.starts_with(start); });
  };
  ASSERT_NE(line("OPEN"), lines.end());
  EXPECT_EQ(*line("OPEN"), "OPEN iio:device0 1024 00000003");
  EXPECT_LT(line("SET iio:device0 BUFFERS_COUNT 128"), line("OPEN"));
}

TEST(IioTraps, SecondBufferOfADeviceIsRefusedInWords) {
  SimulatedDevice device;
  const auto first = open_digitiser(device.uri(), pattern_options());
  first->start();
  const auto second = open_digitiser(device.uri(), pattern_options());
  try {
    second->start();
    FAIL() << "two readers of one device";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("in use"), std::string::npos) << error.what();
    EXPECT_EQ(error.place(), device.uri());
  }
  Block block;
  EXPECT_EQ(second->read(block), ReadStatus::disconnected);
}

TEST(IioTraps, HangingRefillIsCutByTheWatchdog) {
  ScriptedIiod* server = nullptr;
  ScriptedIiod scripted({}, [&](ScriptedClient& client, std::size_t, int) {
    // A byte now and then keeps every time-out of libiio from running out.
    client.send("4096\n00000003\n");
    while (client.send("x")) {
      server->pause(milliseconds(200));
    }
  });
  server = &scripted;
  const auto digitiser = open_scripted(scripted);
  Block block;
  const auto begin = Clock::now();
  EXPECT_EQ(digitiser->read(block), ReadStatus::disconnected);
  EXPECT_GT(seconds_since(begin), 2.0);
  EXPECT_LT(seconds_since(begin), 3.5);
}

struct Answer {
  const char* line;
  ReadStatus status;
};

class IioRefillErrors : public testing::TestWithParam<Answer> {};

TEST_P(IioRefillErrors, AreToldApart) {
  ScriptedIiod server(
      {}, [](ScriptedClient& client, std::size_t, int) { client.send(GetParam().line); });
  const auto digitiser = open_scripted(server);
  Block block;
  EXPECT_EQ(digitiser->read(block), GetParam().status);
}

INSTANTIATE_TEST_SUITE_P(Errnos, IioRefillErrors,
                         testing::Values(Answer{"-110\n", ReadStatus::timeout},
                                         Answer{"-11\n", ReadStatus::timeout},
                                         Answer{"-4\n", ReadStatus::timeout},
                                         Answer{"-32\n", ReadStatus::disconnected},
                                         Answer{"-9\n", ReadStatus::disconnected},
                                         Answer{"-19\n", ReadStatus::disconnected},
                                         Answer{"-5\n", ReadStatus::disconnected},
                                         Answer{"nonsense\n", ReadStatus::disconnected}));

TEST(IioTraps, ServerThatAnswersAByteAtATimeDoesNotHoldTheOpening) {
  ScriptedDevice device;
  device.trickle = milliseconds(300);
  ScriptedIiod server(device, [](ScriptedClient&, std::size_t, int) {});
  const auto begin = Clock::now();
  EXPECT_THROW((void)open_digitiser(server.uri(), pattern_options()), InputError);
  EXPECT_LT(seconds_since(begin), 6.0);
}

}  // namespace
}  // namespace kolsky
