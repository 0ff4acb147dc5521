#include "processing/criticism/search/confirmed_hum.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/quiet_slopes.hpp"
#include "processing/criticism/search/safeguards.hpp"

namespace kolsky {

namespace {

constexpr const char* kHum = "mains-hum";

/// Whether gauges pick a hum up alike, or each its own share of it.
enum class Shares { alike, own };

EffectUse hum_at(double frequency_Hz, Shares shares) {
  EffectUse hum = use_named(kHum);
  hum.per_shot = true;
  hum.alike = shares == Shares::alike;
  const auto& parameters = hum.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    hum.values[p].free = !parameters[p].auxiliary();
    hum.values[p].value = parameters[p].auxiliary() ? frequency_Hz : parameters[p].null_value;
  }
  bound_strengths(hum);
  return hum;
}

/// The same beside a hum, from where it is.
Studied beside(Study& study, const Studied& studied, const EffectUse& hum) {
  Model model = studied.model;
  model.effects = studied.composition.uses();
  model.effects.push_back(hum);
  Composition composition(model, study.campaign());
  ModelFit fit;
  fit.theta = carry(studied.composition, studied.fit.theta, composition);
  return study.refit({std::move(model), std::move(composition), std::move(fit), {}});
}

/// Whether the samples before the pulses slope so, as noise rarely does.
bool slopes_before(const Campaign& campaign, Shares shares) {
  return shares == Shares::alike ? log_chance_of_common_slopes(campaign) < kFalseClaim
                                 : std::ranges::min(log_chances_of_slopes(campaign)) < kFalseClaim;
}

std::optional<Studied> confirmed_hum(Study& study, const Studied& studied) {
  const Campaign& campaign = study.campaign();
  study.residuals().believe_quiet();
  for (const Shares shares : {Shares::alike, Shares::own}) {
    if (!slopes_before(campaign, shares)) {
      continue;
    }
    std::optional<Studied> best;
    for (const double mains_Hz : {50.0, 60.0}) {
      Studied own = beside(study, studied, hum_at(mains_Hz, shares));
      if (!best || own.fit.objective() < best->fit.objective()) {
        best = std::move(own);
      }
    }
    // The quiet holds it, too, and foretells as much noise that jumps.
    study.residuals().calibrate(best->composition, best->fit.theta, NoiseShown::what_quiet_hides);
    best = study.refit(*best);
    if (best->fit.converged && std::isfinite(best->fit.objective()) &&
        own_strengths_confirmed(*best, kHum, campaign, Claim::fresh)) {
      return best;
    }
  }
  return std::nullopt;
}

bool may_hum(Study& study, const Studied& studied) {
  const Campaign& campaign = study.campaign();
  if (campaign.shots.size() < 2 || studied.model.find(kHum) != nullptr) {
    return false;
  }
  for (std::size_t gauge = 0; gauge < campaign.gauges(); ++gauge) {
    if (study.residuals().noise().is_coarse(gauge)) {
      return false;
    }
  }
  return true;
}

}  // namespace

Studied judged(Study& study, Studied studied) {
  const std::optional<Studied> humming =
      may_hum(study, studied) ? confirmed_hum(study, studied) : std::nullopt;
  return study.beside_quiet(std::move(studied), humming ? &*humming : nullptr);
}

Studied judged_as_it_is(Study& study, const Model& model) {
  return judged(study, study.with_own_strengths(model));
}

}  // namespace kolsky
