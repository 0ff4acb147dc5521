#include "processing/specimen/fit_warnings.hpp"

#include <cmath>

namespace kolsky {

std::vector<std::string> warnings_of(const std::vector<FittedNumber>& parameters) {
  constexpr double kHardly = 0.3;
  std::vector<std::string> warnings;
  for (const FittedNumber& p : parameters) {
    if (p.sd > kHardly * p.value) {
      warnings.push_back(p.name + " is hardly determined by these shots: its deviation is " +
                         std::to_string(std::lround(100.0 * p.sd / p.value)) + " %");
    }
  }
  return warnings;
}

std::vector<std::string> warnings_of(const std::vector<CompliancePoint>& spectrum) {
  constexpr double kClearly = 4.0;
  for (const CompliancePoint& p : spectrum) {
    if (p.J2_per_Pa < -kClearly * p.J2_sd_of_mean) {
      return {"J2 is negative at " + std::to_string(std::lround(p.frequency_Hz)) +
              " Hz: no passive material does that"};
    }
  }
  return {};
}

}  // namespace kolsky
