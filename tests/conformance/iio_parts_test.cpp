// The parts of the iio driver that are plain computations.

#include <gtest/gtest.h>
#include <iio.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "drivers/iio/late_task.hpp"
#include "drivers/iio/loss_by_clock.hpp"
#include "drivers/iio/sample_counter.hpp"
#include "drivers/iio/scan_format.hpp"
#include "drivers/iio/stream_clock.hpp"

namespace kolsky {
namespace {

/// libiio's own conversion is the oracle: it yields the value sign-extended in the storage's size.
class LibiioChannel {
 public:
  explicit LibiioChannel(std::string format) {
    format.replace(format.find(">>"), 2, "&gt;&gt;");
    const std::string xml =
        R"(<?xml version="1.0"?><!DOCTYPE context [<!ELEMENT context ANY><!ELEMENT device ANY>)"
        R"(<!ELEMENT channel ANY><!ELEMENT scan-element EMPTY><!ATTLIST context name CDATA #IMPLIED>)"
        R"(<!ATTLIST device id CDATA #IMPLIED><!ATTLIST channel id CDATA #IMPLIED type CDATA #IMPLIED>)"
        R"(<!ATTLIST scan-element index CDATA #IMPLIED format CDATA #IMPLIED>]>)"
        R"(<context name="xml"><device id="iio:device0"><channel id="voltage0" type="input">)"
        R"(<scan-element index="0" format=")" +
        format + R"("/></channel></device></context>)";
    context_ = iio_create_xml_context_mem(xml.data(), xml.size());
    channel_ = iio_device_get_channel(iio_context_get_device(context_, 0), 0);
  }
  ~LibiioChannel() { iio_context_destroy(context_); }
  LibiioChannel(const LibiioChannel&) = delete;
  LibiioChannel& operator=(const LibiioChannel&) = delete;

  [[nodiscard]] std::int64_t value(const std::byte* raw, const ScanFormat& format) const {
    std::array<std::byte, 8> out{};
    iio_channel_convert(channel_, out.data(), raw);
    std::uint64_t word = 0;
    std::memcpy(&word, out.data(), format.storage_bytes);  // little-endian hosts
    const unsigned int unused = 64 - 8 * format.storage_bytes;
    return format.is_signed ? static_cast<std::int64_t>(word << unused) >> unused
                            : static_cast<std::int64_t>(word);
  }

 private:
  iio_context* context_;
  iio_channel* channel_;
};

std::string format_text(const ScanFormat& format) {
  return std::string(format.big_endian ? "be:" : "le:") + (format.is_signed ? "s" : "u") +
         std::to_string(format.bits) + "/" + std::to_string(8 * format.storage_bytes) + ">>" +
         std::to_string(format.shift);
}

std::vector<ScanFormat> many_formats() {
  std::vector<ScanFormat> formats;
  for (const unsigned int bytes : {1U, 2U, 4U, 8U}) {
    for (const unsigned int bits : {1U, 7U, 8U, 12U, 15U, 16U, 18U, 24U, 31U, 32U}) {
      for (const unsigned int shift : {0U, 1U, 4U, 8U, 16U, 32U}) {
        for (const bool is_signed : {false, true}) {
          for (const bool big_endian : {false, true}) {
            const ScanFormat format{bytes, bits, shift, is_signed, big_endian};
            if (format.valid()) {
              formats.push_back(format);
            }
          }
        }
      }
    }
  }
  return formats;
}

TEST(ScanDecoder, AgreesWithLibiioOnEveryFormat) {
  std::mt19937_64 random(7);
  for (const ScanFormat& format : many_formats()) {
    const LibiioChannel oracle(format_text(format));
    constexpr std::size_t kSamples = 64;
    constexpr std::size_t kStride = 16;
    std::array<std::byte, kSamples * kStride> scans{};
    for (std::byte& byte : scans) {
      byte = static_cast<std::byte>(random());
    }
    const bool narrow = format.code_min() >= INT16_MIN && format.code_max() <= INT16_MAX;
    for (const SampleFormat to : {SampleFormat::int16, SampleFormat::int32}) {
      if (to == SampleFormat::int16 && !narrow) {
        continue;
      }
      alignas(4) std::array<std::byte, kSamples * 4> out{};
      ScanDecoder(format, to).decode(scans.data() + 3, kStride, kSamples, out.data());
      for (std::size_t i = 0; i < kSamples; ++i) {
        std::int32_t code = 0;
        if (to == SampleFormat::int16) {
          std::int16_t small = 0;
          std::memcpy(&small, out.data() + 2 * i, 2);
          code = small;
        } else {
          std::memcpy(&code, out.data() + 4 * i, 4);
        }
        const std::int64_t expected = oracle.value(scans.data() + 3 + kStride * i, format);
        ASSERT_EQ(code + format.bias(), expected) << format_text(format);
        ASSERT_GE(code, format.code_min());
        ASSERT_LE(code, format.code_max());
      }
    }
  }
}

