#pragma once

#include <map>
#include <string>
#include <vector>

namespace kolsky::testing {

/// An effect that a campaign hides: the id of the reference (or of the withheld ones), its strength
/// in the reference's unit, and whatever else it needs.
struct HiddenEffect {
  std::string id;
  std::string gauge;  ///< of an effect on one channel
  double strength = 0.0;
  std::map<std::string, double> details;  ///< "tau", "frequency", "time"

  [[nodiscard]] double detail(const std::string& key, double otherwise) const;
  /// As the interface writes it: "gauge-position:g3".
  [[nodiscard]] std::string name() const;
};

/// Reads "gauge-position:g3=0.002" or "second-relaxation=2e-12,tau=3e-4".
/// @throws InputError
[[nodiscard]] HiddenEffect parse_effect(const std::string& text);

/// What is known of an effect beforehand.
struct EffectKind {
  std::string id;
  std::string unit;
  double null = 0.0;
  double typical = 0.0;  ///< a size that a laboratory may meet
  bool per_gauge = false;
  bool one_sided = false;  ///< the strength cannot go below its null (or above it: beta)
  bool withheld = false;   ///< not in the library of effects
};

[[nodiscard]] const std::vector<EffectKind>& bar_effects();
[[nodiscard]] const std::vector<EffectKind>& shpb_effects();

}  // namespace kolsky::testing
