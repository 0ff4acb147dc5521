#pragma once

#include <string>
#include <vector>

namespace kolsky::testing {

/// The quiet beginning of a record, its mean taken off: "TABLE.csv:COLUMN:ROWS", columns from 1,
/// rows from the first that holds numbers. @throws InputError
[[nodiscard]] std::vector<double> measured_noise(const std::string& place);

}  // namespace kolsky::testing
