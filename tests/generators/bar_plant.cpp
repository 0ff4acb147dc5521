#include <algorithm>
#include <functional>
#include <map>

#include "processing/base/error.hpp"
#include "tests/generators/bar_world.hpp"

namespace kolsky::testing {

namespace {

TrueGauge& gauge_of(std::vector<TrueGauge>& gauges, const HiddenEffect& effect) {
  const auto found = std::ranges::find(gauges, effect.gauge, &TrueGauge::name);
  if (found == gauges.end()) {
    throw InputError("--effect " + effect.name(), "no gauge is called \"" + effect.gauge + "\"",
                     "write the gauge behind the id, as gauge-position:g2");
  }
  return *found;
}

using Planter = std::function<void(TrueGauge&, const HiddenEffect&)>;

const std::map<std::string, Planter>& gauge_planters() {
  using G = TrueGauge;
  using H = HiddenEffect;
  static const std::map<std::string, Planter> planters{
      {"gauge-position", [](G& g, const H& e) { g.position_m += e.strength; }},
      {"gauge-factor", [](G& g, const H& e) { g.gain *= 1.0 + e.strength; }},
      {"channel-delay", [](G& g, const H& e) { g.delay_s += e.strength; }},
      {"amplifier-bandwidth", [](G& g, const H& e) { g.amplifier_tau_s = e.strength; }},
      {"baseline-drift", [](G& g, const H& e) { g.drift_per_s = e.strength; }},
      {"gauge-length", [](G& g, const H& e) { g.length_m = e.strength; }},
      {"crosstalk",
       [](G& g, const H& e) {
         g.crosstalk = e.strength;
         g.crosstalk_from = static_cast<int>(e.detail("from", 0.0));
       }},
      {"x-gauge-creep", [](G& g, const H& e) {
         g.creep = e.strength;
         g.creep_time_s = e.detail("time", 1e-4);
       }}};
  return planters;
}

const std::map<std::string, std::function<void(BarWorld&, const HiddenEffect&)>>& bar_planters() {
  using W = BarWorld;
  using H = HiddenEffect;
  static const std::map<std::string, std::function<void(W&, const H&)>> planters{
      {"second-relaxation",
       [](W& w, const H& e) {
         w.material.relaxation_per_Pa = e.strength;
         w.material.relaxation_time_s = e.detail("tau", w.material.relaxation_time_s);
       }},
      {"series-dashpot", [](W& w, const H& e) { w.material.fluidity_per_Pa_s = e.strength; }},
      {"fractional-damping", [](W& w, const H& e) { w.material.beta = e.strength; }},
      {"amplitude-dependence", [](W& w, const H& e) { w.material.per_peak_strain = e.strength; }},
      {"temperature", [](W& w, const H& e) { w.material.per_kelvin = e.strength; }},
      {"end-reflection", [](W& w, const H& e) { w.end_r = e.strength; }},
      {"geometric-dispersion", [](W& w, const H& e) { w.dispersive = e.strength != 0.0; }},
      {"bending",
       [](W& w, const H& e) {
         w.bending_m = e.strength;
         w.bends_as_deflection = e.detail("deflection", 0.0) != 0.0;
       }},
      {"bar-length", [](W& w, const H& e) { w.length_m += e.strength; }},
      {"bridge-nonlinearity", [](W& w, const H& e) { w.bridge_b = e.strength; }},
      {"mains-hum",
       [](W& w, const H& e) {
         w.hum.amplitude = e.strength;
         w.hum.frequency_Hz = e.detail("frequency", w.hum.frequency_Hz);
         for (TrueShot& shot : w.shots) {
           shot.hum_phase = e.detail("phase", shot.hum_phase);
         }
         w.hum.share.assign(w.gauges.size(), 1.0);
         for (std::size_t g = 1; g < w.gauges.size(); g += 2) {
           w.hum.share[g] = e.detail("others", 1.0);
         }
       }},
      {"x-clamp",
       [](W& w, const H& e) {
         w.clamp = e.strength;
         w.clamp_at_m = e.detail("at", w.clamp_at_m);
       }},
      {"x-taper", [](W& w, const H& e) { w.taper = e.strength; }},
      {"x-gain-compression", [](W& w, const H& e) { w.compression_cubic = e.strength; }},
      {"x-time-base", [](W& w, const H& e) { w.clock_wobble_s = e.strength; }}};
  return planters;
}

}  // namespace

void plant(BarWorld& world, const HiddenEffect& effect) {
  if (const auto found = gauge_planters().find(effect.id); found != gauge_planters().end()) {
    found->second(gauge_of(world.gauges, effect), effect);
    return;
  }
  const auto found = bar_planters().find(effect.id);
  if (found == bar_planters().end()) {
    throw InputError("--effect " + effect.name(), "is no effect of a bar campaign",
                     "see make_campaign --list");
  }
  found->second(world, effect);
}

KelvinChain TrueMaterial::chain(double dT_K, double peak_strain) const {
  const double warm = 1.0 - per_kelvin * dT_K;
  KelvinChain made = elastic
                         ? testing::elastic(E1_Pa * warm)
                         : fractional_three_element(E1_Pa * warm, E2_Pa * warm, eta2_Pa_s, beta);
  made.add_relaxation(relaxation_per_Pa, relaxation_time_s);
  made.elements.insert(made.elements.end(), further_branches.begin(), further_branches.end());
  made.add_flow(fluidity_per_Pa_s);
  return made.scaled(1.0 + per_peak_strain * peak_strain);
}

}  // namespace kolsky::testing
