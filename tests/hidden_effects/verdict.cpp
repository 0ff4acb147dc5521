#include "tests/hidden_effects/verdict.hpp"

#include <algorithm>
#include <functional>

namespace kolsky::scoring {

namespace {

using Json = nlohmann::json;

std::optional<double> number_at(const Json& json, const std::string& key) {
  if (json.is_object() && json.contains(key) && json.at(key).is_number()) {
    return json.at(key).get<double>();
  }
  return std::nullopt;
}

std::string text_at(const Json& json, const std::string& key) {
  return json.is_object() && json.contains(key) && json.at(key).is_string()
             ? json.at(key).get<std::string>()
             : "";
}

void read_sets(Verdict& verdict, const Json& json) {
  for (const Json& effect : json.value("effects", Json::array())) {
    const std::string name = effect.get<std::string>();
    verdict.named.push_back(name);
    std::set<std::string> members{name};
    const Json tied = json.value("tied_with", Json::object());
    for (const Json& other : tied.value(name, Json::array())) {
      members.insert(other.get<std::string>());
    }
    verdict.set_size += static_cast<double>(members.size());
    verdict.sets.push_back(std::move(members));
  }
  if (!verdict.sets.empty()) {
    verdict.set_size /= static_cast<double>(verdict.sets.size());
  }
}

// Each truth needs a set of its own.
int matched(const std::vector<std::string>& truth, std::vector<std::set<std::string>> sets) {
  int found = 0;
  for (const std::string& name : truth) {
    const auto holder = std::ranges::find_if(
        sets, [&](const std::set<std::string>& members) { return members.contains(name); });
    if (holder != sets.end()) {
      sets.erase(holder);
      ++found;
    }
  }
  return found;
}

std::optional<double> closure_of(const Json& json) {
  const Json held_out = json.value("misfit", Json::object()).value("held_out", Json::object());
  const auto before = number_at(held_out, "before");
  const auto after = number_at(held_out, "after");
  const auto floor = number_at(held_out, "floor");
  if (!before || !after || !floor || *before <= *floor) {
    return std::nullopt;
  }
  return (*before - *after) / (*before - *floor);
}

// What is filed is off by what was drawn within its deviation and by what was hidden: an analyser
// can only find both together.
double true_strength(const testing::Campaign& campaign, const testing::HiddenEffect& effect) {
  const auto& gauges = campaign.world.gauges;
  for (std::size_t g = 0; g < gauges.size() && g < campaign.bench.gauges.size(); ++g) {
    if (gauges[g].name == effect.gauge && effect.id == "gauge-position") {
      return gauges[g].position_m - campaign.bench.gauges[g].position_m;
    }
    if (gauges[g].name == effect.gauge && effect.id == "gauge-factor") {
      return gauges[g].gain - 1.0;
    }
  }
  if (campaign.split && effect.id == "specimen-dimensions" &&
      effect.detail("diameter", 0.0) == 0.0) {
    return campaign.split->specimen.length_m - campaign.bench.specimen->length_m;
  }
  return effect.strength;
}

std::optional<double> strength_error(const Json& json, const testing::Campaign& campaign,
                                     const testing::HiddenEffect& effect) {
  for (const Json& candidate : json.value("candidates", Json::array())) {
    const auto strength = number_at(candidate, "strength");
    const auto sd = number_at(candidate, "sd");
    if (text_at(candidate, "effect") == effect.name() && strength && sd && *sd > 0.0) {
      return (*strength - true_strength(campaign, effect)) / *sd;
    }
  }
  return std::nullopt;
}

/// That of one effect which can be tested at all: those of one campaign hang together.
std::optional<double> one_p_of(const Json& diagnosis, const std::string& id) {
  std::vector<double> chances;
  for (const Json& candidate : diagnosis.value("candidates", Json::array())) {
    const auto chance = number_at(candidate, "p_value");
    if (text_at(candidate, "verdict") != "untestable" && chance) {
      chances.push_back(*chance);
    }
  }
  if (chances.empty()) {
    return std::nullopt;
  }
  return chances[std::hash<std::string>{}(id) % chances.size()];
}

}  // namespace

Verdict judge(const Case& drawn, const Answer& answer) {
  Verdict verdict;
  verdict.id = drawn.id;
  verdict.kind = drawn.kind;
  for (const testing::HiddenEffect& effect : drawn.campaign.effects) {
    verdict.truth.push_back(effect.name());
  }
  verdict.multiples = drawn.multiples;
  verdict.seconds = answer.seconds;
  verdict.error = answer.error.substr(0, 300);
  if (answer.code != 0 || !answer.json.is_object()) {
    verdict.answered = answer.code == 124 ? "timeout" : "failed";
    return verdict;
  }
  verdict.answered = text_at(answer.json, "verdict");
  read_sets(verdict, answer.json);
  verdict.found = matched(verdict.truth, verdict.sets);
  std::vector<std::string> names = verdict.named;
  std::vector<std::string> truth = verdict.truth;
  std::ranges::sort(names);
  std::ranges::sort(truth);
  verdict.exact = !truth.empty() && names == truth && verdict.set_size == 1.0;
  verdict.closure = closure_of(answer.json);
  if (drawn.kind == CaseKind::single && verdict.found == 1) {
    verdict.strength_in_sd =
        strength_error(answer.json, drawn.campaign, drawn.campaign.effects.front());
  }
  if (drawn.kind == CaseKind::null) {
    verdict.null_p = one_p_of(answer.json, drawn.id);
  }
  return verdict;
}

std::string proposal_of(const Answer& answer) {
  for (const Json& proposed : answer.json.value("next_experiment", Json::array())) {
    if (std::string change = text_at(proposed, "change"); !change.empty()) {
      return change;
    }
  }
  return "";
}

void judge_refit(Verdict& verdict, const Case& drawn, const Answer& fit) {
  const testing::Campaign& campaign = drawn.campaign;
  std::vector<std::pair<std::string, double>> moduli{
      {"E1_Pa", campaign.world.material.E1_Pa},
      {"E2_Pa", campaign.world.material.E2_Pa},
      {"eta2_Pa_s", campaign.world.material.eta2_Pa_s}};
  if (campaign.split) {
    moduli = {{"E1_Pa", campaign.split->specimen.E1_Pa},
              {"E2_Pa", campaign.split->specimen.E2_Pa},
              {"eta2_Pa_s", campaign.split->specimen.eta2_Pa_s}};
  }
  if (fit.code != 0 || !fit.json.is_object()) {
    return;
  }
  const Json parameters = fit.json.value("parameters", Json::object());
  for (const auto& [name, truth] : moduli) {
    for (const auto& [key, parameter] : parameters.items()) {
      const std::string called = parameters.is_array() ? text_at(parameter, "name") : key;
      const auto value = number_at(parameter, "value");
      const auto sd = number_at(parameter, "sd");
      const bool of_bars = campaign.split && called.find("bar") != std::string::npos;
      if (called.ends_with(name) && !of_bars && value && sd && *sd > 0.0) {
        verdict.moduli_in_sd.push_back((*value - truth) / *sd);
        break;
      }
    }
  }
}

Json json_of(const Verdict& verdict) {
  Json json{{"id", verdict.id},
            {"kind", name_of(verdict.kind)},
            {"truth", verdict.truth},
            {"multiples", verdict.multiples},
            {"answered", verdict.answered},
            {"named", verdict.named},
            {"sets", verdict.sets},
            {"found", verdict.found},
            {"exact", verdict.exact},
            {"set_size", verdict.set_size},
            {"moduli_in_sd", verdict.moduli_in_sd},
            {"curve_in_sd", verdict.curve_in_sd},
            {"proposal", verdict.proposal},
            {"seconds", verdict.seconds},
            {"error", verdict.error}};
  if (verdict.closure) {
    json["closure"] = *verdict.closure;
  }
  if (verdict.strength_in_sd) {
    json["strength_in_sd"] = *verdict.strength_in_sd;
  }
  if (verdict.tie_broken) {
    json["tie_broken"] = *verdict.tie_broken;
  }
  if (verdict.places) {
    json["places"] = json_of(*verdict.places);
  }
  if (verdict.null_p) {
    json["null_p"] = *verdict.null_p;
  }
  return json;
}

}  // namespace kolsky::scoring
