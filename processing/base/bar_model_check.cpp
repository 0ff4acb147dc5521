#include "processing/base/bar_model_check.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string_view>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr double kDensityApart = 0.01;
constexpr double kDeviations = 3.0;
constexpr double kPoorChi2 = 2.0;  // far from 1
/// Densities of PMMA are from 1150 to 1200 kg/m3.
constexpr double kNoPmmaApart = 0.05;
constexpr const char* kOwnMaterial = "bars.output.material";

std::string with_decimals(double value, int decimals) {
  std::array<char, 64> text{};
  (void)std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

using OnBar = std::function<void(std::string_view, const Bar&)>;

void for_bars_of_the_model(const Bench& bench, const OnBar& use) {
  if (bench.input.takes_bar_model()) {
    use("input", bench.input);
  }
  if (bench.output && bench.output->takes_bar_model()) {
    use("output", *bench.output);
  }
}

void require_temperature(const Material& model, std::optional<double> there_K,
                         const std::string& place, const std::string& name) {
  const auto known_K = model.identified ? model.identified->temperature_K : std::nullopt;
  if (known_K && there_K && std::abs(*there_K - *known_K) > kNearEnough_K) {
    throw InputError(
        name,
        "was identified at " + with_decimals(*known_K, 1) + " K, and " + place + " at " +
            with_decimals(*there_K, 1) + " K",
        "identify the bars within " + with_decimals(kNearEnough_K, 0) + " K of the shots");
  }
}

void require_moduli(const Material& model, const Bench& bench, const std::string& name) {
  if (takes_bar_model(bench)) {
    require_passive(model, name);
  }
  for_bars_of_the_model(
      bench, [&](std::string_view, const Bar& bar) { require_density(model, bar, name); });
}

}  // namespace

void require_passive(const Material& model, const std::string& name) {
  if (model.identified && !model.identified->passive) {
    throw InputError(name + ": identified.passive",
                     "is false: the waves it was identified from grow on their way, which no bar "
                     "lets them do",
                     "check the gauge factors and the order of the gauges of those shots, and "
                     "identify the bars again");
  }
}

void require_density(const Material& model, const Bar& bar, const std::string& name) {
  const Measured& identified = model.density_kg_m3;
  const double apart = std::abs(identified - bar.density_kg_m3);
  if (apart > kDensityApart * bar.density_kg_m3 &&
      apart > kDeviations * std::hypot(identified.sd, bar.density_kg_m3.sd)) {
    throw InputError(name,
                     "is of bars of " + with_decimals(identified, 0) +
                         " kg/m3, and the bench's have " + with_decimals(bar.density_kg_m3, 0),
                     "file the same density in both: moduli give the wave speed with the one "
                     "they were identified with");
  }
}

std::optional<double> temperature_of(const Shot& shot) {
  const auto fact = shot.meta.find("temperature_K");
  if (fact == shot.meta.end()) {
    return shot.bench.temperature_K ? std::optional(shot.bench.temperature_K->value) : std::nullopt;
  }
  char* end = nullptr;
  const double value = std::strtod(fact->second.c_str(), &end);
  if (end == fact->second.c_str() || *end != '\0' || !(value > 0.0) || !std::isfinite(value)) {
    throw InputError("capture " + shot.id + ": meta temperature_K",
                     "\"" + fact->second + "\" is no temperature", "give kelvins, as 296.5");
  }
  return value;
}

void require_bar_model_holds(const Material& model, const Bench& bench, const std::string& name) {
  require_moduli(model, bench, name);
  if (takes_bar_model(bench) && bench.temperature_K) {
    require_temperature(model, bench.temperature_K->value, "the bench is filed", name);
  }
}

void require_bar_model_holds(const Material& model, const Shot& shot, const std::string& name) {
  require_moduli(model, shot.bench, name);
  if (takes_bar_model(shot.bench)) {
    require_temperature(model, temperature_of(shot), "capture " + shot.id + " was taken", name);
  }
}

void require_own_material_holds(const Shot& shot) {
  if (shot.bench.output && shot.bench.output->material) {
    require_temperature(*shot.bench.output->material, temperature_of(shot),
                        "capture " + shot.id + " was taken", kOwnMaterial);
  }
}

