#include <limits>
#include <random>

#include "drivers/files/captures/shot_codec.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::expect_refused;
using testing::expect_same;
using testing::make_shot;

std::vector<std::byte> encoded(const Shot& shot) {
  std::vector<std::byte> bytes;
  encode_shot(shot, bytes);
  return bytes;
}

TEST(Codec, GivesEveryFieldBack) {
  for (const int bits : {8, 16, 18, 24, 32}) {
    const Shot shot = make_shot(1, {3, 257, bits});
    expect_same(decode_shot(encoded(shot), "shot"), shot);
  }
}

TEST(Codec, GivesBackWhatIsOptionalAndEmpty) {
  Shot shot = make_shot(2);
  shot.bar_model.reset();
  shot.trigger.reset();
  shot.gaps.clear();
  shot.meta.clear();
  shot.software_version.clear();
  expect_same(decode_shot(encoded(shot), "shot"), shot);
}

TEST(Codec, KeepsWhereABarModelHolds) {
  Shot shot = make_shot(2);
  shot.bar_model->covariance = {4.0, 1.0, 0.0, 1.0, 9.0, -2.0, 0.0, -2.0, 16.0};
  expect_same(decode_shot(encoded(shot), "shot"), shot);
  shot.bar_model->identified = Material::Identified{6000.0 / 7.0, std::nullopt};
  expect_same(decode_shot(encoded(shot), "shot"), shot);
  shot.bar_model->covariance.reset();
  shot.bar_model->identified = Material::Identified{std::nullopt, 250.0};
  expect_same(decode_shot(encoded(shot), "shot"), shot);
  shot.bar_model->covariance = {4.0, 7.0, 0.0, 7.0, 9.0, -2.0, 0.0, -2.0, 16.0};
  EXPECT_THROW(check_storable(shot), InputError) << "a correlation above 1";
}

TEST(Codec, KeepsABarOfAnotherFamilyOfSolids) {
  for (Shot shot : {make_shot(2), testing::asked_shot()}) {
    shot.bar_model = testing::two_kelvin_bar();
    expect_same(decode_shot(encoded(shot), "shot"), shot);
    shot.bar_model->covariance.reset();
    shot.bar_model->identified.reset();
    expect_same(decode_shot(encoded(shot), "shot"), shot);
    shot.bar_model->parameters.pop_back();
    expect_refused([&] { check_storable(shot); }, {"bar_model: solid"});
  }
}

TEST(Codec, KeepsHowAShotIsToBeReduced) {
  for (const Shot& before : {make_shot(2), testing::asked_shot()}) {
    Shot shot = before;
    shot.bar_model.reset();
    expect_same(decode_shot(encoded(shot), "shot"), shot);
    shot.bar_model = before.bar_model;
    shot.bar_model->identified = Material::Identified{6000.0 / 7.0, std::nullopt};
    expect_same(decode_shot(encoded(shot), "shot"), shot);
  }
  Shot infinite = testing::asked_shot();
  infinite.reduction.duration_s = std::numeric_limits<double>::infinity();
  expect_refused([&] { check_storable(infinite); }, {"reduction.duration_s"});
}

TEST(Codec, KeepsCodesThatLeaveTheRangeOfTheirBits) {
  Shot shot = make_shot(3);
  shot.channels[1].codes[5] = 65535;
  expect_same(decode_shot(encoded(shot), "shot"), shot);
}

TEST(Codec, NeedsTwoBytesASampleUpTo16Bits) {
  const std::size_t one = encoded(make_shot(4, {2, 1000, 16})).size();
  const std::size_t two = encoded(make_shot(4, {2, 2000, 16})).size();
  EXPECT_EQ(two - one, 2 * 1000 * 2);
}

TEST(Codec, BeginsWithTheMetadata) {
  const Shot shot = make_shot(5);
  const auto metadata = encode_metadata(shot);
  const auto whole = encoded(shot);
  ASSERT_EQ(whole.size(), metadata.size() + 2000);
  EXPECT_TRUE(std::equal(metadata.begin(), metadata.end(), whole.begin()));
}

TEST(Codec, RefusesEveryCut) {
  const auto bytes = encoded(make_shot(6, {2, 20}));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    expect_refused([&] { (void)decode_shot(std::span(bytes).first(length), "record 7"); },
                   {"record 7"});
  }
}

