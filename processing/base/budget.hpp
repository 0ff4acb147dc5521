#pragma once

#include <string>
#include <vector>

namespace kolsky {

/// What one source of doubt contributes to each of several numbers, in their order: a number's
/// standard deviation if nothing else were uncertain.
struct BudgetLine {
  std::string source;
  std::vector<double> sd;
  std::vector<double> share;  ///< of the sum of all lines' variances
};

}  // namespace kolsky
