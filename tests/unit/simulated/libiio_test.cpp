// The stock client and its tools against the server, over real sockets.
#include <gtest/gtest.h>
#include <iio.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>

#include "tests/unit/simulated/served_ramp.hpp"

namespace kolsky::testing {
namespace {

struct ContextDeleter {
  void operator()(iio_context* context) const { iio_context_destroy(context); }
};
struct BufferDeleter {
  void operator()(iio_buffer* buffer) const { iio_buffer_destroy(buffer); }
};
using Context = std::unique_ptr<iio_context, ContextDeleter>;
using Buffer = std::unique_ptr<iio_buffer, BufferDeleter>;

Context connect(const ServedRamp& served) {
  std::array<char, 64> uri{};  // libiio writes into it
  std::snprintf(uri.data(), uri.size(), "%s", served.server.uri().c_str());
  return Context(iio_create_context_from_uri(uri.data()));
}

struct Output {
  int status = -1;
  std::string text;
};

Output run(const std::string& command) {
  Output output;
  FILE* pipe = popen(("timeout 20 " + command + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t got = fread(buffer, 1, sizeof buffer, pipe); got > 0;
       got = fread(buffer, 1, sizeof buffer, pipe)) {
    output.text.append(buffer, got);
  }
  output.status = pclose(pipe);
  return output;
}

TEST(StockTools, InfoShowsTheDevice) {
  ServedRamp served;
  const Output output = run("iio_info -u " + served.server.uri());
  EXPECT_EQ(output.status, 0);
  for (const char* part : {"IIO context has 1 devices", "iio:device0: kolsky-adc (buffer capable)",
                           "3 channels found", "voltage0:  (input, index: 0, format: le:S16/16>>0)",
                           "voltage1:  (input, index: 1, format: le:S16/16>>0)",
                           "count0:  (input, index: 2, format: le:U32/32>>0)", "label value: g2",
                           "scale value: 0.15", "sampling_frequency value: 1000000",
                           "scenario value: ramp <&\">", "debug attr  0: direct_reg_access"}) {
    EXPECT_NE(output.text.find(part), std::string::npos) << part << " is not in\n" << output.text;
  }
  EXPECT_EQ(output.text.find("ERROR"), std::string::npos) << output.text;
}

TEST(StockTools, AttrReadsAndWrites) {
  ServedRamp served;
  const std::string on = " -u " + served.server.uri() + " ";
  EXPECT_EQ(run("iio_attr" + on + "-d kolsky-adc sampling_frequency 500000").status, 0);
  EXPECT_EQ(run("iio_attr" + on + "-d kolsky-adc sampling_frequency").text, "500000\n");
  EXPECT_EQ(run("iio_attr" + on + "-c kolsky-adc voltage0 label").text, "g1\n");
  EXPECT_EQ(run("iio_attr" + on + "-d kolsky-adc fire 1").status, 0);
  EXPECT_EQ(run("iio_attr" + on + "-d kolsky-adc shots_fired").text, "1\n");
}

TEST(StockTools, ReaddevReadsWhatTheConverterGives) {
  ServedRamp served;
  const std::string on = " -u " + served.server.uri() + " ";
  const Output all = run("iio_readdev" + on + "-b 256 -s 5000 kolsky-adc");
  ASSERT_EQ(all.text.size(), 5000 * sizeof(Scan));
  std::vector<Scan> scans(5000);
  std::memcpy(scans.data(), all.text.data(), all.text.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    ASSERT_EQ(scans[i].count, scans[0].count + i);
    ASSERT_EQ(scans[i].voltage[0], RampSource::ramp(0, scans[i].count));
    ASSERT_EQ(scans[i].voltage[1], RampSource::ramp(1, scans[i].count));
  }
  EXPECT_EQ(run("iio_readdev" + on + "-b 256 -s 1000 kolsky-adc voltage1").text.size(), 2000U);
}

TEST(Libiio, ReadsFormatsScalesAndRegisters) {
  ServedRamp served(ramp_settings(0.0, "time 0s overflow\n"));
  const Context context = connect(served);
  ASSERT_NE(context, nullptr);
  iio_device* device = iio_context_find_device(context.get(), "kolsky-adc");
  ASSERT_NE(device, nullptr);
  iio_channel* voltage = iio_device_find_channel(device, "voltage1", false);
  ASSERT_NE(voltage, nullptr);
  double scale = 0.0;
  EXPECT_EQ(iio_channel_attr_read_double(voltage, "scale", &scale), 0);
  EXPECT_DOUBLE_EQ(scale, 0.15);
  EXPECT_EQ(iio_channel_get_type(iio_device_find_channel(device, "count0", false)), IIO_COUNT);
  EXPECT_EQ(iio_device_get_trigger(device, nullptr), -EINVAL);

  iio_channel_enable(voltage);
  const Buffer buffer(iio_device_create_buffer(device, 64, false));
  ASSERT_NE(buffer, nullptr);
  EXPECT_EQ(iio_buffer_refill(buffer.get()), 128);
  std::uint32_t status = 0;
  EXPECT_EQ(iio_device_reg_read(device, 0x80000088, &status), 0);
  EXPECT_EQ(status, 4U);
  EXPECT_EQ(iio_device_reg_write(device, 0x80000088, 6), 0);
  EXPECT_EQ(iio_device_reg_read(device, 0x80000088, &status), 0);
  EXPECT_EQ(status, 0U);
}

TEST(Libiio, SeesExtraChannelsInTheStepOfTheRefill) {
  ServedRamp served(ramp_settings(0.0, "time 70us extra-channel\n"));
  const Context context = connect(served);
  iio_device* device = iio_context_find_device(context.get(), "kolsky-adc");
  iio_channel_enable(iio_device_find_channel(device, "voltage1", false));
  const Buffer buffer(iio_device_create_buffer(device, 64, false));
  ASSERT_NE(buffer, nullptr);
  std::vector<std::int16_t> codes;
  std::vector<std::ptrdiff_t> steps;
  for (int block = 0; block < 5; ++block) {
    ASSERT_GT(iio_buffer_refill(buffer.get()), 0);
    const std::ptrdiff_t step = iio_buffer_step(buffer.get());
    steps.push_back(step);
    auto* first = static_cast<std::byte*>(
        iio_buffer_first(buffer.get(), iio_device_find_channel(device, "voltage1", false)));
    for (std::byte* at = first; at < iio_buffer_end(buffer.get()); at += step) {
      std::int16_t code = 0;
      std::memcpy(&code, at, sizeof code);
      codes.push_back(code);
    }
  }
  EXPECT_EQ(steps, (std::vector<std::ptrdiff_t>{2, 4, 2, 2, 2}));
  for (std::size_t i = 0; i < codes.size(); ++i) {
    ASSERT_EQ(codes[i], RampSource::ramp(1, static_cast<Tick>(i)));
  }
}

TEST(Libiio, RefusesASecondBufferAndFollowsKernelBufferCounts) {
  ServedRamp served;
  const Context one = connect(served);
  const Context two = connect(served);
  const auto open = [](const Context& context) {
    iio_device* device = iio_context_find_device(context.get(), "kolsky-adc");
    EXPECT_EQ(iio_device_set_kernel_buffers_count(device, 8), 0);
    iio_channel_enable(iio_device_find_channel(device, "voltage0", false));
    return Buffer(iio_device_create_buffer(device, 64, false));
  };
  const Buffer first = open(one);
  ASSERT_NE(first, nullptr);
  iio_device* device = iio_context_find_device(two.get(), "kolsky-adc");
  iio_channel_enable(iio_device_find_channel(device, "voltage0", false));
  errno = 0;
  EXPECT_EQ(Buffer(iio_device_create_buffer(device, 64, false)), nullptr);
  EXPECT_EQ(errno, EBUSY);
}

TEST(Libiio, SeesADropAsAnErrorAndComesBack) {
  std::signal(SIGPIPE, SIG_IGN);
  ServedRamp served(ramp_settings(0.0, "time 200us drop 50ms\n"));
  {
    const Context context = connect(served);
    iio_device* device = iio_context_find_device(context.get(), "kolsky-adc");
    iio_channel_enable(iio_device_find_channel(device, "voltage0", false));
    const Buffer buffer(iio_device_create_buffer(device, 64, false));
    ssize_t got = 0;
    while ((got = iio_buffer_refill(buffer.get())) > 0) {
    }
    EXPECT_LT(got, 0);
    EXPECT_EQ(connect(served), nullptr);
  }
  Context again;
  for (int i = 0; i < 200 && !again; ++i) {
    usleep(5000);
    again = connect(served);
  }
  EXPECT_NE(again, nullptr);
}

}  // namespace
}  // namespace kolsky::testing
