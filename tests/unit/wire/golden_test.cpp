#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "kolsky/v1/kolsky.pb.h"
#include "proto/codec.hpp"
#include "tests/unit/wire/golden_messages.hpp"

namespace kolsky {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

const std::filesystem::path kGolden = std::filesystem::path(KOLSKY_SOURCE_DIR) / "proto/golden";

std::string golden_bytes(const std::string& name) {
  std::ifstream file(kGolden / (name + ".bin"), std::ios::binary);
  EXPECT_TRUE(file) << name << ": no fixture; run make_golden after adding one";
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> recorded_schema() {
  std::ifstream file(kGolden / "schema.txt");
  std::set<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.insert(line);
  }
  return lines;
}

void collect_fields(const Message& message, std::set<std::string>& seen) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    seen.insert(field->full_name());
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
      continue;
    }
    const auto& reflection = *message.GetReflection();
    if (!field->is_repeated()) {
      collect_fields(reflection.GetMessage(message, field), seen);
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      collect_fields(reflection.GetRepeatedMessage(message, field, i), seen);
    }
  }
}

TEST(Golden, OldBytesReadAsWhatTheyMeant) {
  for (const golden::Fixture& fixture : golden::fixtures()) {
    const std::unique_ptr<Message> read(fixture.message->New());
    ASSERT_TRUE(read->ParseFromString(golden_bytes(fixture.name))) << fixture.name;
    std::string difference;
    google::protobuf::util::MessageDifferencer differencer;
    differencer.ReportDifferencesToString(&difference);
    EXPECT_TRUE(differencer.Compare(*fixture.message, *read)) << fixture.name << ": " << difference;
  }
}

TEST(Golden, TheSameMessagesStillGoOutAsTheSameBytes) {
  for (const golden::Fixture& fixture : golden::fixtures()) {
    EXPECT_EQ(golden::deterministic_bytes(*fixture.message), golden_bytes(fixture.name))
        << fixture.name;
  }
}

// By the encoding rules of protobuf, byte by byte and without it.
TEST(Golden, EnvelopeIsWhatItsDefinitionSays) {
  const std::string expected(
      "\x08\x01"                              // 1, varint: schema_version 1
      "\x11\x08\x07\x06\x05\x04\x03\x02\x01"  // 2, fixed64: boot_id, little endian
      "\x18\xac\x02"                          // 3, varint: sequence 300
      "\x20\x01"                              // 4, varint: utc_ns 1
      "\x28\x02",                             // 5, varint: monotonic_ns 2
      18);
  EXPECT_EQ(golden_bytes("envelope"), expected);
}

TEST(Golden, OldShotDecodesToItsSamples) {
  v1::Shot message;
  ASSERT_TRUE(message.ParseFromString(golden_bytes("shot")));
  const Shot shot = wire::decode(message);
  EXPECT_EQ(shot.id, "20240102T030405.678901-1");
  EXPECT_EQ(shot.rate, (SampleRate{1'000'000, 3}));
  ASSERT_EQ(shot.channels.size(), 2U);
  EXPECT_EQ(shot.channels[0].codes, (std::vector<std::int32_t>{1, -2}));
  EXPECT_EQ(shot.channels[1].codes, (std::vector<std::int32_t>{65536, -1}));
  EXPECT_EQ(shot.channels[0].value(1), -0.25);
  EXPECT_EQ(shot.trigger, (TriggerEvent{1'000'000'000'001, 0.25, 0.125, TriggerKind::incident}));
  EXPECT_EQ(shot.meta.at("striker_speed_m_per_s"), "9.5");
}

TEST(Golden, OldResultDecodesToItsHistories) {
  v1::Result message;
  ASSERT_TRUE(message.ParseFromString(golden_bytes("result")));
  const Reduction reduction = wire::decode(message);
  EXPECT_EQ(reduction.time_s, (std::vector<double>{1.0, -2.0}));
  EXPECT_EQ(reduction.transmitted, (std::vector<double>{1.0, -2.0}));
  EXPECT_EQ(reduction.band_limit_Hz, 30'000.0);
  ASSERT_EQ(reduction.quality.checks.size(), 1U);
  EXPECT_EQ(reduction.quality.checks[0].verdict, Verdict::warn);
}

TEST(Schema, NothingRecordedHasChanged) {
  const std::vector<std::string> now = golden::schema_lines();
  const std::set<std::string> recorded = recorded_schema();
  ASSERT_FALSE(recorded.empty());
  for (const std::string& line : recorded) {
    EXPECT_TRUE(std::ranges::binary_search(now, line))
        << "version 1 has \"" << line
        << "\" and the schema no longer does: programs in use would misread each other";
  }
}

TEST(Schema, EveryAdditionIsRecorded) {
  const std::set<std::string> recorded = recorded_schema();
  for (const std::string& line : golden::schema_lines()) {
    EXPECT_TRUE(recorded.contains(line)) << "\"" << line << "\" is new: run make_golden";
  }
}

TEST(Schema, FixturesHaveEveryField) {
  std::set<std::string> seen;
  for (const golden::Fixture& fixture : golden::fixtures()) {
    collect_fields(*fixture.message, seen);
  }
  for (const std::string& line : golden::schema_lines()) {
    if (line.starts_with("field ")) {
      const std::string name = line.substr(6, line.find(' ', 6) - 6);
      EXPECT_TRUE(seen.contains(name)) << name << " is in no fixture: add one that has it";
    }
  }
}

}  // namespace
}  // namespace kolsky
