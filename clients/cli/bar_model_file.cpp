#include "clients/cli/bar_model_file.hpp"

#include "drivers/files/settings/material_file.hpp"
#include "processing/base/bar_model_check.hpp"

namespace kolsky::cli {

BarModelFile read_bar_model(const std::filesystem::path& path) {
  BarModelFile model{BarPrior(read_material(path)), path.string(), {}};
  if (const auto& identified = model.prior.material.identified) {
    model.band_limit_Hz = identified->band_limit_Hz;
  }
  return model;
}

void require_holds(const BarModelFile& model, const Shot& shot) {
  require_bar_model_holds(model.prior.material, shot, model.name);
}

void require_holds(const BarModelFile& model, const Bench& bench) {
  require_bar_model_holds(model.prior.material, bench, model.name);
}

void require_band(const BarModelFile& model, std::optional<double> asked_Hz) {
  require_band_known(model.prior.material, asked_Hz, model.name);
}

std::vector<std::string> doubts_of(const Material& model, const Shot& shot) {
  std::vector<std::string> doubts{temperature_unchecked(model, shot), poorly_identified(model)};
  std::erase(doubts, "");
  return doubts;
}

std::string doubts_in_brackets(const Material& model, const Shot& shot) {
  std::string text;
  for (const std::string& doubt : doubts_of(model, shot)) {
    text += " (" + doubt + ")";
  }
  return text;
}

}  // namespace kolsky::cli
