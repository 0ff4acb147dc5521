#include "processing/criticism/impact/rival_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// What the library has of a ball's materials beyond the model.
std::vector<std::string> of_materials(const Model& model) {
  std::vector<std::string> list;
  for (const Effect* effect : effect_library()) {
    const EffectAbout& about = effect->about();
    if (!about.base && about.stage == Stage::specimen && model.find(about.id) == nullptr &&
        std::ranges::count(about.kinds, BenchKind::impact) > 0) {
      list.push_back(about.id);
    }
  }
  return list;
}

/// @return nothing where the solver refuses all that is near
std::optional<Studied> fitted_with(ImpactStudy& study, Model model, const std::string& id) {
  model.effects.push_back(use_named(id));
  try {
    return study.settled(study.refit(model, study.executor()), Settle::roughly);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<std::string> better_of_materials(
    ImpactStudy& study, const Model& first, const Studied& current, const std::string& claimed,
    const std::function<void(const std::string&)>& progress) {
  std::optional<std::string> better;
  for (const std::string& id : of_materials(first)) {
    if (id == claimed) {
      continue;
    }
    progress(fmt::format("fitting {} in the place of {}", id, claimed));
    const auto other = fitted_with(study, first, id);
    if (other && other->fit.objective() < current.fit.objective() - kStandsBefore * kSolverDoubt) {
      better = id;
      break;
    }
  }
  study.residuals().anchor(current.composition, current.fit.theta,
                           ImpactResiduals::AnchorBy::middle);
  return better;
}

}  // namespace kolsky