TEST(ScanFormat, UnsignedCodesOfFullWidthAreDeliveredHalfARangeLower) {
  const ScanFormat format{2, 16, 0, false, false};
  EXPECT_EQ(format.bias(), 32768);
  EXPECT_EQ(format.code_min(), -32768);
  EXPECT_EQ(format.code_max(), 32767);
  EXPECT_EQ((ScanFormat{2, 15, 0, false, false}.code_max()), 32767);
  EXPECT_EQ((ScanFormat{4, 24, 0, false, false}.code_max()), 16'777'215);
  EXPECT_EQ((ScanFormat{4, 32, 0, false, false}.code_max()), 2'147'483'647);
  EXPECT_EQ((ScanFormat{4, 24, 8, true, false}.code_min()), -8'388'608);
}

TEST(ScanFormat, WhatDoesNotFitItsStorageIsNotValid) {
  EXPECT_FALSE((ScanFormat{2, 16, 1, true, false}.valid()));
  EXPECT_FALSE((ScanFormat{3, 24, 0, true, false}.valid()));
  EXPECT_FALSE((ScanFormat{2, 0, 0, true, false}.valid()));
}

/// Numbers of 16 bits, as a device would put them.
std::vector<std::byte> numbers(std::initializer_list<unsigned int> values) {
  std::vector<std::byte> bytes;
  for (const unsigned int value : values) {
    bytes.push_back(static_cast<std::byte>(value & 0xff));
    bytes.push_back(static_cast<std::byte>(value >> 8));
  }
  return bytes;
}

TEST(SampleCounter, CountsModuloItsWidth) {
  SampleCounter counter({2, 16, 0, false, false});
  const auto values = numbers({65534, 65535, 0, 1, 5, 6});
  EXPECT_EQ(counter.missing_before(values.data(), 0), 0);
  EXPECT_EQ(counter.run_length(values.data(), 2, 6), 4U);
  counter.note(values.data() + 6);
  EXPECT_EQ(counter.missing_before(values.data() + 8, 10), 3);
  EXPECT_EQ(counter.missing_before(values.data() + 8, 3), 3);
  EXPECT_EQ(counter.missing_before(values.data() + 8, 2), std::nullopt) << "more than is possible";
  EXPECT_EQ(counter.missing_before(values.data() + 8, 65'536), std::nullopt)
      << "may have gone round";
}

TEST(SampleCounter, FindsTheEndOfARunWhereverItIs) {
  const SampleCounter counter({2, 16, 0, false, false});
  for (std::size_t hole = 1; hole < 40; ++hole) {
    std::vector<std::byte> bytes;
    for (unsigned int i = 0; i < 40; ++i) {
      const auto one = numbers({i < hole ? i : i + 9});
      bytes.insert(bytes.end(), one.begin(), one.end());
    }
    EXPECT_EQ(counter.run_length(bytes.data(), 2, 40), hole);
  }
}

TEST(StreamClock, AllowsNoMoreTicksThanTimeHasPassed) {
  const StreamClock clock(0, 1e6);
  EXPECT_EQ(clock.possible_ticks(0), 2'000'000);
  EXPECT_NEAR(static_cast<double>(clock.possible_ticks(3'600'000'000'000)), 3605.6e6, 1.0);
}

TEST(StreamClock, GrantsAnAcceleratedSourceTheSpeedItShowed) {
  StreamClock clock(0, 1e6);
  clock.note(50'000'000, 500'000'000);  // 100 times too fast
  EXPECT_GE(clock.possible_ticks(1'000'000'000), 100'000'000);
}

/// Feeds blocks of a 1 MHz stream with whatever delay, and says when losses were reported, in
/// seconds.
class ClockTrial {
 public:
  /// @param true_rate  of the device, beside the 1 MHz it states
  explicit ClockTrial(double true_rate_Hz = 1e6) : true_rate_Hz_(true_rate_Hz) {}

  void run(double until_s, double extra_delay_s = 0.0) {
    while (time_s_ < until_s) {
      taken_ += kBlock;
      time_s_ = (taken_ + lost_) / true_rate_Hz_;
      const double jitter_s = 3e-3 * std::generate_canonical<double, 32>(random_);
      const double now_s = std::max(last_s_, time_s_ + jitter_s + extra_delay_s);
      last_s_ = now_s;
      if (loss_.note(kBlock, static_cast<std::int64_t>(now_s * 1e9) + 77'000'000'000)) {
        reported_s_.push_back(now_s);
      }
    }
  }
  void lose(double samples) { lost_ += samples; }

  [[nodiscard]] const std::vector<double>& reported_s() const { return reported_s_; }

 private:
  static constexpr std::size_t kBlock = 1000;
  LossByClock loss_{1e6, kBlock};
  std::mt19937_64 random_{11};
  double true_rate_Hz_;
  double taken_ = 0.0;
  double lost_ = 0.0;
  double time_s_ = 0.0;
  double last_s_ = 0.0;
  std::vector<double> reported_s_;
};

TEST(LossByClock, SeesALossWithinThreeSeconds) {
  for (const double samples : {12e3, 100e3, 5e6}) {
    ClockTrial trial;
    trial.run(10.0);
    trial.lose(samples);
    trial.run(25.0);
    ASSERT_EQ(trial.reported_s().size(), 1U) << samples;
    EXPECT_GT(trial.reported_s()[0], 10.0 + samples / 1e6);
    EXPECT_LT(trial.reported_s()[0], 13.0 + samples / 1e6);
  }
}

TEST(LossByClock, IsNotFooledByJitterNorByClocksThatDiffer) {
  for (const double ppm : {-150.0, 0.0, 150.0}) {
    ClockTrial trial(1e6 * (1 + ppm * 1e-6));
    trial.run(600.0);
    EXPECT_TRUE(trial.reported_s().empty()) << ppm;
  }
}

TEST(LossByClock, IsNotFooledByALateStretchThatCatchesUp) {
  ClockTrial trial;
  trial.run(10.0);
  trial.run(10.4, 0.3);
  trial.run(30.0);
  EXPECT_TRUE(trial.reported_s().empty());
}

TEST(LossByClock, AddsUpLossesThatAreEachTooSmall) {
  ClockTrial trial;
  trial.run(5.0);
  for (int i = 0; i < 20; ++i) {
    trial.lose(2000);
    trial.run(6.0 + i);
  }
  EXPECT_GE(trial.reported_s().size(), 4U);
}

/// Takes its time to close, as a session that still holds the device's only buffer does.
class SlowToClose {
 public:
  explicit SlowToClose(std::atomic<bool>& closed) : closed_(closed) {}
  ~SlowToClose() {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    closed_ = true;
  }
  SlowToClose(const SlowToClose&) = delete;
  SlowToClose& operator=(const SlowToClose&) = delete;

 private:
  std::atomic<bool>& closed_;
};

TEST(LateTask, LetsGoOfWhatItOwnedBeforeItIsKnownToHaveEnded) {
  const auto never = [] { return false; };
  for (const bool fails : {false, true}) {
    std::atomic<bool> closed = false;
    const auto task = [&](std::shared_ptr<SlowToClose> session) -> std::function<bool()> {
      return [session = std::move(session), fails] {
        if (fails) {
          throw InputError("ip:bench", "does not stream", "try again");
        }
        return true;
      };
    };
    try {
      EXPECT_TRUE(run_within<bool>(std::chrono::seconds(5),
                                   task(std::make_shared<SlowToClose>(closed)), never)
                      .value_or(false));
    } catch (const InputError&) {
      EXPECT_TRUE(fails);
    }
    EXPECT_TRUE(closed) << (fails ? "failed" : "done");
  }
}

}  // namespace
}  // namespace kolsky