TEST(Codec, RefusesWhatIsLeftOver) {
  auto bytes = encoded(make_shot(7));
  bytes.push_back(std::byte{0});
  expect_refused([&] { (void)decode_shot(bytes, "shot"); }, {"1 bytes are left over"});
}

TEST(Codec, RefusesALaterFormat) {
  auto bytes = encoded(make_shot(8));
  bytes[0] = std::byte{5};
  expect_refused([&] { (void)decode_shot(bytes, "shot"); }, {"format 5", "1 to 4"});
}

// Any change gives another shot or a refusal, never a crash or room for what is not there.
TEST(Codec, SurvivesAnyByte) {
  const auto bytes = encoded(make_shot(9, {2, 4}));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const int value : {0x00, 0x7f, 0x80, 0xff}) {
      auto changed = bytes;
      changed[i] = static_cast<std::byte>(value);
      if (changed == bytes) {
        continue;
      }
      try {
        EXPECT_EQ(encoded(decode_shot(changed, "shot")), changed) << "at byte " << i;
      } catch (const InputError&) {
      }
    }
  }
}

struct Unstorable {
  const char* place;
  void (*spoil)(Shot&);
  friend void PrintTo(const Unstorable& tested, std::ostream* out) { *out << tested.place; }
};

class UnstorableShot : public ::testing::TestWithParam<Unstorable> {};

TEST_P(UnstorableShot, IsRefused) {
  Shot shot = make_shot(10);
  ASSERT_NO_THROW(check_storable(shot));
  GetParam().spoil(shot);
  expect_refused([&] { check_storable(shot); }, {GetParam().place});
}

INSTANTIATE_TEST_SUITE_P(
    Codec, UnstorableShot,
    ::testing::Values(
        Unstorable{"id", [](Shot& s) { s.id = "../escape"; }},
        Unstorable{"id", [](Shot& s) { s.id = ""; }},
        Unstorable{"id", [](Shot& s) { s.id = ".h"; }},
        Unstorable{"id", [](Shot& s) { s.id = "a\nb"; }},
        Unstorable{"id", [](Shot& s) { s.id.assign(201, 'x'); }},
        Unstorable{"rate",
                   [](Shot& s) {
                     s.rate = {0, 1};
                   }},
        Unstorable{"rate",
                   [](Shot& s) {
                     s.rate = {1, 0};
                   }},
        Unstorable{"first_tick", [](Shot& s) { s.first_tick = INT64_MIN; }},
        Unstorable{"trigger.fraction", [](Shot& s) { s.trigger->fraction = 1.0; }},
        Unstorable{"trigger.fraction", [](Shot& s) { s.trigger->fraction = NAN; }},
        Unstorable{"trigger.sigma_samples", [](Shot& s) { s.trigger->sigma_samples = -1.0; }},
        Unstorable{"gaps", [](Shot& s) { s.gaps[0].samples = -1; }},
        Unstorable{"meta.specimen", [](Shot& s) { s.meta["specimen"] = std::string("a\0b", 3); }},
        Unstorable{"bar_model: E1_Pa", [](Shot& s) { s.bar_model->E1_Pa().value = NAN; }},
        Unstorable{"channels", [](Shot& s) { s.channels.clear(); }},
        Unstorable{"channels[1].codes", [](Shot& s) { s.channels[1].codes.pop_back(); }},
        Unstorable{"channels[0].scale", [](Shot& s) { s.channels[0].scale = 0.0; }},
        Unstorable{"channels[1].offset", [](Shot& s) { s.channels[1].offset = INFINITY; }},
        Unstorable{"channels[1].bits", [](Shot& s) { s.channels[1].bits = 33; }},
        Unstorable{"channels[1].code_min", [](Shot& s) { s.channels[1].code_min = 32767; }}));

TEST(Codec, ABenchMustNameTheChannels) {
  Shot shot = make_shot(11);
  attach_bench(shot, "here");
  EXPECT_EQ(shot.bench.gauges.size(), 2U);
  shot.channels[1].gauge = "g3";
  expect_refused([&] { attach_bench(shot, "here"); }, {"here", "gauges[1].name", "g3"});
  shot.channels.pop_back();
  expect_refused([&] { attach_bench(shot, "here"); }, {"2 gauges for 1"});
  shot.bench_toml = "kind = 3";
  expect_refused([&] { attach_bench(shot, "here"); }, {"here"});
}

}  // namespace
}  // namespace kolsky
