#include "processing/reduction/ball/ball_flight.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/reduction/formatted.hpp"

namespace kolsky {

namespace {

constexpr double kHalf = 0.5;
constexpr double kHysteresis = 0.2;  // of the swing, either side of the middle
constexpr double kLeastSwingOverNoise = 10.0;
constexpr double kClearAround_s = 50e-6;  // of the touch
constexpr double kAgreement = 0.01;       // of facts and photo-sensors
constexpr double kDeviations = 3.0;

/// A passage of one edge, in seconds from the first sample.
struct Edge {
  double time_s = 0.0;
  double sd_s = 0.0;
};

/// A body in the beam; an edge that the record does not hold is missing.
struct Passage {
  std::optional<Edge> blocked;
  std::optional<Edge> cleared;
};

/// What one sensor saw on either side of the touch.
struct Seen {
  std::vector<Passage> before;
  std::vector<Passage> after;
};

/// One sensor's record as 0 where the beam is clear and 1 where it is blocked.
struct Beam {
  std::vector<double> darkness;
  double noise = 0.0;
};

/// The level furthest from the clear one that a few samples in a row keep to: a spike is no ball.
double darkest_level(const std::vector<double>& values, double clear) {
  constexpr std::size_t kInARow = 5;
  double darkest = clear;
  for (std::size_t n = 0; n + kInARow <= values.size(); ++n) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(n);
    const auto [low, high] = std::minmax_element(first, first + kInARow);
    const double level = *low > clear ? *low : *high < clear ? *high : clear;
    if (std::abs(level - clear) > std::abs(darkest - clear)) {
      darkest = level;
    }
  }
  return darkest;
}

std::optional<Beam> beam_of(const ChannelRecord& channel, std::size_t touch, std::size_t around) {
  std::vector<double> values;
  values.reserve(channel.codes.size());
  for (const std::int32_t code : channel.codes) {
    values.push_back(channel.value(code));
  }
  const std::size_t begin = touch > around ? touch - around : 0;
  const std::size_t end = std::min(values.size(), touch + around + 1);
  double clear = 0.0;
  for (std::size_t n = begin; n < end; ++n) {
    clear += values[n] / static_cast<double>(end - begin);
  }
  double squares = 0.0;
  for (std::size_t n = begin; n < end; ++n) {
    squares += (values[n] - clear) * (values[n] - clear);
  }
  const double swing = darkest_level(values, clear) - clear;
  Beam beam;
  beam.noise = std::sqrt(squares / static_cast<double>(end - begin));
  if (swing == 0.0 || std::abs(swing) < kLeastSwingOverNoise * beam.noise) {
    return std::nullopt;
  }
  beam.noise /= std::abs(swing);
  for (const double value : values) {
    beam.darkness.push_back((value - clear) / swing);
  }
  return beam;
}

/// The passage of the middle between `from`, the last sample surely on one side, and `to`, the
/// first surely on the other; its deviation is from the noise on the slope between them.
Edge edge_between(const Beam& beam, std::size_t from, std::size_t to, double period_s) {
  const bool falling = beam.darkness[to] > beam.darkness[from];
  std::size_t n = from;
  while (n + 1 < to && (falling ? beam.darkness[n + 1] < kHalf : beam.darkness[n + 1] > kHalf)) {
    ++n;
  }
  const double step = beam.darkness[n + 1] - beam.darkness[n];
  const double share = step != 0.0 ? std::clamp((kHalf - beam.darkness[n]) / step, 0.0, 1.0) : 0.5;
  const double slope =
      std::abs(beam.darkness[to] - beam.darkness[from]) / static_cast<double>(to - from);
  return {(static_cast<double>(n) + share) * period_s,
          period_s * std::hypot(beam.noise / slope, 1.0 / std::sqrt(12.0))};
}

std::vector<Passage> passages_of(const Beam& beam, double period_s) {
  std::vector<Passage> passages;
  bool blocked = beam.darkness.front() > kHalf;
  if (blocked) {
    passages.emplace_back();
  }
  std::size_t sure = 0;  // last sample beyond the hysteresis on the present side
  for (std::size_t n = 0; n < beam.darkness.size(); ++n) {
    const double level = beam.darkness[n];
    if (blocked ? level > kHalf + kHysteresis : level < kHalf - kHysteresis) {
      sure = n;
    } else if (blocked ? level < kHalf - kHysteresis : level > kHalf + kHysteresis) {
      const Edge edge = edge_between(beam, sure, n, period_s);
      if (blocked) {
        passages.back().cleared = edge;
      } else {
        passages.emplace_back();
        passages.back().blocked = edge;
      }
      blocked = !blocked;
      sure = n;
    }
  }
  return passages;
}

Seen sorted_by_touch(const std::vector<Passage>& passages, double touch_s) {
  Seen seen;
  for (const Passage& passage : passages) {
    const bool before = passage.cleared ? passage.cleared->time_s < touch_s
                                        : passage.blocked && passage.blocked->time_s < touch_s;
    (before ? seen.before : seen.after).push_back(passage);
  }
  return seen;
}

Measured by_diameter(const Passage& passage, const Measured& diameter_m) {
  const double dark_s = passage.cleared->time_s - passage.blocked->time_s;
  const double sd_s = std::hypot(passage.cleared->sd_s, passage.blocked->sd_s);
  const double speed = diameter_m / dark_s;
  return {speed, speed * std::hypot(diameter_m.sd / diameter_m, sd_s / dark_s)};
}

/// Mean over the edges that both beams saw of the time from the first to the second.
std::optional<Edge> time_between(const Passage& first, const Passage& second) {
  double sum_s = 0.0;
  double variance = 0.0;
  int edges = 0;
  for (const auto member : {&Passage::blocked, &Passage::cleared}) {
    if (first.*member && second.*member) {
      sum_s += (second.*member)->time_s - (first.*member)->time_s;
      variance += std::pow((second.*member)->sd_s, 2) + std::pow((first.*member)->sd_s, 2);
      ++edges;
    }
  }
  if (edges == 0) {
    return std::nullopt;
  }
  return Edge{sum_s / edges, std::sqrt(variance) / edges};
}

/// A speed, or why there is none.
struct Outcome {
  std::optional<Measured> speed;
  std::string problem;
};

Outcome speed_from(const std::vector<PhotoSensor>& sensors, const Ball& ball,
                   const std::vector<const std::vector<Passage>*>& passages, bool incoming) {
  const std::string way = incoming ? "before" : "after";
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (passages[i]->size() > 1) {
      return {std::nullopt, "more than one body passes " + sensors[i].name + " " + way +
                                " the impact: which is the ball is not known"};
    }
    if (passages[i]->empty()) {
      return {std::nullopt, "nothing passes " + sensors[i].name + " " + way + " the impact"};
    }
  }
  if (sensors.size() == 1) {
    const Passage& passage = passages[0]->front();
    if (!passage.blocked || !passage.cleared) {
      return {std::nullopt, "the record does not hold the whole passage of " + sensors[0].name};
    }
    return {by_diameter(passage, ball.outer_diameter_m), {}};
  }
  // The far beam is the first on the way in and the second on the way out.
  const bool zero_is_far = sensors[0].distance_m > sensors[1].distance_m;
  const std::size_t first = zero_is_far == incoming ? 0 : 1;
  const std::optional<Edge> time =
      time_between(passages[first]->front(), passages[1 - first]->front());
  if (!time) {
    return {std::nullopt, "the record does not hold the same edge at both photo-sensors"};
  }
  if (!(time->time_s > 0.0)) {
    return {std::nullopt, "the ball passes " + sensors[1 - first].name + " before " +
                              sensors[first].name + ": their distances are exchanged"};
  }
  const double apart_m = std::abs(sensors[0].distance_m - sensors[1].distance_m);
  const double sd_m = std::hypot(sensors[0].distance_m.sd, sensors[1].distance_m.sd);
  const double speed = apart_m / time->time_s;
  return {Measured{speed, speed * std::hypot(sd_m / apart_m, time->sd_s / time->time_s)}, {}};
}

