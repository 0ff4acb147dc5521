#include "proto/codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <random>

#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/text.hpp"
#include "tests/unit/wire/golden_messages.hpp"
#include "tests/unit/wire/samples.hpp"

namespace kolsky {
namespace {

v1::Shot over_the_wire(const v1::Shot& message) {
  v1::Shot received;
  wire::parse(wire::serialise(message), "test", received);
  return received;
}

v1::Shot encoded(const Shot& shot) {
  v1::Shot message;
  wire::encode(shot, "store/shots/1.h5", message);
  return message;
}

v1::Result encoded(const Reduction& reduction) {
  v1::Result message;
  wire::encode(reduction, "shot-1", message);
  return message;
}

void expect_same(const Material& a, const Material& b) {
  const auto same = [](const Measured& x, const Measured& y) {
    return x.value == y.value && x.sd == y.sd;
  };
  EXPECT_TRUE(same(a.density_kg_m3, b.density_kg_m3));
  EXPECT_TRUE(same(a.poisson_ratio, b.poisson_ratio));
  EXPECT_EQ(a.solid, b.solid);
  EXPECT_TRUE(std::ranges::equal(a.parameters, b.parameters, same));
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.identified, b.identified);
}

TEST(BallCodec, ComesBackExact) {
  Reduction reduction;
  reduction.quality.reducible = true;
  BallImpact& ball = reduction.ball.emplace();
  ball.time_s = {1e-7, 1.1e-6};
  ball.force_N = {-0.0, std::numeric_limits<double>::denorm_min()};
  ball.peak_force_N = {9444.1, 12.5};
  ball.contact_over = true;
  ball.contact_threshold = 0.02;
  ball.restitution_by_speed = Measured{0.829, 0.001};
  ball.speed_source = "meta";
  ball.stations = {{"g1+g2", 0.25, 0.75, 49e-6, 1137e-6, 65.0, 2.5}};
  const Reduction back = wire::decode(encoded(reduction));
  ASSERT_TRUE(back.ball);
  EXPECT_EQ(back.ball->time_s, ball.time_s);
  EXPECT_EQ(bits_of(back.ball->force_N), bits_of(ball.force_N));
  EXPECT_EQ(back.ball->peak_force_N.sd, 12.5);
  EXPECT_EQ(back.ball->contact_threshold, 0.02);
  EXPECT_EQ(back.ball->restitution_by_speed->value, 0.829);
  EXPECT_FALSE(back.ball->restitution_by_impulse) << "what is not known stays unknown";
  ASSERT_EQ(back.ball->stations.size(), 1U);
  EXPECT_EQ(back.ball->stations[0].gauges, "g1+g2");
  EXPECT_EQ(back.ball->stations[0].clean_from_s, 49e-6);
  EXPECT_EQ(back.ball->stations[0].impulse_N_s, 2.5);
  EXPECT_FALSE(wire::decode(encoded(Reduction{})).ball);
}

TEST(BallCodec, HistoriesOfUnequalLengthAreRefused) {
  BallImpact ball;
  ball.time_s = {0.0, 1e-6};
  Reduction reduction;
  reduction.ball = ball;
  EXPECT_THROW((void)wire::decode(encoded(reduction)), InputError);
}

TEST(ShotCodec, ComesBackExact) {
  const Shot shot = full_shot(4000);
  const Shot back = wire::decode(over_the_wire(encoded(shot)));
  EXPECT_EQ(back.id, shot.id);
  EXPECT_EQ(back.bench_toml, shot.bench_toml);
  EXPECT_EQ(back.rate, shot.rate);
  EXPECT_EQ(back.first_tick, shot.first_tick);
  EXPECT_EQ(back.trigger, shot.trigger);
  EXPECT_EQ(back.channels, shot.channels);
  EXPECT_EQ(back.gaps, shot.gaps);
  EXPECT_EQ(back.meta, shot.meta);
  EXPECT_EQ(back.utc_ns, shot.utc_ns);
  EXPECT_EQ(back.monotonic_ns, shot.monotonic_ns);
  EXPECT_EQ(back.software_version, shot.software_version);
  EXPECT_EQ(back.reduction, shot.reduction);
  ASSERT_TRUE(back.bar_model);
  expect_same(*back.bar_model, *shot.bar_model);
}

TEST(ShotCodec, KeepsWhereABarModelHolds) {
  Shot shot = full_shot(8);
  shot.bar_model->covariance = {4.0, 1.0, 0.0, 1.0, 9.0, -2.0, 0.0, -2.0, 16.0};
  shot.bar_model->identified = Material::Identified{6000.0 / 7.0, std::nullopt};
  expect_same(*wire::decode(over_the_wire(encoded(shot))).bar_model, *shot.bar_model);
  shot.bar_model->covariance.reset();
  shot.bar_model->identified = Material::Identified{};
  expect_same(*wire::decode(over_the_wire(encoded(shot))).bar_model, *shot.bar_model);
}

TEST(ShotCodec, KeepsABarOfAnotherFamilyOfSolids) {
  Shot shot = full_shot(8);
  shot.bar_model->solid = SolidKind::four_element_fluid;
  shot.bar_model->parameters = {{5.7e9, 1e6}, {4e11, 1e9 / 3.0}, {37e9, 2e8}, {1.8e6, 0.0}};
  shot.bar_model->covariance.emplace(16, 0.0);
  (*shot.bar_model->covariance)[15] = 1.0 / 3.0;
  const v1::Shot message = encoded(shot);
  expect_same(*wire::decode(over_the_wire(message)).bar_model, *shot.bar_model);
  const auto refused = [&](const std::function<void(v1::Material&)>& damage) {
    v1::Shot damaged = message;
    damage(*damaged.mutable_bar_model());
    EXPECT_THROW((void)wire::decode(damaged), InputError);
  };
  refused([](v1::Material& m) { m.set_solid("burgers"); });
  refused([](v1::Material& m) { m.mutable_parameters()->RemoveLast(); });
  refused([](v1::Material& m) { m.mutable_covariance()->RemoveLast(); });
}

TEST(ShotCodec, WhatIsAbsentStaysAbsent) {
  Shot shot = full_shot(0);
  shot.trigger.reset();
  shot.bar_model.reset();
  shot.reduction = {};
  shot.channels.clear();
  shot.gaps.clear();
  const Shot back = wire::decode(over_the_wire(encoded(shot)));
  EXPECT_FALSE(back.trigger);
  EXPECT_FALSE(back.bar_model);
  EXPECT_FALSE(back.reduction.asks());
  EXPECT_FALSE(encoded(shot).has_reduction());
  EXPECT_TRUE(back.channels.empty());
  EXPECT_TRUE(back.gaps.empty());
}

TEST(ShotCodec, AMessageIsUsedAgainWithoutLeftovers) {
  v1::Shot message;
  wire::encode(full_shot(100), "a.h5", message);
  Shot small = full_shot(3);
  small.trigger.reset();
  small.meta.clear();
  wire::encode(small, "b.h5", message);
  const Shot back = wire::decode(message);
  EXPECT_EQ(back.channels, small.channels);
  EXPECT_FALSE(back.trigger);
  EXPECT_TRUE(back.meta.empty());
  EXPECT_EQ(message.capture(), "b.h5");
}

TEST(ShotCodec, BitsChooseTheIntegers) {
  const v1::Shot message = encoded(full_shot(10));
  EXPECT_EQ(message.channels(0).dtype(), v1::Waveform::INT16);
  EXPECT_EQ(message.channels(0).data().size(), 10U * 2);
  EXPECT_EQ(message.channels(1).dtype(), v1::Waveform::INT32);
  EXPECT_EQ(message.channels(1).data().size(), 10U * 4);
  EXPECT_DOUBLE_EQ(message.channels(0).step_s(), 3e-6);
}

TEST(ShotCodec, ACodeThatItsBitsCannotHoldIsRefused) {
  for (const std::int32_t code : {32768, -32769, 1 << 20}) {
    Shot shot = full_shot(10);
    shot.channels[0].codes[4] = code;
    EXPECT_THROW(encoded(shot), InputError) << code;
  }
}

TEST(ReductionCodec, ComesBackExact) {
  const Reduction reduction = awkward_reduction(500);
  v1::Result received;
  wire::parse(wire::serialise(encoded(reduction)), "test", received);
  EXPECT_EQ(received.shot_id(), "shot-1");
  const Reduction back = wire::decode(received);
  for (const auto field :
       {&Reduction::time_s, &Reduction::stress_Pa, &Reduction::strain,
        &Reduction::strain_rate_per_s, &Reduction::force_front_N, &Reduction::force_back_N,
        &Reduction::incident, &Reduction::reflected, &Reduction::transmitted,
        &Reduction::strain_true, &Reduction::stress_true_Pa}) {
    EXPECT_EQ(bits_of(back.*field), bits_of(reduction.*field));
  }
  EXPECT_EQ(back.arrival_s, reduction.arrival_s);
  EXPECT_EQ(back.arrival_sigma_s, reduction.arrival_sigma_s);
  EXPECT_EQ(back.band_limit_Hz, reduction.band_limit_Hz);
  EXPECT_EQ(back.quiet_samples, reduction.quiet_samples);
  EXPECT_EQ(back.separation, reduction.separation);
  EXPECT_EQ(back.theory, reduction.theory);
  EXPECT_EQ(back.stress_from, reduction.stress_from);
  EXPECT_EQ(back.corrections.axial_inertia, true);
  EXPECT_EQ(back.corrections.radial_inertia, false);
  EXPECT_EQ(back.corrections.friction, reduction.corrections.friction);
  EXPECT_EQ(back.assumed_from_s, reduction.assumed_from_s);
  EXPECT_EQ(back.push_left_share, reduction.push_left_share);
  EXPECT_EQ(back.bar_model, reduction.bar_model);
  EXPECT_EQ(back.quality.reducible, true);
  ASSERT_EQ(back.quality.checks.size(), 2U);
  EXPECT_EQ(back.quality.checks[0].text, "they differ");
  EXPECT_EQ(back.quality.checks[0].limit, 0.05);
}

TEST(ReductionCodec, NotReducibleComesBackEmptyWithTheReason) {
  Reduction reduction;
  reduction.quality.reason = "3 samples are missing";
  const v1::Result message = encoded(reduction);
  EXPECT_EQ(message.quality().verdict(), v1::Quality::FAIL);
  const Reduction back = wire::decode(message);
  EXPECT_TRUE(back.time_s.empty());
  EXPECT_FALSE(back.quality.reducible);
  EXPECT_EQ(back.quality.reason, "3 samples are missing");
}

TEST(ReductionCodec, TheVerdictIsTheWorstOfTheChecks) {
  Reduction reduction = awkward_reduction(5);
  EXPECT_EQ(encoded(reduction).quality().verdict(), v1::Quality::WARN);
  reduction.quality.checks[1].verdict = Verdict::fail;
  EXPECT_EQ(encoded(reduction).quality().verdict(), v1::Quality::FAIL);
  reduction.quality.checks.clear();
  EXPECT_EQ(encoded(reduction).quality().verdict(), v1::Quality::PASS);
}

TEST(ReductionCodec, HistoriesOfALaterVersionAreLeftAlone) {
  v1::Result message = encoded(awkward_reduction(5));
  message.add_histories()->set_name("temperature_K");
  EXPECT_EQ(wire::decode(message).time_s.size(), 5U);
}

/// A valid message, one thing made wrong, and what the error has to name.
template <class Message>
struct Wrong {
  const char* what;
  std::function<void(Message&)> spoil;
  const char* named;
};

template <class Message>
void expect_refused(const Message& good, const std::vector<Wrong<Message>>& cases) {
  for (const Wrong<Message>& wrong : cases) {
    ASSERT_NO_THROW(static_cast<void>(wire::decode(good)));
    Message message = good;
    wrong.spoil(message);
    try {
      static_cast<void>(wire::decode(message));
      ADD_FAILURE() << wrong.what << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(wrong.named), std::string::npos)
          << wrong.what << ": " << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(HostileShot, IsRefusedByName) {
  using Case = Wrong<v1::Shot>;
  const auto channel = [](auto spoil) {
    return [spoil](v1::Shot& shot) { spoil(*shot.mutable_channels(1)); };
  };
  expect_refused(
      encoded(full_shot(10)),
      std::vector<Case>{
          {"odd bytes", channel([](auto& w) { w.mutable_data()->pop_back(); }), "channels[1].data"},
          {"one sample short", channel([](auto& w) { w.mutable_data()->resize(36); }),
           "channels[1]"},
          {"no dtype", channel([](auto& w) { w.clear_dtype(); }), "channels[1].dtype"},
          {"floats as codes", channel([](auto& w) { w.set_dtype(v1::Waveform::FLOAT64); }),
           "channels[1].dtype"},
          {"unknown dtype",
           channel([](auto& w) { w.set_dtype(static_cast<v1::Waveform::DType>(77)); }), "77"},
          {"the dtype of fewer bits", channel([](auto& w) { w.mutable_converter()->set_bits(12); }),
           "channels[1].dtype"},
          {"NaN scale", channel([](auto& w) { w.set_scale(kNaN); }), "channels[1].scale"},
          {"infinite scale", channel([](auto& w) { w.set_scale(kInfinity); }), "channels[1].scale"},
          {"no scale", channel([](auto& w) { w.clear_scale(); }), "channels[1].scale"},
          {"NaN offset", channel([](auto& w) { w.set_offset(kNaN); }), "channels[1].offset"},
          {"no converter", channel([](auto& w) { w.clear_converter(); }), "channels[1].converter"},
          {"33 bits", channel([](auto& w) { w.mutable_converter()->set_bits(33); }), "bits"},
          {"-1 bits", channel([](auto& w) { w.mutable_converter()->set_bits(-1); }), "bits"},
          {"no code range", channel([](auto& w) { w.mutable_converter()->set_code_max(-8388608); }),
           "code_min"},
          {"no rate", [](auto& s) { s.clear_first(); }, "first.rate"},
          {"negative rate", [](auto& s) { s.mutable_first()->set_rate_numerator(-1); },
           "first.rate"},
          {"no denominator", [](auto& s) { s.mutable_first()->clear_rate_denominator(); },
           "first.rate"},
          {"no trigger kind", [](auto& s) { s.mutable_trigger()->clear_kind(); }, "trigger.kind"},
          {"unknown trigger kind",
           [](auto& s) { s.mutable_trigger()->set_kind(static_cast<v1::TriggerInfo::Kind>(-9)); },
           "-9"},
          {"fraction of 1", [](auto& s) { s.mutable_trigger()->set_fraction(1.0); }, "fraction"},
          {"NaN fraction", [](auto& s) { s.mutable_trigger()->set_fraction(kNaN); }, "fraction"},
          {"negative sigma", [](auto& s) { s.mutable_trigger()->set_sigma_samples(-1.0); },
           "sigma_samples"},
          {"infinite sigma", [](auto& s) { s.mutable_trigger()->set_sigma_samples(kInfinity); },
           "sigma_samples"},
          {"negative gap", [](auto& s) { s.mutable_gaps(1)->set_samples(-3); }, "gaps[1]"},
          {"too many channels",
           [](auto& s) {
             for (int i = 0; i < 300; ++i) {
               s.add_channels();
             }
           },
           "channels"},
      });
}

TEST(HostileResult, IsRefusedByName) {
  using Case = Wrong<v1::Result>;
  const auto history = [](auto spoil) {
    return [spoil](v1::Result& result) { spoil(*result.mutable_histories(2)); };
  };
  expect_refused(
      encoded(awkward_reduction(10)),
      std::vector<Case>{
          {"odd bytes", history([](auto& w) { w.mutable_data()->resize(79); }),
           "histories[2].data"},
          {"one value short", history([](auto& w) { w.mutable_data()->resize(72); }), "strain"},
          {"codes as values", history([](auto& w) { w.set_dtype(v1::Waveform::INT32); }),
           "histories[2].dtype"},
          {"scaled values", history([](auto& w) { w.set_scale(2.0); }), "histories[2].scale"},
          {"NaN scale", history([](auto& w) { w.set_scale(kNaN); }), "histories[2].scale"},
          {"shifted values", history([](auto& w) { w.set_offset(1.0); }), "histories[2].scale"},
          {"a history twice", history([](auto& w) { w.set_name("stress_Pa"); }),
           "histories[2].name"},
          {"a history missing", history([](auto& w) { w.set_name("?"); }), "strain"},
          {"a wave missing", [](auto& r) { r.mutable_waves()->RemoveLast(); }, "transmitted"},
          {"no quality", [](auto& r) { r.clear_quality(); }, "quality.verdict"},
          {"unknown verdict",
           [](auto& r) {
             r.mutable_quality()->mutable_checks(1)->set_verdict(
                 static_cast<v1::Quality::Verdict>(99));
           },
           "checks[1].verdict"},
      });
}

TEST(HostileShot, HugeArraysAreRefusedBeforeTheyAreCopied) {
  v1::Shot message = encoded(full_shot(4));
  message.mutable_channels(0)->mutable_data()->resize((std::size_t{1} << 27) + 2);
  EXPECT_THROW(static_cast<void>(wire::decode(message)), InputError);
}

/// Whatever the bytes, they are read, refused as bytes or refused as contents.
template <class Message>
void survive(const std::string& bytes) {
  Message message;
  try {
    wire::parse(bytes, "test", message);
    static_cast<void>(wire::decode(message));
  } catch (const InputError&) {
  }
}

TEST(HostileBytes, TruncatedAndFlippedMessagesNeverCrash) {
  const std::string shot = wire::serialise(encoded(full_shot(10)));
  const std::string result = wire::serialise(encoded(awkward_reduction(10)));
  for (std::size_t length = 0; length < shot.size(); ++length) {
    survive<v1::Shot>(shot.substr(0, length));
  }
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = i % 2 == 0 ? shot : result;
    for (int flips = 0; flips < 3; ++flips) {
      bytes[random() % bytes.size()] ^= static_cast<char>(1U << (random() % 8));
    }
    survive<v1::Shot>(bytes);
    survive<v1::Result>(bytes);
    survive<v1::TriggerInfo>(bytes);
  }
}

TEST(HostileBytes, AreNamedByWhereTheyCameFrom) {
  v1::Shot message;
  try {
    wire::parse("\xff\xff\xff", "journal.kj", message);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "journal.kj");
  }
}

TEST(Text, ThatIsNotUtf8DoesNotSpoilTheMessage) {
  Shot shot = full_shot(4);
  shot.meta = {{"operator", "J\xfcrgen"}, {"good", "Jürgen"}};
  shot.channels[0].gauge = "g\x80\x80";
  shot.id = "\xed\xa0\x80";  // a surrogate, as no UTF-8 may have
  const Shot back = wire::decode(over_the_wire(encoded(shot)));
  EXPECT_EQ(back.meta.at("operator"), "J?rgen");
  EXPECT_EQ(back.meta.at("good"), "Jürgen");
  EXPECT_EQ(back.channels[0].gauge, "g??");
  EXPECT_EQ(back.channels[0].codes, shot.channels[0].codes);
  EXPECT_EQ(back.id, "???");
}

TEST(Commands, ThatChangeSomethingAreTold) {
  int commands = 0;
  for (const golden::Fixture& fixture : golden::fixtures()) {
    if (!fixture.name.starts_with("request_")) {
      continue;
    }
    v1::ControlRequest request;
    request.CopyFrom(*fixture.message);
    const std::string name = fixture.name.substr(8);
    const bool question = name == "status" || name == "list_shots" || name == "get_shot" ||
                          name == "snapshot" || name == "diagnosis";
    EXPECT_EQ(wire::changes_state(request), !question) << name;
    ++commands;
  }
  EXPECT_EQ(commands, 14);
}

}  // namespace
}  // namespace kolsky
