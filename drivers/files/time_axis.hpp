#pragma once

#include "drivers/files/scope_table.hpp"

namespace kolsky {

/// Samples per second over the whole of a table's time axis, which must advance in even steps.
/// @throws InputError at the line of the first step that is not positive or 5 % off the median step
[[nodiscard]] double measured_rate_Hz(const ScopeTable& table);

/// That two tables are channels of one record: as many samples, from the same time to the same time
/// within 5 % of a step. @throws InputError
void require_same_time_axis(const ScopeTable& first, const ScopeTable& other);

}  // namespace kolsky
