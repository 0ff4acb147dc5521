#pragma once

#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "processing/base/budget.hpp"

namespace kolsky::cli {

/// A list of sources: `source`, and for each number by its name `sd` and `share`.
[[nodiscard]] JsonList budget_json(const std::vector<BudgetLine>& budget,
                                   const std::vector<std::string>& numbers);

/// Shares of the variance as a table. @param heads  of the columns, by number
[[nodiscard]] std::string budget_table(const std::vector<BudgetLine>& budget,
                                       const std::vector<std::string>& heads);

}  // namespace kolsky::cli