BallFlight flight_by_sensors(const Shot& shot, double touch_s) {
  const std::vector<PhotoSensor>& sensors = shot.bench.photo_sensors;
  const double period_s = shot.rate.period_s();
  const auto touch = static_cast<std::size_t>(std::max(0.0, touch_s / period_s));
  const auto around = static_cast<std::size_t>(kClearAround_s / period_s) + 8;
  BallFlight flight;
  flight.source = "photo-sensors";
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const ChannelRecord& channel = shot.channels[shot.bench.gauges.size() + i];
    const std::optional<Beam> beam = beam_of(channel, touch, around);
    if (!beam) {
      flight.problem = "photo-sensor " + sensors[i].name + " sees nothing pass";
      return flight;
    }
    seen.push_back(sorted_by_touch(passages_of(*beam, period_s), touch_s));
  }
  std::vector<const std::vector<Passage>*> before;
  std::vector<const std::vector<Passage>*> after;
  for (const Seen& sensor : seen) {
    before.push_back(&sensor.before);
    after.push_back(&sensor.after);
  }
  const Ball ball = shot.bench.ball.value_or(Ball{});
  const Outcome in = speed_from(sensors, ball, before, true);
  const Outcome out = speed_from(sensors, ball, after, false);
  flight.incident_m_per_s = in.speed;
  flight.rebound_m_per_s = out.speed;
  flight.problem = in.speed ? out.problem : in.problem;
  return flight;
}

