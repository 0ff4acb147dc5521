#include "clients/cli/reports/json_value.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "clients/cli/reports/time_text.hpp"

namespace kolsky::cli {
namespace {

TEST(Json, ReadsBackToTheSameBits) {
  std::mt19937_64 random(7);
  std::vector<double> numbers = {0.0, -0.0, 0.1, 1e-310, 5e-324, 1.7976931348623157e308, 1.0 / 3.0};
  while (numbers.size() < 20000) {
    const auto number = std::bit_cast<double>(random());
    if (std::isfinite(number)) {
      numbers.push_back(number);
    }
  }
  const auto parsed = nlohmann::json::parse(to_text(JsonObject{{"numbers", numbers}}));
  ASSERT_EQ(parsed["numbers"].size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(parsed["numbers"][i].get<double>()),
              std::bit_cast<std::uint64_t>(numbers[i]));
  }
}

TEST(Json, WritesShortNumbersShort) {
  EXPECT_EQ(to_text(std::vector<double>{0.1, 1e-6, 2.5}), "[0.1,1e-06,2.5]");
}

TEST(Json, HasNoNumbersThatJsonHasNot) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(to_text(JsonObject{{"a", nan}, {"b", std::vector<double>{infinity, -infinity, nan}}}),
            R"({"a":null,"b":[null,null,null]})");
}

TEST(Json, KeepsTheOrderAndEveryKindOfValue) {
  EXPECT_EQ(
      to_text(JsonObject{{"z", true},
                         {"y", nullptr},
                         {"x", std::int64_t{-3}},
                         {"w", std::uint64_t{18446744073709551615U}},
                         {"v", "a\"\\\n"},
                         {"u", JsonList{}},
                         {"t", JsonObject{}},
                         {"s", std::vector<std::string>{"p", "q"}}}),
      R"({"z":true,"y":null,"x":-3,"w":18446744073709551615,"v":"a\"\\\n","u":[],"t":{},"s":["p","q"]})");
}

TEST(Json, IsUtf8WhateverAFileIsCalled) {
  const std::string text = to_text(JsonObject{{"file", std::string("caf\xe9.h5")}});
  EXPECT_TRUE(nlohmann::json::accept(text)) << text;
}

TEST(TimeText, IsIso8601InUtc) {
  // date -u -d @1234567890.987654321
  EXPECT_EQ(iso_time(1234567890'987654321), "2009-02-13T23:31:30.987654Z");
  EXPECT_EQ(short_time(1234567890'987654321), "2009-02-13 23:31:30");
  EXPECT_EQ(iso_time(0), "1970-01-01T00:00:00.000000Z");
  EXPECT_EQ(iso_time(-1), "1969-12-31T23:59:59.999999Z");
}

}  // namespace
}  // namespace kolsky::cli
