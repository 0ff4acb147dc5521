#include "drivers/files/time_axis.hpp"

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

}  // namespace kolsky
