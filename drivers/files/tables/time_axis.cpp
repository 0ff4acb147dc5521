#include "drivers/files/tables/time_axis.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

constexpr double kStepTolerance = 0.05;

std::vector<double> steps_of(const ScopeTable& table) {
  const std::vector<double>& time_s = table.time_s;
  std::vector<double> steps_s;
  steps_s.reserve(time_s.size());
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double step_s = time_s[i] - time_s[i - 1];
    if (!(step_s > 0.0)) {
      throw InputError(
          table.place(i) + ": time",
          "goes from " + in_words(time_s[i - 1], "s") + " to " + in_words(time_s[i], "s"),
          "time must advance; export it with all its digits");
    }
    steps_s.push_back(step_s);
  }
  return steps_s;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double mean_step_s(const ScopeTable& table) {
  return (table.time_s.back() - table.time_s.front()) /
         static_cast<double>(table.time_s.size() - 1);
}

// Lagrange's polynomial through `nodes` samples from `first`.
double through(const std::vector<double>& time_s, const std::vector<double>& values,
               std::size_t first, std::size_t nodes, double at_s) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + nodes; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + nodes; ++j) {
      if (j != i) weight *= (at_s - time_s[j]) / (time_s[i] - time_s[j]);
    }
    sum += weight * values[i];
  }
  return sum;
}

}  // namespace

double measured_rate_Hz(const ScopeTable& table) {
  const std::vector<double> steps_s = steps_of(table);
  const double usual_s = median(steps_s);
  for (std::size_t i = 0; i < steps_s.size(); ++i) {
    if (std::abs(steps_s[i] - usual_s) > kStepTolerance * usual_s) {
      throw InputError(
          table.place(i + 1) + ": time",
          "steps by " + in_words(steps_s[i], "s") + ", elsewhere by " + in_words(usual_s, "s"),
          "rows are missing or twice there, or time has too few digits");
    }
  }
  return 1.0 / mean_step_s(table);
}

void require_same_time_axis(const ScopeTable& first, const ScopeTable& other) {
  if (first.time_s.size() != other.time_s.size()) {
    throw InputError(other.file,
                     "has " + std::to_string(other.time_s.size()) + " samples and " + first.file +
                         " has " + std::to_string(first.time_s.size()),
                     "export the channels of one shot with one time axis");
  }
  const double allowed_s = kStepTolerance * mean_step_s(first);
  const std::size_t last = first.time_s.size() - 1;
  for (const std::size_t sample : {std::size_t{0}, last}) {
    if (std::abs(first.time_s[sample] - other.time_s[sample]) > allowed_s) {
      throw InputError(other.place(sample) + ": time",
                       "is " + in_words(other.time_s[sample], "s") + " where " + first.file +
                           " has " + in_words(first.time_s[sample], "s"),
                       "export the channels of one shot with one time axis, or cut them to the "
                       "same start");
    }
  }
}

EvenTimes even_times(const ScopeTable& table, double rate_Hz) {
  const double steps = (table.time_s.back() - table.time_s.front()) * rate_Hz;
  return {table.time_s.front(), 1.0 / rate_Hz,
          static_cast<std::size_t>(std::floor(steps + kStepTolerance)) + 1};
}

double farthest_off(const ScopeTable& table, const EvenTimes& even) {
  double farthest_s = 0.0;
  for (std::size_t i = 0; i < table.time_s.size(); ++i) {
    farthest_s = std::max(farthest_s, std::abs(table.time_s[i] - even.at(i)));
  }
  return farthest_s > kStepTolerance * even.step_s ? farthest_s / even.step_s : 0.0;
}

std::vector<double> interpolated(const std::vector<double>& time_s,
                                 const std::vector<double>& values, const EvenTimes& even) {
  constexpr std::size_t kNodes = 6;
  const std::size_t nodes = std::min(kNodes, time_s.size());
  std::vector<double> at_even;
  at_even.reserve(even.samples);
  std::size_t next = 0;  // the first sample after the time asked for
  for (std::size_t sample = 0; sample < even.samples; ++sample) {
    const double at_s = even.at(sample);
    while (next < time_s.size() && time_s[next] <= at_s) ++next;
    const std::size_t first = std::min(next - std::min(next, nodes / 2), time_s.size() - nodes);
    at_even.push_back(through(time_s, values, first, nodes, at_s));
  }
  return at_even;
}

}  // namespace kolsky
