#include "clients/cli/bar_model_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/settings/toml_table.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

constexpr double kNearEnough_K = 2.0;
constexpr std::size_t kParameters = 3;

void read_covariance(const TomlTable& table, BarPrior& prior) {
  if (!table.has("covariance")) {
    return;
  }
  const std::vector<double> numbers = table.numbers("covariance");
  if (numbers.size() != kParameters * kParameters) {
    throw table.error("covariance", fmt::format("has {} numbers", numbers.size()),
                      "give nine, row by row, of E1_Pa, E2_Pa and eta2_Pa_s");
  }
  for (std::size_t i = 0; i < kParameters; ++i) {
    for (std::size_t j = 0; j < kParameters; ++j) {
      const double value = numbers[i * kParameters + j];
      const double most =
          std::sqrt(numbers[i * (kParameters + 1)] * numbers[j * (kParameters + 1)]);
      if (std::abs(value - numbers[j * kParameters + i]) > 1e-6 * most ||
          std::abs(value) > most * (1.0 + 1e-6)) {
        throw table.error("covariance", "is not a covariance",
                          "give a symmetric matrix with no correlation above 1");
      }
      prior.covariance[i][j] = value;
    }
  }
}

}  // namespace

BarModelFile read_bar_model(const std::filesystem::path& path) {
  BarModelFile model{BarPrior(read_material(path)), path.string(), {}, {}};
  const TomlTable table = TomlTable::open(path);
  read_covariance(table, model.prior);
  if (const auto identified = table.optional_table("identified")) {
    model.prior.from_waves = true;
    model.band_limit_Hz = identified->optional_number("band_limit_Hz");
    model.temperature_K = identified->optional_number("temperature_K");
  }
  return model;
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

void require_temperature(const BarModelFile& model, const Shot& shot) {
  const std::optional<double> there = temperature_of(shot);
  if (model.temperature_K && there && std::abs(*there - *model.temperature_K) > kNearEnough_K) {
    throw InputError(model.name,
                     fmt::format("was identified at {:.1f} K, and capture {} was taken at {:.1f} K",
                                 *model.temperature_K, shot.id, *there),
                     fmt::format("identify the bars within {:.0f} K of the shots", kNearEnough_K));
  }
}

std::string temperature_unchecked(const BarModelFile& model, const Shot& shot) {
  if (!model.temperature_K || temperature_of(shot)) {
    return "";
  }
  return fmt::format(
      "identified at {:.1f} K; what this shot's bars had is not on file: give temperature_K in the "
      "bench or the capture's meta",
      *model.temperature_K);
}

void require_density(const BarModelFile& model, const Bench& bench) {
  constexpr double kApart = 0.01;
  constexpr double kDeviations = 3.0;
  const Measured& identified = model.prior.material.density_kg_m3;
  for (const Bar* const bar : {&bench.input, bench.output ? &*bench.output : nullptr}) {
    if (bar == nullptr || bar->youngs_modulus_Pa) {
      continue;
    }
    const double apart = std::abs(identified - bar->density_kg_m3);
    if (apart > kApart * bar->density_kg_m3 &&
        apart > kDeviations * std::hypot(identified.sd, bar->density_kg_m3.sd)) {
      throw InputError(
          model.name,
          fmt::format("is of bars of {:.0f} kg/m3, and the bench's have {:.0f}", identified.value,
                      bar->density_kg_m3.value),
          "file the same density in both: moduli give the wave speed with the one they "
          "were identified with");
    }
  }
}

void require_band(const BarModelFile& model, std::optional<double> asked_Hz) {
  if (model.band_limit_Hz && asked_Hz && *asked_Hz > *model.band_limit_Hz) {
    throw InputError(model.name,
                     fmt::format("was identified up to {:.0f} Hz, and {:.0f} Hz are asked for",
                                 *model.band_limit_Hz, *asked_Hz),
                     "give a lower --band-limit, or identify the bars with shorter pulses");
  }
}

}  // namespace kolsky::cli
