// A ball of known path through beams of known places.
#include "processing/reduction/ball/ball_flight.hpp"

#include <gtest/gtest.h>

#include "processing/base/error.hpp"
#include "tests/unit/reduction/ball_bench.hpp"

namespace kolsky {
namespace {

using kolsky::testing::ball_bench;

constexpr double kTouch_s = 4e-3;
constexpr double kRadius_m = 0.0427 / 2.0;

struct Flight {
  double in_m_per_s = 31.1;
  double out_m_per_s = 25.8;
  double contact_s = 450e-6;

  /// The ball's surface from the face.
  [[nodiscard]] double gap_m(double time_s) const {
    const double since_s = time_s - kTouch_s;
    return since_s < 0.0         ? -in_m_per_s * since_s
           : since_s < contact_s ? 0.0
                                 : out_m_per_s * (since_s - contact_s);
  }
};

/// A beam 1 mm wide, light in proportion to what the ball leaves open.
double volts(const Flight& flight, double distance_m, double time_s, double bright, double dark) {
  constexpr double kWidth_m = 1e-3;
  const double centre_m = flight.gap_m(time_s) + kRadius_m;
  const double inside_m = kRadius_m - std::abs(distance_m - centre_m);
  const double covered = std::clamp(inside_m / kWidth_m + 0.5, 0.0, 1.0);
  return bright + (dark - bright) * covered;
}

Shot shot_of(const Flight& flight, const std::vector<double>& distances_m, double bright = 4.0,
             double dark = 0.5, double noise_V = 0.02) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, noise_V);
  Bench bench = ball_bench();
  Shot shot = testing::ball_shot(bench, [](double) { return 0.0; }, {.samples = 9000});
  for (const double distance_m : distances_m) {
    const std::string name = "p" + std::to_string(shot.bench.photo_sensors.size() + 1);
    shot.bench.photo_sensors.push_back({name, {distance_m}});
    ChannelRecord channel;
    channel.gauge = name;
    channel.unit = "V";
    channel.scale = 5.0 / 32768.0;
    for (std::size_t n = 0; n < shot.samples(); ++n) {
      const double reading =
          volts(flight, distance_m, 1e-6 * static_cast<double>(n), bright, dark) + normal(random);
      channel.codes.push_back(static_cast<std::int32_t>(std::lround(reading / channel.scale)));
    }
    shot.channels.push_back(channel);
  }
  return shot;
}

void expect_speeds(const BallFlight& found, const Flight& flight) {
  EXPECT_EQ(found.problem, "");
  EXPECT_EQ(found.source, "photo-sensors");
  ASSERT_TRUE(found.incident_m_per_s && found.rebound_m_per_s);
  EXPECT_NEAR(*found.incident_m_per_s, flight.in_m_per_s, 2e-3 * flight.in_m_per_s);
  EXPECT_NEAR(*found.incident_m_per_s, flight.in_m_per_s, 4.0 * found.incident_m_per_s->sd);
  EXPECT_NEAR(*found.rebound_m_per_s, flight.out_m_per_s, 4.0 * found.rebound_m_per_s->sd);
  EXPECT_LT(found.incident_m_per_s->sd, 5e-3 * flight.in_m_per_s);
}

TEST(BallFlight, TwoBeamsByTheirDistance) {
  for (const double speed : {31.1, 40.3, 51.0}) {
    const Flight flight{speed, 0.8 * speed, 420e-6};
    expect_speeds(ball_flight(shot_of(flight, {0.09, 0.06}), kTouch_s), flight);
    expect_speeds(ball_flight(shot_of(flight, {0.06, 0.09}), kTouch_s), flight);
  }
}

TEST(BallFlight, DarkMayBeTheHigherVoltage) {
  expect_speeds(ball_flight(shot_of({}, {0.09, 0.06}, 0.3, 4.5), kTouch_s), {});
}

TEST(BallFlight, OneBeamByTheBallsDiameter) {
  expect_speeds(ball_flight(shot_of({}, {0.06}), kTouch_s), {});
}

