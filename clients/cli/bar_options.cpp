#include "clients/cli/bar_options.hpp"

#include <utility>

#include "processing/base/bar_model_check.hpp"

namespace kolsky::cli {

Argument bar_option(std::optional<std::string>* target) {
  Argument bar = option("--bar", "NAME", "input (default) or output", target);
  bar.choices = {"input", "output"};
  return bar;
}

Argument dispersion_option(std::string help, std::optional<std::string>* target,
                           const std::optional<std::string>& further) {
  Argument dispersion = option("--dispersion", "THEORY", std::move(help), target);
  dispersion.choices = {"elementary", "love", "exact"};
  if (further) {
    dispersion.choices.push_back(*further);
  }
  return dispersion;
}

Argument solid_option(std::string name, std::string help, std::optional<std::string>* target) {
  Argument solid = option(std::move(name), "FAMILY", std::move(help), target);
  solid.choices = {"three-element", "four-element-fluid", "two-kelvin", "three-kelvin",
                   "four-kelvin",   "fractional",         "auto"};
  return solid;
}

std::optional<SolidKind> solid_asked(const std::optional<std::string>& name) {
  if (!name) {
    return SolidKind::three_element;
  }
  return *name == "auto" ? std::nullopt : std::optional(solid_kind(*name));
}

std::string bar_in_words(const Bar& bar, const Bench& bench, const std::optional<Material>& given) {
  if (bar.youngs_modulus_Pa) {
    return "elastic, modulus from the bench";
  }
  if (bar.material) {
    return bar.material->source.empty() ? "its own material, from the bench" : bar.material->source;
  }
  Bench of_model = bench;
  if (bench.output && bench.output->material) {
    of_model.output.reset();
  }
  return viscoelastic_in_words(of_model, given);
}

}  // namespace kolsky::cli