void require_own_material_holds(const Bench& bench) {
  if (bench.output && bench.output->material && bench.temperature_K) {
    require_temperature(*bench.output->material, bench.temperature_K->value, "the bench is filed",
                        kOwnMaterial);
  }
}

std::optional<double> known_band_Hz(const Bench& bench, const Material& bar_model) {
  std::optional<double> known_Hz;
  const auto take = [&](const Material& material) {
    const auto limit_Hz = material.identified ? material.identified->band_limit_Hz : std::nullopt;
    if (limit_Hz && (!known_Hz || *limit_Hz < *known_Hz)) {
      known_Hz = limit_Hz;
    }
  };
  if (takes_bar_model(bench)) {
    take(bar_model);
  }
  if (bench.output && bench.output->material) {
    take(*bench.output->material);
  }
  return known_Hz;
}

void require_own_band_known(const Bench& bench, std::optional<double> asked_Hz) {
  if (bench.output && bench.output->material) {
    require_band_known(*bench.output->material, asked_Hz, kOwnMaterial);
  }
}

void require_band_known(const Material& model, std::optional<double> asked_Hz,
                        const std::string& name) {
  const auto known_Hz = model.identified ? model.identified->band_limit_Hz : std::nullopt;
  if (known_Hz && asked_Hz && *asked_Hz > *known_Hz) {
    throw InputError(name,
                     "was identified up to " + with_decimals(*known_Hz, 0) + " Hz, and " +
                         with_decimals(*asked_Hz, 0) + " Hz are asked for",
                     "ask for no more, or identify the bars with shorter pulses");
  }
}

std::string temperature_unchecked(const Material& model, const Shot& shot) {
  const auto known_K = model.identified ? model.identified->temperature_K : std::nullopt;
  if (!known_K || temperature_of(shot)) {
    return "";
  }
  return "identified at " + with_decimals(*known_K, 1) +
         " K; what this shot's bars had is not on file: give temperature_K in the bench or the "
         "capture's meta";
}

std::string poorly_identified(const Material& model) {
  const auto chi2 = model.identified ? model.identified->chi2_reduced : std::nullopt;
  if (!chi2 || *chi2 <= kPoorChi2) {
    return "";
  }
  return "identified by a fit that leaves " + with_decimals(*chi2, *chi2 < 10.0 ? 1 : 0) +
         " times what noise does (reduced chi2): its moduli may be off by more than their "
         "deviations";
}

Material assumed_bars(const Bench& bench) {
  Material pmma = paper_pmma();
  for_bars_of_the_model(bench, [&](std::string_view which, const Bar& bar) {
    const double off = bar.density_kg_m3 / pmma.density_kg_m3 - 1.0;
    if (std::abs(off) > kNoPmmaApart) {
      throw InputError(
          "bars." + std::string(which) + ".youngs_modulus_Pa",
          "is not filed, nor is a bar model given, and a bar of " +
              with_decimals(bar.density_kg_m3, 0) + " kg/m3 is not the paper's PMMA of " +
              with_decimals(pmma.density_kg_m3, 0) + " that would be assumed: " +
              with_decimals(100.0 * std::abs(off), 0) + " % " + (off > 0.0 ? "denser" : "lighter"),
          "file the modulus of an elastic bar, or give the bar model of a viscoelastic one");
    }
  });
  return pmma;
}

std::string viscoelastic_in_words(const Bench& bench, const std::optional<Material>& given) {
  std::string text;
  if (takes_bar_model(bench)) {
    text = !given ? assumed_bars(bench).source + ", assumed because no bar model was given"
           : given->source.empty() ? "the bar model given"
                                   : given->source;
  } else if (bench.input.youngs_modulus_Pa) {
    text = "elastic, modulus from the bench";
  }
  if (bench.output && bench.output->material) {
    const std::string& own = bench.output->material->source;
    text += "; output bar by itself: " + (own.empty() ? "as the bench has it" : own);
  }
  return text;
}

}  // namespace kolsky
