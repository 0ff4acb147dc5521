#include "processing/criticism/verdict/parting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/criticism/fitting/moduli_starts.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/verdict/refits.hpp"

namespace kolsky {

namespace {

constexpr const char* kParting = "parting-faces";
constexpr double kFarOff = 10.0;  ///< deviations of what noise leaves

/// Deviation of what noise leaves of chi2.
double left_by_noise(const Studied& studied) {
  return std::sqrt(2.0 * studied.misfit.degrees_of_freedom);
}

Model with_parting(const Model& model) {
  Model parting = model;
  parting.effects.push_back(use_named(kParting));
  return parting;
}

/// Begun from where the model stands, and from where its moduli started: glued faces have led them
/// astray.
Studied parted(Study& study, const Studied& base, const Model& start) {
  Studied near = changed(study, base, with_parting(base.model));
  Model afresh = with_parting(start);
  start_moduli(afresh, study.campaign(), study.residuals());
  const Composition composition(afresh, study.campaign());
  Studied again =
      begun_at(study, near.model, carry(composition, composition.start(), near.composition));
  return again.fit.objective() < near.fit.objective() ? std::move(again) : std::move(near);
}

/// Of what the library's best explains, or what it leaves of it.
bool is_far_ahead(Study& study, const Studied& base, const Studied& parting,
                  const Studied& nearest) {
  constexpr double kAhead = 1.2;
  constexpr double kLess = 0.1;
  const double explained = base.fit.objective() - parting.fit.objective();
  const double by_library = base.fit.objective() - nearest.fit.objective();
  return explained > kAhead * std::max(0.0, by_library) ||
         (repeated_excess(study, nearest) > kFarOff * left_by_noise(nearest) &&
          repeated_excess(study, parting) < kLess * repeated_excess(study, nearest));
}

}  // namespace

std::optional<std::string> parting_in_place_of(Study& study, const Studied& base,
                                               const Model& start, const Studied& nearest) {
  if (study.campaign().bench.kind != BenchKind::shpb || base.model.find(kParting) != nullptr ||
      repeated_excess(study, base) < kFarOff * left_by_noise(base)) {
    return std::nullopt;
  }
  const Studied parting = parted(study, base, start);
  const double noise = noise_of(parting.misfit, study.campaign().shots.size());
  const double explained = (base.fit.objective() - parting.fit.objective()) / noise;
  if (explained < repeated_excess(study, parting) || !is_far_ahead(study, base, parting, nearest)) {
    return std::nullopt;
  }
  return fmt::format(
      "a specimen that takes no tension explains it, or most of it: its faces part wherever the "
      "bars would pull it (chi2 {:.3g} -> {:.3g}), and the library's best leaves more by far. "
      "`kolsky model add M.toml {}`, fit, and diagnose again",
      base.misfit.chi2_reduced, parting.misfit.chi2_reduced, kParting);
}

}  // namespace kolsky