TEST(BallFlight, DistanceErrorsReachTheSpeed) {
  Shot shot = shot_of({}, {0.09, 0.06}, 4.0, 0.5, 0.0);
  shot.bench.photo_sensors[0].distance_m.sd = 0.3e-3;
  const BallFlight found = ball_flight(shot, kTouch_s);
  EXPECT_NEAR(found.incident_m_per_s->sd / *found.incident_m_per_s, 0.01, 5e-4);
}

TEST(BallFlight, ARecordThatEndsEarlyStillGivesTheWayIn) {
  Shot shot = shot_of({}, {0.09, 0.06});
  for (ChannelRecord& channel : shot.channels) {
    channel.codes.resize(5200);
  }
  const BallFlight found = ball_flight(shot, kTouch_s);
  EXPECT_TRUE(found.incident_m_per_s);
  EXPECT_FALSE(found.rebound_m_per_s);
  EXPECT_NE(found.problem.find("after the impact"), std::string::npos) << found.problem;
}

TEST(BallFlight, ASecondBodyIsRefused) {
  Shot shot = shot_of({}, {0.09, 0.06});
  const std::int32_t dark =
      *std::min_element(shot.channels[1].codes.begin(), shot.channels[1].codes.end());
  std::fill_n(shot.channels[1].codes.begin() + 200, 300, dark);
  const BallFlight found = ball_flight(shot, kTouch_s);
  EXPECT_FALSE(found.incident_m_per_s);
  EXPECT_NE(found.problem.find("more than one body passes p1"), std::string::npos) << found.problem;
  EXPECT_TRUE(found.rebound_m_per_s) << "the way out is not in doubt";
}

TEST(BallFlight, ExchangedChannelsAreNoticed) {
  Shot shot = shot_of({}, {0.09, 0.06});
  std::swap(shot.channels[1].codes, shot.channels[2].codes);
  const BallFlight found = ball_flight(shot, kTouch_s);
  EXPECT_FALSE(found.incident_m_per_s);
  EXPECT_NE(found.problem.find("exchanged"), std::string::npos) << found.problem;
}

TEST(BallFlight, ADeadSensorIsNamed) {
  Shot shot = shot_of({}, {0.09, 0.06});
  std::fill(shot.channels[2].codes.begin(), shot.channels[2].codes.end(), 100);
  EXPECT_NE(ball_flight(shot, kTouch_s).problem.find("p2 sees nothing"), std::string::npos);
}

TEST(BallFlight, SensorsGoBeforeFactsAndMustNotContradictThem) {
  Shot shot = shot_of({}, {0.09, 0.06});
  shot.meta["incident_speed_m_per_s"] = "31.15";
  EXPECT_EQ(ball_flight(shot, kTouch_s).source, "photo-sensors");
  EXPECT_EQ(ball_flight(shot, kTouch_s).problem, "");
  shot.meta["incident_speed_m_per_s"] = "40.3";
  const BallFlight found = ball_flight(shot, kTouch_s);
  EXPECT_FALSE(found.incident_m_per_s);
  EXPECT_NE(found.problem.find("40.3"), std::string::npos) << found.problem;
}

TEST(BallFlight, FactsAreMagnitudesWithTheirDeviations) {
  Shot shot = testing::ball_shot(ball_bench(), [](double) { return 0.0; });
  EXPECT_NE(ball_flight(shot, 0.0).problem.find("no speed"), std::string::npos);
  shot.meta = {{"incident_speed_m_per_s", "31.1"},
               {"incident_speed_m_per_s_sd", "0.2"},
               {"rebound_speed_m_per_s", "-25.0"}};
  const BallFlight found = ball_flight(shot, 0.0);
  EXPECT_EQ(found.problem, "");
  EXPECT_EQ(found.incident_m_per_s->sd, 0.2);
  EXPECT_EQ(found.rebound_m_per_s->value, 25.0);
  shot.meta["rebound_speed_m_per_s_sd"] = "-0.1";
  try {
    static_cast<void>(ball_flight(shot, 0.0));
    FAIL() << "a deviation below 0 was taken";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "meta rebound_speed_m_per_s_sd");
    EXPECT_EQ(error.problem(), "-0.1 is no deviation");
  }
}

}  // namespace
}  // namespace kolsky
