#include <gtest/gtest.h>

#include <cerrno>
#include <thread>

#include "tests/unit/simulated/served_ramp.hpp"

namespace kolsky::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kBlock = 100;
constexpr std::size_t kBlockBytes = kBlock * sizeof(Scan);

/// Follows a stream's counter as a client would.
class Account {
 public:
  void add(const std::vector<Scan>& scans) {
    for (const Scan& scan : scans) {
      if (next_) {
        missing += static_cast<std::uint32_t>(scan.count - *next_);
      }
      next_ = scan.count + 1;
      ++received;
      EXPECT_EQ(scan.voltage[0], RampSource::ramp(0, scan.count));
    }
  }
  std::int64_t missing = 0;
  std::int64_t received = 0;

 private:
  std::optional<std::uint32_t> next_;
};

class Faults : public ::testing::Test {
 protected:
  void serve(const std::string& script, double speed = 0.0) {
    served = std::make_unique<ServedRamp>(ramp_settings(speed, script));
    control = std::make_unique<RawClient>(*served);
    open();
  }
  void open() {
    stream = std::make_unique<RawClient>(*served);
    ASSERT_EQ(stream->ask("OPEN iio:device0 100 00000007"), "0");
  }
  BufferReply read() {
    BufferReply reply = read_buffer(*stream, kBlockBytes);
    if (reply.error == 0 && reply.mask == "00000007") {
      account.add(reply.scans());
    }
    return reply;
  }
  /// Of a paced stream: a busy machine may lose samples of its own.
  std::int64_t lost() {
    return std::stol(injected()) + std::stol(control->attribute("overrun_lost_samples"));
  }
  std::string injected() { return control->attribute("injected_lost_samples"); }

  std::unique_ptr<ServedRamp> served;
  std::unique_ptr<RawClient> control;
  std::unique_ptr<RawClient> stream;
  Account account;
};

TEST_F(Faults, LoseSamplesOfAShot) {
  serve("shot 2 at 120 lose 250\nshot 2 at 120 lose 50\nshot 2 at 1300 lose 1\n");
  control->write("fire", "1");
  for (int block = 0; block < 25; ++block) {
    EXPECT_EQ(read().bytes.size(), kBlockBytes);
  }
  EXPECT_EQ(account.missing, 0);
  EXPECT_EQ(control->status(), 0U);
  control->write("fire", "1");
  for (int block = 0; block < 25; ++block) {
    EXPECT_EQ(read().bytes.size(), kBlockBytes) << "a loss must not shorten blocks";
  }
  // The second fault hits a sample that the first one lost, so it strikes behind it.
  EXPECT_EQ(account.missing, 301);
  EXPECT_EQ(account.received, 5000);
  EXPECT_EQ(injected(), "301");
  EXPECT_EQ(control->status(), 4U);
}

TEST_F(Faults, LoseSamplesWhereTheScriptSays) {
  serve("time 1050us lose 30\n");
  std::vector<std::uint32_t> counts;
  for (int block = 0; block < 12; ++block) {
    for (const Scan& scan : read().scans()) {
      counts.push_back(scan.count);
    }
  }
  EXPECT_EQ(counts[1049], 1049U);
  EXPECT_EQ(counts[1050], 1080U);
}

TEST_F(Faults, ShortBlockGivesItsRestLater) {
  serve("time 250us short 7\n");
  read();
  read();
  const BufferReply reply = read();
  EXPECT_EQ(reply.chunks, std::vector<std::size_t>{7 * sizeof(Scan)});
  EXPECT_TRUE(reply.ended_short);
  read();
  read();
  EXPECT_EQ(account.missing, 0);
  EXPECT_EQ(injected(), "0");
}

TEST_F(Faults, LateBlockIsLateAndWhole) {
  serve("time 5ms late 3ms\n", 0.1);  // 30 ms of the client's; the four buffers hold 4
  std::chrono::steady_clock::duration longest{};
  for (int block = 0; block < 70; ++block) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(read().bytes.size(), kBlockBytes);
    longest = std::max(longest, std::chrono::steady_clock::now() - start);
  }
  EXPECT_GE(longest, 30ms);
  EXPECT_GE(std::stol(injected()), 2600) << "the buffers hold 4 blocks of the 30";
  EXPECT_EQ(lost(), account.missing);
}

