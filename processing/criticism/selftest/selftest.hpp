#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/criticism/impact/ball_runs.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

struct SelftestOptions {
  std::vector<std::string> effects;  ///< ids; empty: one of every kind that these shots can show
  std::vector<double> sizes;         ///< in the effect's unit; empty: `multiples`
  /// Of the smallest size that first-order theory calls identifiable; of the smallest detectable
  /// where an effect has a rival so near that the former is beyond its bounds.
  std::vector<double> multiples{0.5, 1.0, 2.0, 4.0};
  std::size_t nulls = 6;  ///< campaigns of fresh noise in which nothing is
  std::uint64_t seed = 1;
  double band_limit_Hz = 0.0;
  BallMeshes meshes;  ///< of a ball
  /// After each diagnosis; may come from several workers at once.
  std::function<void(std::size_t done, std::size_t all)> progress = [](std::size_t, std::size_t) {};
};

enum class PlantOutcome {
  named,    ///< and nothing else
  tied,     ///< in the set that was reported
  beside,   ///< named, and something that was not planted too
  unknown,  ///< misfit was seen, and not explained
  wrong,    ///< another effect was named
  unseen,   ///< adequate
  unusable  ///< so large that the records no longer serve
};

[[nodiscard]] std::string name_of(PlantOutcome outcome);

/// One size of one effect.
struct PlantedSize {
  double size = 0.0;      ///< off its null, in the parameter's unit
  double multiple = 0.0;  ///< of the smallest identifiable size; 0 where that is beyond bounds
  PlantOutcome outcome = PlantOutcome::unseen;
  std::vector<std::string> said;
  double strength = 0.0;  ///< found, where it was named
  double sd = 0.0;

  /// Named, or in the reported set.
  [[nodiscard]] bool found() const;
};

struct PlantedEffect {
  std::string id;
  std::string parameter;
  std::string unit;
  double identifiable = 0.0;  ///< as first-order theory has it on these shots
  double detectable = 0.0;    ///< likewise
  std::string skipped;        ///< why nothing was planted; empty where it was
  std::vector<PlantedSize> sizes;

  /// The smallest size from which on every one was found; infinite where the largest was not.
  [[nodiscard]] double smallest_found() const;
};

struct Selftest {
  DiagnosisVerdict untouched = DiagnosisVerdict::adequate;
  std::vector<std::string> untouched_effects;
  std::size_t nulls = 0;
  std::size_t false_claims = 0;   ///< of the nulls
  std::size_t false_unknown = 0;  ///< of the nulls
  std::vector<std::string> falsely_claimed;
  std::vector<PlantedEffect> effects;

  /// The bench's power curve: at a multiple of the smallest identifiable size, how many were found,
  /// of how many.
  struct Power {
    double multiple = 0.0;
    std::size_t found = 0;
    std::size_t planted = 0;
  };
  [[nodiscard]] std::vector<Power> power() const;
};

/// Plants effects into measured shots and lets `diagnose` look for them; one diagnosis per worker
/// at a time. Optimistic: planted by the very models that look (see Planter).
/// @param model  what the shots are to be explained by; fitted to them first
/// @throws InputError as read_campaign, or where an effect asked for does not exist
[[nodiscard]] Selftest selftest(const std::vector<Shot>& shots, const Model& model,
                                const SelftestOptions& options, const Workers& workers);

}  // namespace kolsky
