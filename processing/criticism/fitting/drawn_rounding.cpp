#include "processing/criticism/fitting/drawn_rounding.hpp"

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <utility>

namespace kolsky {

namespace {

/// Places in every part of a step, in an order of their own.
std::vector<double> offsets_over(double step, std::mt19937_64& random) {
  std::vector<double> list;
  for (std::size_t d = 0; d < DrawnRounding::kDraws; ++d) {
    list.push_back(step * (static_cast<double>(d) + 0.5) /
                   static_cast<double>(DrawnRounding::kDraws));
  }
  for (std::size_t d = list.size(); d > 1; --d) {
    std::swap(list[d - 1], list[random() % d]);
  }
  return list;
}

}  // namespace

DrawnRounding::DrawnRounding(WhiteResiduals& residuals, StepsLie lie)
    : campaign_(residuals.campaign()) {
  std::mt19937_64 random;
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    if (!residuals.noise().is_coarse(j)) {
      continue;
    }
    const double step = campaign_.step[j];
    CoarseGauge own{j, step, {step, residuals.noise().unrounded_sd(j)}, {}, {}};
    for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
      own.clean.push_back(residuals.signal(n, j));
      const bool as_before = n > 0 && lie == StepsLie::alike;
      own.offset.push_back(as_before ? own.offset.front() : offsets_over(step, random));
    }
    gauges_.push_back(std::move(own));
  }
}

std::vector<std::vector<double>> DrawnRounding::records(std::size_t shot, std::size_t draw) const {
  std::vector<std::vector<double>> list;
  for (const std::vector<double>& record : campaign_.shots[shot].strain) {
    list.emplace_back(record.size(), 0.0);
  }
  std::mt19937_64 random(shot * kDraws + draw);
  const auto quiet = static_cast<Eigen::Index>(campaign_.shots[shot].quiet_samples);
  for (const CoarseGauge& own : gauges_) {
    std::vector<double>& record = list[own.gauge];
    for (std::size_t n = 0; n < record.size(); ++n) {
      const double strain = own.clean[shot][n] + own.offset[shot][draw];
      const double variance = own.rounding.variance_beyond(strain);
      record[n] = own.rounding.mean(strain);
      if (variance > 0.0) {
        record[n] += random() % 2 == 0 ? std::sqrt(variance) : -std::sqrt(variance);
      }
    }
    Eigen::Map<Eigen::VectorXd> values(record.data(), static_cast<Eigen::Index>(record.size()));
    values.array() -= values.head(quiet).mean();
  }
  return list;
}

}  // namespace kolsky
