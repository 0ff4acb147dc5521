#include "processing/criticism/impact/rival_readings.hpp"

#include <array>
#include <cmath>

namespace kolsky {

namespace {

constexpr std::array kNames{"full", "bulk-E1", "bulk-Einf", "exact"};

std::size_t index_of(const EffectUse& reading) {
  return static_cast<std::size_t>(std::lround(reading.values[0].value));
}

double objective_with(ImpactStudy& study, const Model& model, std::size_t reading,
                      const Workers& executor, Settle settle) {
  Model other = model;
  other.find(kReadingEffect)->values[0].value = static_cast<double>(reading);
  return study.refit(other, executor, settle).fit.objective();
}

}  // namespace

std::optional<std::string> reading_of(const Model& model) {
  const EffectUse* own = model.find(kReadingEffect);
  return own != nullptr ? std::optional<std::string>(kNames.at(index_of(*own))) : std::nullopt;
}

std::optional<RivalReading> best_rival_reading(ImpactStudy& study, const Model& model,
                                               double objective, double scale,
                                               const AnchoredAt* there, const AnchoredAt* back) {
  const EffectUse* own = model.find(kReadingEffect);
  if (own == nullptr) {
    return std::nullopt;
  }
  const std::size_t now = index_of(*own);
  std::array<double, kNames.size()> objectives{};
  if (there != nullptr) {
    study.residuals().anchor(there->composition, there->theta);
  }
  study.executor().run(kNames.size(), [&](std::size_t r, std::size_t worker) {
    if (r != now) {
      objectives[r] = objective_with(study, model, r, serial_on(worker), Settle::roughly);
    }
  });
  std::size_t best = now;
  for (std::size_t r = 0; r < kNames.size(); ++r) {
    if (r != now && std::isfinite(objectives[r]) &&
        (best == now || objectives[r] < objectives[best])) {
      best = r;
    }
  }
  constexpr double kRoughlyKnown = 1.0;
  const auto behind = [&] { return (objectives[best] - objective) / scale; };
  if (best != now && std::abs(std::abs(behind()) - kStandsBefore) < kRoughlyKnown) {
    objectives[best] = objective_with(study, model, best, study.executor(), Settle::fully);
  }
  if (back != nullptr) {
    study.residuals().anchor(back->composition, back->theta, ImpactResiduals::AnchorBy::middle);
  }
  return best == now ? std::nullopt
                     : std::optional<RivalReading>(RivalReading{kNames.at(best), behind()});
}

}  // namespace kolsky
