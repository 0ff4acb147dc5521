#include "processing/criticism/search/candidate_kinds.hpp"

#include <algorithm>

#include "processing/criticism/search/shot_strengths.hpp"

namespace kolsky {

bool is_harmonic(const EffectUse& use) {
  const auto& parameters = use.effect->about().parameters;
  constexpr double kMainsAtMost_Hz = 65.0;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].chosen && parameters[p].unit == "Hz") {
      return use.values[p].value > kMainsAtMost_Hz;
    }
  }
  return false;
}

bool at_one_gauge(const Candidate& a, const Candidate& b) {
  return !a.use.gauge.empty() && a.use.gauge == b.use.gauge && !a.frees_prior &&
         a.use.effect->about().stage == Stage::sensor;
}

bool is_other_mains(const Candidate& one, const Candidate& other) {
  const EffectUse& a = one.use;
  const EffectUse& b = other.use;
  return a.effect->about().quadrature && a.id() == b.id() && a.per_shot == b.per_shot &&
         a.alike == b.alike && !is_harmonic(a) && !is_harmonic(b);
}

bool is_switch(const Candidate& candidate) {
  const auto& parameters = candidate.use.effect->about().parameters;
  return std::any_of(parameters.begin(), parameters.end(),
                     [](const EffectParameter& parameter) { return parameter.is_switch; });
}

bool is_sudden(const Candidate& candidate) {
  return candidate.use.effect->about().parameters.front().sudden;
}

bool may_be_slow_noise(const Candidate& candidate) {
  const EffectUse& use = candidate.use;
  return use.per_shot && is_addition(*use.effect) && (use.alike || !use.effect->about().each_gauge);
}

bool has_shares(const Candidate& candidate) {
  const EffectUse& use = candidate.use;
  return use.per_shot && use.effect->about().quadrature && !use.alike;
}

bool of_material(const Candidate& candidate) {
  return candidate.use.effect->about().stage == Stage::material;
}

}  // namespace kolsky
