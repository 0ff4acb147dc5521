#pragma once

#include <string>
#include <vector>

namespace kolsky {

/// ln of the chance of a false claim, or of a false "unknown": 0.3 %.
inline constexpr double kFalseClaim = -5.8;
/// ln of a chance that needs no search to be counted: 1e-5.
inline constexpr double kSure = -11.5;
/// ln of the least chance that is told: below 1e-12 normal noise is no longer what one knows it as.
inline constexpr double kLeastTold = -27.6;

/// What keeps a diagnosis from claiming what is not there. Each may be left out to see what it is
/// good for; a claim made without one of them is none.
struct Safeguards {
  bool search_count = true;
  bool held_out = true;
  bool shot_agreement = true;
  bool own_strengths = true;
  bool fitted_noise = true;
  bool slow_noise = true;
  bool backward = true;
  bool unknown = true;
};

/// One of them by the name that users know it by.
struct NamedSafeguard {
  std::string name;
  std::string purpose;  ///< in a line
  bool Safeguards::*member;
};

[[nodiscard]] const std::vector<NamedSafeguard>& named_safeguards();

/// Names of those that are left out.
[[nodiscard]] std::vector<std::string> left_out(const Safeguards& safeguards);

}  // namespace kolsky
