#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "drivers/digitiser/open.hpp"
#include "processing/base/error.hpp"
#include "tests/conformance/reading.hpp"
#include "tests/conformance/rig.hpp"
#include "tests/conformance/scripted_scans.hpp"
#include "tests/conformance/simulated_device.hpp"

namespace kolsky {
namespace {

using Clock = std::chrono::steady_clock;

void no_data(ScriptedClient&, std::size_t, int) {}

std::unique_ptr<Digitiser> open_at(const ScriptedIiod& server,
                                   const DigitiserOptions& options = pattern_options()) {
  return open_digitiser(server.uri(), options);
}

/// The error's line, which must name each of the parts; "" if there was none.
std::string refusal(const std::string& uri, const DigitiserOptions& options) {
  try {
    (void)open_digitiser(uri, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_parts(const std::string& line, const std::vector<std::string>& parts) {
  EXPECT_FALSE(line.empty());
  EXPECT_EQ(line.find('\n'), std::string::npos);
  for (const std::string& part : parts) {
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" is not in: " << line;
  }
}

struct BadUri {
  const char* uri;
  const char* says;
};

class BadUris : public testing::TestWithParam<BadUri> {};

TEST_P(BadUris, AreRefusedPromptlyInOneLine) {
  const auto begin = Clock::now();
  const std::string line = refusal(GetParam().uri, pattern_options());
  expect_parts(line, {GetParam().uri, GetParam().says});
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 6.0);
}

INSTANTIATE_TEST_SUITE_P(
    Uris, BadUris,
    testing::Values(
        BadUri{"", "is empty"}, BadUri{" ", "no scheme"}, BadUri{"127.0.0.1", "no scheme"},
        BadUri{":", "no scheme"}, BadUri{"ip:", "names no host"},
        BadUri{"ip::30431", "names no host"}, BadUri{"ip:host:99999", "99999"},
        BadUri{"ip:host:0", "no TCP port"}, BadUri{"ip:host:", "no TCP port"},
        BadUri{"ip:host:port", "no TCP port"}, BadUri{"ip:host:-1", "no TCP port"},
        BadUri{"ip:host:304311", "no TCP port"}, BadUri{"ip:a b", "no host name"},
        BadUri{"ip://127.0.0.1", "no host name"}, BadUri{"ip:127.0.0.1:1", "refused"},
        BadUri{"ip:nosuchhost.invalid", "no IIO device"},
        BadUri{"ip:nosuchhost.invalid:30431", "no IIO device"}, BadUri{"usb:", "no USB device"},
        BadUri{"usb:nonsense", "no USB device"}, BadUri{"usb:250.250.250", "no IIO device"},
        BadUri{"xml:", "no samples"}, BadUri{"xml:/nonexistent.xml", "no samples"},
        BadUri{"serial:/dev/null", "not known"}, BadUri{"http://127.0.0.1", "not known"},
        BadUri{"replay", "no scheme"}, BadUri{"Replay:x", "not known"},
        BadUri{"replay:", "names no capture"}, BadUri{"replay:/nonexistent", "/nonexistent"},
        BadUri{"replay:/dev/null", "/dev/null"}, BadUri{"replay:/", "no captures"}));

TEST(IioUri, LocalWithoutDevicesIsRefused) {
  const std::string line = refusal("local:", pattern_options());
  if (line.empty()) {
    GTEST_SKIP() << "this machine has an IIO digitiser";
  }
  expect_parts(line, {"local:"});
}

TEST(IioRate, IsSetAndReadBack) {
  ScriptedDevice device;
  device.texts["sampling_frequency"] = "250000";
  ScriptedIiod server(device, no_data);
  EXPECT_EQ(open_at(server)->info().rate, (SampleRate{1'000'000, 1}));
  const auto lines = server.lines();
  const std::string write = "WRITE iio:device0 sampling_frequency 8";  // "1000000" and its end
  EXPECT_NE(std::find(lines.begin(), lines.end(), write), lines.end());
}

TEST(IioRate, IsLeftAloneWhereItAgrees) {
  ScriptedDevice device;
  device.texts["sampling_frequency"] = "1000000.5";  // 5e-7 off
  ScriptedIiod server(device, no_data);
  EXPECT_EQ(open_at(server)->info().rate, (SampleRate{2'000'001, 2}));
  for (const std::string& line : server.lines()) {
    EXPECT_FALSE(line.starts_with("WRITE")) << line;
  }
}

TEST(IioRate, OfAChannelCounts) {
  ScriptedDevice device;
  device.device_attributes.clear();
  device.texts.erase("sampling_frequency");
  device.channels[0].attributes = {"scale", "sampling_frequency"};
  device.texts["voltage0/sampling_frequency"] = "500000";
  ScriptedIiod server(device, no_data);
  EXPECT_EQ(open_at(server)->info().rate, (SampleRate{1'000'000, 1}));
}

TEST(IioRate, IsTheDevicesOwnWhereNoneIsAsked) {
  ScriptedDevice device;
  device.texts["sampling_frequency"] = "250000";
  ScriptedIiod server(device, no_data);
  DigitiserOptions options = pattern_options();
  options.sampling_frequency_Hz = 0.0;
  EXPECT_EQ(open_at(server, options)->info().rate, (SampleRate{250'000, 1}));
}

TEST(IioRate, ThatDoesNotStickIsRefused) {
  for (const bool writable : {false, true}) {
    ScriptedDevice device;
    device.texts["sampling_frequency"] = "1000002";  // 2e-6 off
    device.texts["sampling_frequency_available"] = "1000002 500001";
    device.device_attributes.emplace_back("sampling_frequency_available");
    device.writable = writable;
    device.sticks = false;
    ScriptedIiod server(device, no_data);
    expect_parts(refusal(server.uri(), pattern_options()),
                 {server.uri(), "1000002 Hz", "1000000 Hz is asked", "1000002 500001"});
  }
}

TEST(IioRate, ThatNobodyKnowsIsRefused) {
  ScriptedDevice device;
  device.device_attributes.clear();
  ScriptedIiod server(device, no_data);
  EXPECT_EQ(open_at(server)->info().rate, (SampleRate{1'000'000, 1}));
  DigitiserOptions options = pattern_options();
  options.sampling_frequency_Hz = 0.0;
  expect_parts(refusal(server.uri(), options), {"sampling_frequency_Hz"});
}

TEST(IioRate, OfASlowDeviceKeepsBlocksShort) {
  ScriptedDevice device;
  device.texts["sampling_frequency"] = "1000";
  ScriptedIiod server(device, no_data);
  DigitiserOptions options = pattern_options();
  options.sampling_frequency_Hz = 1000.0;
  EXPECT_EQ(open_at(server, options)->info().max_block_samples, 200U);
}

TEST(IioRate, OfAnAcceleratedDeviceSetsBlocksAndQueueByTheWallClock) {
  ScriptedDevice device;
  device.device_attributes = {"sampling_frequency", "fire", "speed"};
  device.texts["fire"] = "0";
  device.texts["speed"] = "10";
  ScriptedIiod server(device, no_data);
  DigitiserOptions options = pattern_options();
  options.block_samples = 0;
  const auto digitiser = open_at(server, options);
  EXPECT_EQ(digitiser->info().speed, 10.0);
  // 10 MS/s: a millisecond is 10 000 samples, 0.2 s are 123 blocks of the next power of two.
  EXPECT_EQ(digitiser->info().max_block_samples, 16384U);
  digitiser->start();
  const std::vector<std::string> lines = server.lines();
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find("BUFFERS_COUNT 123") != std::string::npos;
  }));
}

TEST(IioRate, OfHardwareIsNotAcceleratedByAnAttributeOfItsOwn) {
  ScriptedDevice device;
  device.device_attributes = {"sampling_frequency", "speed"};
  device.texts["speed"] = "10";
  ScriptedIiod server(device, no_data);
  DigitiserOptions options = pattern_options();
  options.block_samples = 0;
  const auto digitiser = open_at(server, options);
  EXPECT_EQ(digitiser->info().speed, 1.0);
  EXPECT_EQ(digitiser->info().max_block_samples, 1024U);
}

TEST(IioChannels, AreChosenByIdOrLabelInTheOrderAsked) {
  SimulatedDevice device;
  DigitiserOptions options = pattern_options();
  options.channels = {"g2", "voltage0"};
  options.channel_count = 0;
  const auto digitiser = open_digitiser(device.uri(), options);
  ASSERT_EQ(digitiser->info().channels.size(), 2U);
  EXPECT_EQ(digitiser->info().channels[0].name, "voltage1");
  EXPECT_EQ(digitiser->info().channels[0].scale, Rig::kScale_V[1]);
  EXPECT_EQ(digitiser->info().channels[1].name, "voltage0");
  digitiser->start();
  Block block;
  ASSERT_TRUE(next_block(*digitiser, block));
  const Tick tick = pattern_tick(code_at(digitiser->info(), block, 1, 0));
  EXPECT_EQ(code_at(digitiser->info(), block, 0, 0), pattern_code(1, tick));
}

TEST(IioChannels, ThatCannotBeHadAreNamed) {
  SimulatedDevice device;
  DigitiserOptions options = pattern_options();
  options.channels = {"g1", "g3"};
  expect_parts(refusal(device.uri(), options), {device.uri(), "g3", "voltage0, voltage1"});
  options.channels = {"g1", "voltage0"};
  expect_parts(refusal(device.uri(), options), {"voltage0", "twice"});
  options.channels = {};
  options.channel_count = 3;
  expect_parts(refusal(device.uri(), options), {"kolsky-adc", "3 voltage inputs"});
  options.channel_count = 2;
  options.device = "ad7606c";
  expect_parts(refusal(device.uri(), options), {"ad7606c", "kolsky-adc (iio:device0)"});
  options.device = "kolsky-adc";
  EXPECT_EQ(refusal(device.uri(), options), "");
}

TEST(IioUnits, StrainComesFromTheStrainScale) {
  SimulatedDevice device;
  DigitiserOptions options = pattern_options();
  options.units = {"strain", "V"};
  const auto digitiser = open_digitiser(device.uri(), options);
  EXPECT_EQ(digitiser->info().channels[0].unit, "strain");
  EXPECT_EQ(digitiser->info().channels[0].scale, 1e-7);
  EXPECT_EQ(digitiser->info().channels[0].offset, Rig::kOffset[0]);
  EXPECT_EQ(digitiser->info().channels[1].unit, "V");
  EXPECT_EQ(digitiser->info().channels[1].scale, Rig::kScale_V[1]);
}

TEST(IioUnits, WhatADeviceCannotSayIsRefused) {
  ScriptedDevice device;
  device.channels[1].attributes.clear();
  ScriptedIiod server(device, no_data);
  DigitiserOptions options = pattern_options();
  expect_parts(refusal(server.uri(), options), {"voltage1", "no scale"});
  options.units = {"strain", "strain"};
  expect_parts(refusal(server.uri(), options), {"voltage0", "volts only", "bridge"});
  options.units = {"mV", "V"};
  expect_parts(refusal(server.uri(), options), {"mV", "\"strain\""});
}

TEST(IioUnits, ScaleThatIsNoNumberIsRefused) {
  for (const char* text : {"abc", "", "0.5 mV", "nan", "inf", "0"}) {
    ScriptedDevice device;
    device.texts["voltage0/scale"] = text;
    ScriptedIiod server(device, no_data);
    expect_parts(refusal(server.uri(), pattern_options()), {"voltage0", "scale"});
  }
}

TEST(IioFormats, ThatCannotBeReadAreRefused) {
  for (const char* format : {"le:s48/64>>0", "le:s16/16X2>>0", "le:s24/32>>16"}) {
    ScriptedDevice device;
    device.channels[0].format = format;
    ScriptedIiod server(device, no_data);
    expect_parts(refusal(server.uri(), pattern_options()), {"voltage0", "choose a channel"});
  }
}

TEST(IioFormats, WiderThanSixteenBitsMakeTheWholeStreamThirtyTwo) {
  AdcSettings settings = SimulatedDevice::pattern_settings();
  settings.bits = 24;
  SimulatedDevice device(settings);
  const auto digitiser = open_digitiser(device.uri(), pattern_options());
  EXPECT_EQ(digitiser->info().format, SampleFormat::int32);
  EXPECT_EQ(digitiser->info().channels[0].code_min, -8'388'608);
  EXPECT_EQ(digitiser->info().channels[0].code_max, 8'388'607);
  digitiser->start();
  Block block;
  ASSERT_TRUE(next_block(*digitiser, block));
  const Tick tick = pattern_tick(code_at(digitiser->info(), block, 0, 0));
  for (std::size_t i = 0; i < block.samples; ++i) {
    ASSERT_EQ(code_at(digitiser->info(), block, 1, i),
              pattern_code(1, tick + static_cast<Tick>(i)));
  }
}

TEST(IioFire, IsRefusedOnHardware) {
  ScriptedIiod server({}, no_data);
  const auto digitiser = open_at(server);
  EXPECT_FALSE(digitiser->info().simulated);
  try {
    digitiser->fire();
    FAIL() << "fired at hardware";
  } catch (const InputError& error) {
    expect_parts(error.what(), {server.uri(), "force-trigger"});
  }
}

TEST(IioReconnect, ShowsAnotherDeviceUnderTheSameNameByItsInfo) {
  AdcSettings settings = SimulatedDevice::pattern_settings();
  auto device = std::make_unique<SimulatedDevice>(settings);
  const std::string uri = device->uri();
  const auto digitiser = open_digitiser(uri, pattern_options());
  digitiser->start();
  device.reset();
  EXPECT_EQ(read_while(*digitiser, [](const Block&) { return true; }), ReadStatus::disconnected);
  settings.channels[0].scale_mV = 77.0;
  device = std::make_unique<SimulatedDevice>(settings, uri.substr(3));
  ASSERT_TRUE(comes_back(*digitiser));
  EXPECT_EQ(digitiser->info().channels[0].scale, 0.077);
}

}  // namespace
}  // namespace kolsky
