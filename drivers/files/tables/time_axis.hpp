#pragma once

#include <cstddef>
#include <vector>

#include "drivers/files/tables/scope_table.hpp"

namespace kolsky {

/// Where the samples of a record are taken to lie.
struct EvenTimes {
  double first_s = 0.0;
  double step_s = 0.0;
  std::size_t samples = 0;

  [[nodiscard]] double at(std::size_t sample) const {
    return first_s + step_s * static_cast<double>(sample);
  }
};

/// Samples per second over the whole of a table's time axis, which must advance in even steps.
/// @throws InputError at the line of the first step that is not positive or 5 % off the median step
[[nodiscard]] double measured_rate_Hz(const ScopeTable& table);

/// That two tables are channels of one record: as many samples, from the same time to the same time
/// within 5 % of a step. @throws InputError
void require_same_time_axis(const ScopeTable& first, const ScopeTable& other);

/// From a table's first time to its last, at a rate. @pre a table that `measured_rate_Hz` takes
[[nodiscard]] EvenTimes even_times(const ScopeTable& table, double rate_Hz);

/// How far a table's times lie off even ones at most, in steps; zero within the 5 % of a step that
/// they may scatter by.
[[nodiscard]] double farthest_off(const ScopeTable& table, const EvenTimes& even);

/// Values at even times, by the polynomial through the six samples about each.
[[nodiscard]] std::vector<double> interpolated(const std::vector<double>& time_s,
                                               const std::vector<double>& values,
                                               const EvenTimes& even);

}  // namespace kolsky