std::optional<double> fact(const Shot& shot, const std::string& key) {
  const auto found = shot.meta.find(key);
  if (found == shot.meta.end()) {
    return std::nullopt;
  }
  const std::string& words = found->second;
  double value = 0.0;
  const auto result = std::from_chars(words.data(), words.data() + words.size(), value);
  if (result.ec != std::errc() || result.ptr != words.data() + words.size() ||
      !std::isfinite(value)) {
    throw InputError("meta " + key, "\"" + words + "\" is not a number",
                     "give metres per second, as 31.1");
  }
  return value;
}

std::optional<Measured> speed_fact(const Shot& shot, const std::string& key) {
  const std::optional<double> value = fact(shot, key);
  const std::optional<double> sd = fact(shot, key + "_sd");
  if (!value) {
    return std::nullopt;
  }
  if (*value == 0.0) {
    throw InputError("meta " + key, "0 is no speed", "give metres per second, as 31.1");
  }
  if (sd.value_or(0.0) < 0.0) {
    throw InputError("meta " + key + "_sd", formatted("%.4g", *sd) + " is no deviation",
                     "give metres per second, from 0 up");
  }
  return Measured{std::abs(*value), sd.value_or(0.0)};
}

std::string contradiction(const char* which, const std::optional<Measured>& seen,
                          const std::optional<Measured>& told) {
  if (!seen || !told) {
    return {};
  }
  const double difference = std::abs(*seen - *told);
  if (difference <= std::max(kAgreement * *told, kDeviations * std::hypot(seen->sd, told->sd))) {
    return {};
  }
  return std::string("the photo-sensors say ") +
         formatted("%.4g m/s where the capture's facts say %.4g m/s", seen->value, told->value) +
         " (" + which + "): remove the wrong one";
}

}  // namespace

BallFlight ball_flight(const Shot& shot, double touch_s) {
  const std::optional<Measured> told_in = speed_fact(shot, "incident_speed_m_per_s");
  const std::optional<Measured> told_out = speed_fact(shot, "rebound_speed_m_per_s");
  if (shot.bench.photo_sensors.empty()) {
    BallFlight flight{told_in, told_out, told_in || told_out ? "meta" : "", {}};
    if (!told_in) {
      flight.problem = "no speed: file incident_speed_m_per_s with the capture, or photo_sensors";
    } else if (!told_out) {
      flight.problem = "no rebound speed: file rebound_speed_m_per_s with the capture";
    }
    return flight;
  }
  BallFlight flight = flight_by_sensors(shot, touch_s);
  for (const std::string& against : {contradiction("incident", flight.incident_m_per_s, told_in),
                                     contradiction("rebound", flight.rebound_m_per_s, told_out)}) {
    if (!against.empty()) {
      return {std::nullopt, std::nullopt, "photo-sensors", against};
    }
  }
  return flight;
}

}  // namespace kolsky
