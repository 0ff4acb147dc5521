#include "processing/criticism/impact/ball_runs.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/impact/bench_impact.hpp"
#include "processing/impact/impact.hpp"

namespace kolsky {

namespace {

impact::BallMaterial material_of(const BallLayer& layer, int reading, LawForm form) {
  impact::BallMaterial material;
  material.material.density_kg_m3 = {layer.density_kg_m3, 0.0};
  material.material.poisson_ratio = {layer.poisson_ratio, 0.0};
  material.material.E1_Pa() = {layer.solid.E1_Pa, 0.0};
  material.material.E2_Pa() = {layer.solid.E2_Pa, 0.0};
  material.material.eta2_Pa_s() = {layer.solid.eta2_Pa_s, 0.0};
  material.reading = static_cast<impact::Reading>(reading);
  material.nonlinearity = layer.nonlinearity;
  material.law =
      form == LawForm::cauchy ? impact::FiniteStrain::cauchy : impact::FiniteStrain::kirchhoff;
  if (!layer.solid.relaxations.empty()) {
    material.second = {layer.solid.relaxations[0].D_per_Pa, layer.solid.relaxations[0].tau_s};
  }
  return material;
}

void append(const BallLayer& layer, std::vector<double>& key) {
  key.insert(key.end(), {layer.solid.E1_Pa, layer.solid.E2_Pa, layer.solid.eta2_Pa_s,
                         layer.density_kg_m3, layer.poisson_ratio, layer.nonlinearity});
  // A relaxation of no compliance is none, whatever its time.
  double D_per_Pa = 0.0;
  double tau_s = 0.0;
  for (const Solid::Relaxation& relaxation : layer.solid.relaxations) {
    D_per_Pa = relaxation.D_per_Pa;
    tau_s = D_per_Pa > 0.0 ? relaxation.tau_s : 0.0;
  }
  key.insert(key.end(), {D_per_Pa, tau_s});
}

/// The effect whose number the solver refuses by a member of its model; others as they are.
std::string effect_at(const std::string& member) {
  const std::pair<const char*, const char*> effects[] = {
      {"layers[0].solid.nonlinearity", "core-nonlinearity"},
      {"layers[1].solid.nonlinearity", "cover-nonlinearity"},
      {"layers[0].solid", "three-element-core"},
      {"layers[1].solid", "three-element-cover"},
      {"layers[0].outer_diameter_m", "ball.core_diameter_m"},
      {"layers[1].outer_diameter_m", "ball.outer_diameter_m"},
      {"friction", "contact-friction"},
      {"offset_m", "off-centre-contact"}};
  for (const auto& [name, effect] : effects) {
    if (member == name) {
      return effect;
    }
  }
  return member;
}

/// Of a campaign's many speeds the one at which the model's ball is refused is to be known.
impact::ImpactHistory thrown(const impact::ImpactModel& model) {
  try {
    return impact::simulate(model);
  } catch (const InputError& error) {
    throw InputError(effect_at(error.place()),
                     error.problem() + ", thrown at " + in_words(model.speed_m_per_s, "m/s"),
                     error.mend());
  }
}

}  // namespace

std::shared_ptr<const BallRun> BallRuns::run(const BallScene& ball, double speed_m_per_s,
                                             std::size_t elements, LawForm form) {
  std::vector<double> key{speed_m_per_s,
                          static_cast<double>(elements),
                          form == LawForm::cauchy ? 1.0 : 0.0,
                          static_cast<double>(ball.reading),
                          ball.friction,
                          ball.offset_m,
                          ball.sabot_mass_kg,
                          ball.core_diameter_m,
                          ball.outer_diameter_m,
                          ball.heavier};
  append(ball.core, key);
  append(ball.cover, key);
  {
    const std::scoped_lock held(lock_);
    if (const auto found = known_.find(key); found != known_.end()) {
      return found->second;
    }
  }
  impact::ImpactModel model = impact::impact_on(bench_, material_of(ball.core, ball.reading, form),
                                                material_of(ball.cover, ball.reading, form),
                                                impact::TargetKind::dashpot, speed_m_per_s);
  const double filed_kg = impact::mass_kg(model.layers);
  model.layers[0].outer_diameter_m = ball.core_diameter_m;
  model.layers[1].outer_diameter_m = ball.outer_diameter_m;
  // A ball that was weighed keeps its mass however large it is.
  const double denser = bench_.ball->mass_kg ? filed_kg / impact::mass_kg(model.layers) : 1.0;
  for (impact::Layer& layer : model.layers) {
    layer.solid.density_kg_m3 *= denser * (1.0 + ball.heavier);
  }
  model.friction = ball.friction;
  model.offset_m = ball.offset_m;
  model.sabot_mass_kg = ball.sabot_mass_kg;
  model.elements = elements;
  model.output_interval_s = kRunStep_s;
  impact::ImpactHistory history = thrown(model);
  auto own = std::make_shared<BallRun>();
  own->force_N = std::move(history.force_N);
  own->rebound_m_per_s = history.rebound_speed_m_per_s;
  own->strained_share = history.strained_share.front();
  own->falling_share = *std::ranges::max_element(history.falling_share);
  const std::scoped_lock held(lock_);
  return known_.emplace(std::move(key), std::move(own)).first->second;
}

BallRun sum_of(const BallRun& a, double share, const BallRun& b) {
  BallRun sum = a;
  sum.force_N.resize(std::max(a.force_N.size(), b.force_N.size()), 0.0);
  for (std::size_t n = 0; n < b.force_N.size(); ++n) {
    sum.force_N[n] += share * b.force_N[n];
  }
  sum.rebound_m_per_s += share * b.rebound_m_per_s;
  return sum;
}

}  // namespace kolsky
