#include "processing/criticism/fitting/moduli_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/fit.hpp"
#include "processing/reduction/first_pulse.hpp"

namespace kolsky {

namespace {

constexpr const char* kBar = "three-element-bar";
constexpr const char* kSpecimen = "three-element-specimen";

/// Half-height crossing of a gauge's first pulse [s from the first sample]; negative for none.
double arrival_s(const CampaignShot& shot, std::size_t gauge, double period_s) {
  const auto pulse = first_pulse(shot.strain[gauge], 1.0 / period_s);
  return pulse ? static_cast<double>(pulse->rise) * period_s : -1.0;
}

/// Wave speed on the input bar from the first gauge to the last, 0 where it cannot be told.
double measured_speed(const Campaign& campaign) {
  const std::size_t first = campaign.reference;
  std::size_t last = first;
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    const Gauge& gauge = campaign.bench.gauges[j];
    if (gauge.bar != "output" && gauge.position_m > campaign.bench.gauges[last].position_m) {
      last = j;
    }
  }
  if (last == first) {
    return 0.0;
  }
  const double distance_m =
      campaign.bench.gauges[last].position_m - campaign.bench.gauges[first].position_m;
  std::vector<double> speeds;
  for (const CampaignShot& shot : campaign.shots) {
    const double a = arrival_s(shot, first, campaign.period_s);
    const double b = arrival_s(shot, last, campaign.period_s);
    if (a >= 0.0 && b > a) {
      speeds.push_back(distance_m / (b - a));
    }
  }
  if (speeds.empty()) {
    return 0.0;
  }
  std::nth_element(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2),
                   speeds.end());
  return speeds[speeds.size() / 2];
}

double chi2_of(const Model& model, const Campaign& campaign, WhiteResiduals& residuals,
               std::size_t worker) {
  const Composition composition(model, campaign);
  return residuals.evaluate(composition, composition.start(), worker).squaredNorm();
}

/// Scales three moduli together by powers of `ratio` around where they are; keeps the best.
void search_moduli(Model& model, const std::string& id, double ratio, int reach,
                   const Campaign& campaign, WhiteResiduals& residuals, std::size_t worker) {
  const EffectUse start = *model.find(id);
  double best = std::numeric_limits<double>::infinity();
  EffectUse kept = start;
  for (int i = -reach; i <= reach; ++i) {
    EffectUse* use = model.find(id);
    for (std::size_t p = 0; p < 3; ++p) {
      use->values[p].value = start.values[p].value * std::pow(ratio, i);
    }
    const double chi2 = chi2_of(model, campaign, residuals, worker);
    if (chi2 < best) {
      best = chi2;
      kept = *use;
    }
  }
  *model.find(id) = kept;
}

bool all_free(const EffectUse& use) {
  return std::all_of(use.values.begin(), use.values.end(),
                     [](const ModelValue& value) { return value.free; });
}

bool was_fitted(const EffectUse& use) {
  return std::ranges::any_of(use.values, [](const ModelValue& value) { return value.sd > 0.0; });
}

/// Where fits begin of a branch that does little: next to one that does as much as the spring they
/// end in a valley in which E1 and E2 grow and the time falls without end. (A specimen of
/// 0.5 and 70 GPa was left 300 squares of deviates short.)
constexpr double kStiffBranch = 100.0;  ///< E2 over E1
constexpr std::array kBranchTimes_s{30e-6, 100e-6};

}  // namespace

void start_moduli(Model& model, const Campaign& campaign, WhiteResiduals& residuals,
                  std::size_t worker) {
  EffectUse* bar = model.find(kBar);
  if (bar != nullptr && all_free(*bar) && campaign.bench.kind == BenchKind::bar) {
    const double speed = measured_speed(campaign);
    if (speed > 0.0) {
      const double rho = campaign.bench.input.density_kg_m3;
      // A pulse travels between the relaxed and the instantaneous speed.
      constexpr double kAboveMeasured = 1.08;
      const double scale = kAboveMeasured * rho * speed * speed / bar->values[0].value;
      if (std::abs(scale - 1.0) > 0.1) {
        for (ModelValue& value : bar->values) {
          value.value *= scale;
        }
      }
    }
    search_moduli(model, kBar, 1.03, 5, campaign, residuals, worker);
  }
  EffectUse* specimen = model.find(kSpecimen);
  if (specimen != nullptr && all_free(*specimen)) {
    search_moduli(model, kSpecimen, 2.0, 14, campaign, residuals, worker);
  }
}

void start_branch(Model& model, const Campaign& campaign, WhiteResiduals& residuals,
                  const Workers& executor) {
  const EffectUse* given = model.find(kSpecimen);
  if (given == nullptr || !all_free(*given) || was_fitted(*given)) {
    return;
  }
  const EffectUse start = *given;
  const Composition begun(model, campaign);
  residuals.freeze(begun, begun.start());
  const auto fitted_from_here = [&] {
    const Composition composition(model, campaign);
    const ModelFit fit = fit_model(composition, residuals, executor);
    EffectUse specimen = *fitted(model, composition, fit).find(kSpecimen);
    for (ModelValue& value : specimen.values) {
      value.sd = 0.0;
    }
    return std::pair(fit.objective(), std::move(specimen));
  };
  double least = fitted_from_here().first;
  EffectUse best = start;
  for (const double time_s : kBranchTimes_s) {
    EffectUse& trial = *model.find(kSpecimen);
    trial = start;
    trial.values[1].value = kStiffBranch * start.values[0].value;
    trial.values[2].value = time_s * trial.values[1].value;
    auto [objective, specimen] = fitted_from_here();
    constexpr double kBetter = 1.0;  // of chi2, over what is left per residual
    const double misfit = std::max(1.0, objective / static_cast<double>(residuals.size()));
    if (!std::isfinite(least) || objective < least - kBetter * misfit) {
      least = objective;
      best = std::move(specimen);
    }
  }
  *model.find(kSpecimen) = best;
}

}  // namespace kolsky
