#include "processing/reduction/ball/ball_repeats.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kolsky {

namespace {

template <typename Member>
Repeated over(std::span<const BallImpact> impacts, const std::vector<std::size_t>& members,
              Member member) {
  Repeated number;
  double squares = 0.0;
  for (const std::size_t i : members) {
    const std::optional<Measured> value = member(impacts[i]);
    if (value) {
      // Welford's: the sd of numbers that differ little loses no digits.
      ++number.count;
      const double step = *value - number.mean;
      number.mean += step / static_cast<double>(number.count);
      squares += step * (*value - number.mean);
    }
  }
  if (number.count > 1) {
    number.sd = std::sqrt(squares / static_cast<double>(number.count - 1));
  }
  return number;
}

BallRepeats repeats_of(std::span<const BallImpact> impacts, std::vector<std::size_t> members) {
  BallRepeats group;
  const auto some = [](const Measured& value) { return std::optional(value); };
  group.contact_threshold = impacts[members.front()].contact_threshold;
  const bool one_threshold = std::all_of(members.begin(), members.end(), [&](std::size_t i) {
    return impacts[i].contact_threshold == group.contact_threshold;
  });
  group.speed_m_per_s =
      over(impacts, members, [](const BallImpact& b) { return b.incident_speed_m_per_s; });
  group.peak_force_N =
      over(impacts, members, [&](const BallImpact& b) { return some(b.peak_force_N); });
  if (one_threshold) {
    group.contact_time_s =
        over(impacts, members, [&](const BallImpact& b) { return some(b.contact_time_s); });
  }
  group.impulse_N_s = over(impacts, members, [&](const BallImpact& b) {
    return b.contact_over ? some(b.impulse_N_s) : std::nullopt;
  });
  group.restitution_by_speed =
      over(impacts, members, [](const BallImpact& b) { return b.restitution_by_speed; });
  group.restitution_by_impulse =
      over(impacts, members, [](const BallImpact& b) { return b.restitution_by_impulse; });
  group.members = std::move(members);
  return group;
}

}  // namespace

std::vector<BallRepeats> group_by_speed(std::span<const BallImpact> impacts, double gap_share) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    if (impacts[i].incident_speed_m_per_s) {
      order.push_back(i);
    }
  }
  const auto speed = [&](std::size_t i) { return impacts[i].incident_speed_m_per_s->value; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return speed(a) < speed(b); });
  std::vector<BallRepeats> groups;
  std::vector<std::size_t> members;
  for (const std::size_t i : order) {
    if (!members.empty() && speed(i) > (1.0 + gap_share) * speed(members.back())) {
      groups.push_back(repeats_of(impacts, std::move(members)));
      members.clear();
    }
    members.push_back(i);
  }
  if (!members.empty()) {
    groups.push_back(repeats_of(impacts, std::move(members)));
  }
  return groups;
}

}  // namespace kolsky
