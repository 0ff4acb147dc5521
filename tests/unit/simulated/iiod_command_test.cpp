#include "drivers/simulated/iiod_command.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <random>

namespace kolsky {
namespace {

IiodCommand parsed(const std::string& line) {
  const ParsedLine result = parse_iiod_line(line);
  EXPECT_EQ(result.error, 0) << line;
  return result.command;
}

TEST(IiodCommand, ReadsWhatLibiioSends) {
  EXPECT_EQ(parsed("PRINT").verb, IiodVerb::print);
  EXPECT_EQ(parsed("TIMEOUT 2500").number, 2500U);

  const IiodCommand open = parsed("OPEN iio:device0 64 00000007");
  EXPECT_EQ(open.verb, IiodVerb::open);
  EXPECT_EQ(open.device, "iio:device0");
  EXPECT_EQ(open.number, 64U);
  EXPECT_EQ(open.mask, std::vector<std::uint32_t>{7});
  EXPECT_FALSE(open.cyclic);
  EXPECT_TRUE(parsed("OPEN iio:device0 64 00000007 CYCLIC").cyclic);

  const IiodCommand channel = parsed("READ iio:device0 INPUT voltage1 scale");
  EXPECT_EQ(channel.verb, IiodVerb::read);
  EXPECT_EQ(channel.scope, AttributeScope::input_channel);
  EXPECT_EQ(channel.channel, "voltage1");
  EXPECT_EQ(channel.attribute, "scale");
  EXPECT_EQ(parsed("READ iio:device0 DEBUG direct_reg_access").scope, AttributeScope::debug);
  EXPECT_EQ(parsed("READ iio:device0 BUFFER watermark").scope, AttributeScope::buffer);
  EXPECT_EQ(parsed("READ iio:device0 fire").scope, AttributeScope::device);

  const IiodCommand write = parsed("WRITE iio:device0 fire 2");
  EXPECT_EQ(write.verb, IiodVerb::write);
  EXPECT_EQ(write.attribute, "fire");
  EXPECT_EQ(write.number, 2U);
  EXPECT_EQ(parsed("WRITE iio:device0 DEBUG direct_reg_access 11").number, 11U);

  EXPECT_EQ(parsed("READBUF iio:device0 512").number, 512U);
  EXPECT_EQ(parsed("SET iio:device0 BUFFERS_COUNT 8").number, 8U);
  EXPECT_EQ(parsed("GETTRIG iio:device0").verb, IiodVerb::get_trigger);
  EXPECT_EQ(parsed("CLOSE iio:device0").verb, IiodVerb::close);
  EXPECT_EQ(parsed("EXIT").verb, IiodVerb::exit);
}

TEST(IiodCommand, FirstMaskWordOnTheWireIsTheHighest) {
  EXPECT_EQ(parsed("OPEN d 1 00000001ffffffff").mask, (std::vector<std::uint32_t>{0xffffffff, 1}));
}

TEST(IiodCommand, RefusesWhatIsNotOne) {
  for (const char* line : {"",
                           " ",
                           "print",
                           "PRINT now",
                           "ZPRINT",
                           "TIMEOUT",
                           "TIMEOUT x",
                           "TIMEOUT -1",
                           "TIMEOUT 99999999999999999999",
                           "TIMEOUT 2147483648",
                           "OPEN",
                           "OPEN d",
                           "OPEN d 1",
                           "OPEN d 1 7",
                           "OPEN d 1 0000000g",
                           "OPEN d 1 -0000001",
                           "OPEN d 1 00000007 cyclic",
                           "OPEN d 1 00000007 CYCLIC x",
                           "OPEN d 1.5 00000007",
                           "READBUF d",
                           "READBUF d 1 2",
                           "READBUF d 0x10",
                           "WRITE d fire",
                           "WRITE d fire x",
                           "READ d",
                           "READ d INPUT voltage0",
                           "READ d SIDEWAYS voltage0 raw",
                           "READ d INPUT a b c",
                           "SET d",
                           "SET d BUFFERS_COUNT",
                           "SET d COUNT 4",
                           "CLOSE",
                           "CLOSE a b",
                           "GETTRIG",
                           "\x01\x02\xff"}) {
    EXPECT_EQ(parse_iiod_line(line).error, -EINVAL) << line;
  }
  EXPECT_EQ(parse_iiod_line("OPEN d 1 " + std::string(72, '0')).error, -EINVAL);
}

TEST(IiodCommand, TakesAnyBytes) {
  std::mt19937 random(1);
  const std::string words[] = {"OPEN ", "READ ", "WRITE ", "READBUF ", "INPUT ", "d ", "1 ", "ff"};
  for (int i = 0; i < 20000; ++i) {
    std::string line;
    while (random() % 6 != 0) {
      line += random() % 2 != 0 ? words[random() % 8] : std::string(1, static_cast<char>(random()));
    }
    const int error = parse_iiod_line(line).error;
    ASSERT_TRUE(error == 0 || error == -EINVAL);
  }
}

}  // namespace
}  // namespace kolsky
