#include "tests/generators/hidden_effect.hpp"

#include <cstdlib>

#include "processing/base/error.hpp"

namespace kolsky::testing {

namespace {

double number(const std::string& place, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') {
    throw InputError("--effect " + place, "\"" + text + "\" is no number",
                     "write ID=STRENGTH[,key=value], as gauge-position:g3=0.002");
  }
  return value;
}

}  // namespace

double HiddenEffect::detail(const std::string& key, double otherwise) const {
  const auto found = details.find(key);
  return found == details.end() ? otherwise : found->second;
}

std::string HiddenEffect::name() const {
  return gauge.empty() ? id : id + ":" + gauge;
}

HiddenEffect parse_effect(const std::string& text) {
  HiddenEffect effect;
  const std::size_t equals = text.find('=');
  effect.id = text.substr(0, equals);
  const std::size_t colon = effect.id.find(':');
  if (colon != std::string::npos) {
    effect.gauge = effect.id.substr(colon + 1);
    effect.id.resize(colon);
  }
  std::string rest = equals == std::string::npos ? "" : text.substr(equals + 1);
  std::size_t comma = rest.find(',');
  effect.strength = number(text, rest.substr(0, comma));
  while (comma != std::string::npos) {
    rest = rest.substr(comma + 1);
    comma = rest.find(',');
    const std::string pair = rest.substr(0, comma);
    const std::size_t sign = pair.find('=');
    effect.details[pair.substr(0, sign)] =
        number(text, sign == std::string::npos ? "" : pair.substr(sign + 1));
  }
  return effect;
}

const std::vector<EffectKind>& bar_effects() {
  static const std::vector<EffectKind> kinds{
      {"second-relaxation", "1/Pa", 0.0, 3e-12, false, true},
      {"series-dashpot", "1/(Pa s)", 0.0, 1e-8, false, true},
      {"fractional-damping", "-", 1.0, 0.95, false, true},
      {"amplitude-dependence", "-", 0.0, 2.0, false, false},
      {"temperature", "1/K", 0.0, 3e-3, false, false},
      {"geometric-dispersion", "-", 0.0, 1.0, false, false},
      {"bending", "m", 0.0, 2e-4, false, false},
      {"end-reflection", "-", 0.0, 0.05, false, true},
      {"gauge-position", "m", 0.0, 1e-3, true, false},
      {"gauge-factor", "-", 0.0, 0.01, true, false},
      {"channel-delay", "s", 0.0, 0.5e-6, true, false},
      {"amplifier-bandwidth", "s", 0.0, 0.5e-6, true, true},
      {"baseline-drift", "1/s", 0.0, 0.02, true, false},
      {"gauge-length", "m", 0.0, 0.01, true, true},
      {"crosstalk", "-", 0.0, 0.01, true, false},
      {"mains-hum", "strain", 0.0, 1e-5, false, true},
      {"bridge-nonlinearity", "-", 0.0, 1.0, false, false},
      {"x-clamp", "-", 0.0, 0.5, false, true, true},
      {"x-taper", "1/m", 0.0, 0.03, false, false, true},
      {"x-gauge-creep", "-", 0.0, 0.03, true, true, true},
      {"x-gain-compression", "-", 0.0, 2e-3, false, true, true},
      {"x-time-base", "s", 0.0, 0.3e-6, false, true, true}};
  return kinds;
}

const std::vector<EffectKind>& shpb_effects() {
  static const std::vector<EffectKind> kinds{
      {"specimen-second-relaxation", "1/Pa", 0.0, 5e-10, false, true},
      {"specimen-nonlinearity", "-", 0.0, 1.0, false, false},
      {"specimen-inertia", "-", 0.0, 1.0, false, true},
      {"radial-inertia", "-", 0.0, 1.0, false, true},
      {"interface-friction", "-", 0.0, 0.05, false, true},
      {"interface-gap", "m", 0.0, 10e-6, false, true},
      {"punching", "-", 0.0, 1.0, false, true},
      {"bar-length", "m", 0.0, 2e-3, false, false},
      {"specimen-dimensions", "m", 0.0, 1e-4, false, false},
      {"second-relaxation", "1/Pa", 0.0, 3e-12, false, true},
      {"temperature", "1/K", 0.0, 3e-3, false, false},
      {"gauge-position", "m", 0.0, 1e-3, true, false},
      {"gauge-factor", "-", 0.0, 0.01, true, false},
      {"channel-delay", "s", 0.0, 0.5e-6, true, false},
      {"amplifier-bandwidth", "s", 0.0, 0.5e-6, true, true},
      {"baseline-drift", "1/s", 0.0, 0.02, true, false},
      {"gauge-length", "m", 0.0, 0.01, true, true},
      {"crosstalk", "-", 0.0, 0.01, true, false},
      {"mains-hum", "strain", 0.0, 1e-5, false, true},
      {"bridge-nonlinearity", "-", 0.0, 1.0, false, false},
      {"x-face-layer", "m/N", 0.0, 1e-8, false, true, true},
      {"x-permanent-strain", "-", 0.0, 0.1, false, true, true},
      {"x-softening", "m3/J", 0.0, 3e-7, false, true, true},
      {"x-gauge-creep", "-", 0.0, 0.03, true, true, true},
      {"x-time-base", "s", 0.0, 0.3e-6, false, true, true}};
  return kinds;
}

}  // namespace kolsky::testing
