#include "processing/identification/noise_arrivals.hpp"

#include <algorithm>

namespace kolsky {

namespace {

/// Of a bar so short that there are more, those beyond are left out of the reckoning by taking
/// turns for longer.
constexpr double kMostTurns = 64.0;

}  // namespace

NoiseArrivals::NoiseArrivals(const Times& times)
    : lead_s_(times.lead_s), judged_s_(times.judged_s) {
  const double whole_s = lead_s_ + judged_s_;
  const double turn_s = std::max(times.turn_s, whole_s / kMostTurns);
  const auto add = [&](Arrival arrival) {
    if (arrival.late_s < whole_s) {
      most_turns_ = std::max(most_turns_, arrival.turns);
      arrivals_.push_back(arrival);
    }
  };
  for (std::size_t j = 0; j < times.first_s.size(); ++j) {
    const auto gauge = static_cast<Eigen::Index>(j);
    add({.gauge = gauge, .late_s = times.first_s[j]});
    for (std::size_t i = 0; !times.back_s.empty() && static_cast<double>(i) * turn_s < whole_s;
         ++i) {
      const double late_s = times.first_s[j] + static_cast<double>(i) * turn_s;
      add({gauge, i, true, late_s + std::min(times.back_s[j], turn_s)});
      add({gauge, i + 1, false, late_s + turn_s});
    }
  }
  for (std::size_t n = 0; n < arrivals_.size(); ++n) {
    changes_.push_back({std::min(judged_s_, judged_s_ - arrivals_[n].late_s), n, 1.0});
    changes_.push_back({std::min(judged_s_, -arrivals_[n].late_s), n, -1.0});
  }
  std::ranges::sort(changes_, std::greater<>(), &Change::moment_s);
}

NoiseArrivals::Shown NoiseArrivals::shown(std::span<const Complex> first,
                                          std::span<const Complex> back, Complex turn) const {
  std::vector<Complex> turned(most_turns_ + 1, 1.0);
  for (std::size_t i = 1; i < turned.size(); ++i) {
    turned[i] = turned[i - 1] * turn;
  }
  const auto others = static_cast<Eigen::Index>(first.size());
  Shown shown{Eigen::MatrixXcd::Zero(others, others), Eigen::VectorXcd::Zero(others)};
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(others);
  double until_s = judged_s_;
  const auto count = [&](double from_s) {
    const double share = (until_s - from_s) / judged_s_;
    const double judged = (std::max(until_s, 0.0) - std::max(from_s, 0.0)) / judged_s_;
    shown.mean_square.noalias() += share * sum * sum.adjoint();
    shown.mean += judged * sum;
    until_s = from_s;
  };
  for (const Change& change : changes_) {
    if (change.moment_s <= -lead_s_) {
      break;
    }
    count(change.moment_s);
    const Arrival& arrival = arrivals_[change.arrival];
    const auto j = static_cast<std::size_t>(arrival.gauge);
    sum[arrival.gauge] +=
        change.sign * first[j] * (arrival.back ? back[j] : Complex(1.0)) * turned[arrival.turns];
  }
  count(-lead_s_);
  return shown;
}

}  // namespace kolsky