TEST_F(Faults, LateBlockWithinTheBuffersLosesNothing) {
  serve("time 2ms late 200us\n");
  for (int block = 0; block < 40; ++block) {
    read();
  }
  EXPECT_EQ(account.missing, 0);
  EXPECT_EQ(injected(), "0");
  EXPECT_EQ(control->status(), 0U);
}

TEST_F(Faults, TimeoutReplyKeepsTheBlock) {
  serve("time 250us timeout\n");
  read();
  read();
  EXPECT_EQ(read().error, -ETIMEDOUT);
  EXPECT_EQ(read().bytes.size(), kBlockBytes);
  EXPECT_EQ(account.missing, 0);
  EXPECT_EQ(account.received, 300);
}

TEST_F(Faults, ClientThatReopensAfterATimeoutMissesWhatIsInjected) {
  serve("shot 1 at 250 timeout\n", 1.0);
  control->write("fire", "1");
  while (read().error == 0) {
  }
  stream->leave();
  std::this_thread::sleep_for(5ms);
  open();
  read();
  EXPECT_GT(std::stol(injected()), 4000);
  EXPECT_EQ(lost(), account.missing);
}

TEST_F(Faults, HangSilencesEveryConnection) {
  serve("time 250us hang 300ms\n");
  read();
  read();
  const auto silence = std::chrono::steady_clock::now();
  stream->send("READBUF iio:device0 800\r\n");
  EXPECT_EQ(stream->line(50ms), "");
  EXPECT_EQ(control->attribute("seed"), "42");
  EXPECT_GE(std::chrono::steady_clock::now() - silence, 300ms);
  EXPECT_EQ(stream->line(), std::to_string(kBlockBytes));
  EXPECT_EQ(stream->line(), "00000007");
  BufferReply late;
  late.bytes = stream->receive(kBlockBytes);
  account.add(late.scans());
  for (int block = 0; block < 10; ++block) {
    read();
  }
  // 300 ms less the three blocks that the other buffers held.
  EXPECT_EQ(account.missing, 299'700);
  EXPECT_EQ(injected(), "299700");
}

TEST_F(Faults, HangWithoutEndLastsUntilTheServerStops) {
  serve("time 50us hang\n");
  stream->send("READBUF iio:device0 800\r\n");
  EXPECT_EQ(stream->line(50ms), "");
  control->send("PRINT\r\n");
  EXPECT_EQ(control->line(50ms), "");
  served->server.stop();
  EXPECT_TRUE(control->over());
}

TEST_F(Faults, DropClosesAllAndComesBack) {
  for (const double speed : {0.0, 1.0}) {
    account = {};
    serve("shot 1 at 250 drop 80ms\n", speed);
    control->write("fire", "1");
    const auto dropped = [&] {
      while (read().error == 0) {
      }
      return std::chrono::steady_clock::now();
    }();
    EXPECT_TRUE(stream->over());
    EXPECT_TRUE(control->over());
    EXPECT_TRUE(RawClient(*served).over());
    std::string answer;
    while (answer != "42" && std::chrono::steady_clock::now() - dropped < 2s) {
      std::this_thread::sleep_for(5ms);
      answer = RawClient(*served).attribute("seed");
    }
    EXPECT_GE(std::chrono::steady_clock::now() - dropped, 75ms);
    control = std::make_unique<RawClient>(*served);
    open();
    read();
    EXPECT_GE(std::stol(injected()), 79'000) << "at speed " << speed;
    EXPECT_EQ(lost(), account.missing) << "at speed " << speed;
  }
}

TEST_F(Faults, LossBehindADropIsCountedOnce) {
  serve("time 220us drop 1ms\ntime 250us lose 40\n");
  while (read().error == 0) {
  }
  std::string answer;
  while (answer != "42") {
    answer = RawClient(*served).attribute("seed");
  }
  control = std::make_unique<RawClient>(*served);
  open();
  read();
  EXPECT_EQ(account.missing, 1140);  // the dropped block with its 40, and 1 ms
  EXPECT_EQ(injected(), "1140");
}

TEST_F(Faults, ExtraChannelShowsInTheMask) {
  served = std::make_unique<ServedRamp>(ramp_settings(0.0, "time 250us extra-channel\n"));
  stream = std::make_unique<RawClient>(*served);
  ASSERT_EQ(stream->ask("OPEN iio:device0 100 00000005"), "0");
  std::uint32_t next = 0;
  std::size_t extra = 0;
  for (int block = 0; block < 6; ++block) {
    const BufferReply reply = read_buffer(*stream, kBlockBytes);
    // Asked for: 2 bytes, 2 of padding, 4 of counter. With voltage1 the padding is used.
    extra += reply.mask == "00000007" ? 1 : 0;
    EXPECT_TRUE(reply.mask == "00000007" || reply.mask == "00000005");
    for (const Scan& scan : reply.scans()) {
      EXPECT_EQ(scan.count, next++);
      EXPECT_EQ(scan.voltage[0], RampSource::ramp(0, scan.count));
      EXPECT_EQ(scan.voltage[1], reply.mask == "00000007" ? RampSource::ramp(1, scan.count) : 0);
    }
  }
  EXPECT_EQ(extra, 1U);
}

TEST_F(Faults, ExtraChannelThatTakesRoomLeavesTheRestForLater) {
  served = std::make_unique<ServedRamp>(ramp_settings(0.0, "time 50us extra-channel\n"));
  stream = std::make_unique<RawClient>(*served);
  ASSERT_EQ(stream->ask("OPEN iio:device0 100 00000002"), "0");
  const BufferReply wide = read_buffer(*stream, 2 * kBlock);
  EXPECT_EQ(wide.mask, "00000003");
  EXPECT_EQ(wide.bytes.size(), 2 * kBlock);  // 50 scans of two channels
  const BufferReply narrow = read_buffer(*stream, 2 * kBlock);
  std::int16_t first = 0;
  std::memcpy(&first, narrow.bytes.data(), 2);
  EXPECT_EQ(narrow.mask, "00000002");
  EXPECT_EQ(first, RampSource::ramp(1, 50));
}

TEST_F(Faults, OverflowRaisesTheFlagAlone) {
  serve("time 250us overflow\n");
  read();
  read();
  EXPECT_EQ(control->status(), 0U);
  read();
  read();
  EXPECT_EQ(control->status(), 4U);
  EXPECT_EQ(account.missing, 0);
  EXPECT_EQ(injected(), "0");
}

TEST_F(Faults, ClipHoldsTheUpperEnd) {
  serve("time 250us clip 70\n");
  for (std::uint32_t block = 0; block < 5; ++block) {
    for (const Scan& scan : read_buffer(*stream, kBlockBytes).scans()) {
      const bool clipped = scan.count >= 250 && scan.count < 320;
      ASSERT_EQ(scan.voltage[0], clipped ? 32767 : RampSource::ramp(0, scan.count));
      ASSERT_EQ(scan.voltage[1], clipped ? 32767 : RampSource::ramp(1, scan.count));
    }
  }
}

TEST_F(Faults, AFaultThatNobodyReadsIsTold) {
  std::vector<std::string> told;
  AdcSettings settings = ramp_settings(1.0, "time 1ms lose 10\n");
  settings.log = [&told](const std::string& text) { told.push_back(text); };
  served = std::make_unique<ServedRamp>(settings);
  control = std::make_unique<RawClient>(*served);
  std::this_thread::sleep_for(3ms);
  open();
  read();
  EXPECT_EQ(injected(), "0");
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0], "no fault: lose at sample 1000, which nobody read");
}

}  // namespace
}  // namespace kolsky::testing
