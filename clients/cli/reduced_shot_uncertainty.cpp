#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "clients/cli/reduced_shot.hpp"
#include "clients/figure/layout.hpp"

namespace kolsky::cli {
namespace {

void add_band(const Band& band, const std::string& name, const std::string& unit,
              JsonObject& object) {
  object.push_back({name + "_sd" + unit, band.sd});
  object.push_back({name + "_low" + unit, band.low});
  object.push_back({name + "_high" + unit, band.high});
}

JsonObject figures_json(const Uncertainty& uncertainty) {
  JsonObject figures;
  for (const UncertainFigure& figure : uncertainty.figures) {
    figures.push_back({figure.name, JsonObject{{"value", figure.value},
                                               {"sd", figure.sd},
                                               {"low", figure.low},
                                               {"high", figure.high}}});
  }
  return figures;
}

JsonList budget_json(const Uncertainty& uncertainty) {
  JsonList budget;
  for (const BudgetLine& line : uncertainty.budget) {
    JsonObject entry = {{"source", line.source}};
    for (std::size_t f = 0; f < uncertainty.figures.size(); ++f) {
      entry.push_back(
          {uncertainty.figures[f].name, JsonObject{{"sd", line.sd[f]}, {"share", line.share[f]}}});
    }
    budget.push_back(std::move(entry));
  }
  return budget;
}

std::string unit_of(const std::string& figure) {
  if (figure.ends_with("_Pa")) {
    return "Pa";
  }
  return figure.ends_with("_per_s") ? "1/s" : "strain";
}

// As a column's head: "peak_stress_Pa" is "peak stress".
std::string short_name(std::string figure) {
  for (const char* unit : {"_per_s", "_Pa"}) {
    if (figure.ends_with(unit)) {
      figure.erase(figure.size() - std::string_view(unit).size());
    }
  }
  if (figure.starts_with("mean_strain_")) {
    figure.erase(5, 7);
  }
  std::replace(figure.begin(), figure.end(), '_', ' ');
  return figure;
}

}  // namespace

void describe_uncertainty(const Uncertainty& uncertainty, JsonObject& object) {
  add_band(uncertainty.stress_Pa, "stress", "_Pa", object);
  add_band(uncertainty.strain, "strain", "", object);
  add_band(uncertainty.strain_rate_per_s, "strain_rate", "_per_s", object);
  add_band(uncertainty.force_front_N, "force_front", "_N", object);
  add_band(uncertainty.force_back_N, "force_back", "_N", object);
  JsonList sources;
  for (const UncertaintySource& source : uncertainty.sources) {
    sources.push_back(
        JsonObject{{"name", source.name}, {"value", source.value}, {"sd", source.sd}});
  }
  object.push_back(
      {"uncertainty", JsonObject{{"draws", static_cast<std::uint64_t>(uncertainty.draws)},
                                 {"failed", static_cast<std::uint64_t>(uncertainty.failed)},
                                 {"coverage", 0.95},
                                 {"figures", figures_json(uncertainty)},
                                 {"sources", std::move(sources)}}});
  object.push_back({"budget", budget_json(uncertainty)});
}

std::string uncertainty_report(const Uncertainty& uncertainty) {
  std::string text = fmt::format(
      "  uncertainty       {} draws, 95 % intervals{}\n", uncertainty.draws,
      uncertainty.failed > 0 ? fmt::format("; {} draws could not be reduced", uncertainty.failed)
                             : "");
  for (const UncertainFigure& figure : uncertainty.figures) {
    const std::string unit = unit_of(figure.name);
    text += fmt::format("    {:<16}{} ± {}, {} to {}\n", short_name(figure.name),
                        with_unit(figure.value, unit), with_unit(figure.sd, unit),
                        with_unit(figure.low, unit), with_unit(figure.high, unit));
  }
  text += fmt::format("  {:<22}", "share of variance");
  for (const UncertainFigure& figure : uncertainty.figures) {
    text += fmt::format("{:>14}", short_name(figure.name));
  }
  text += "\n";
  for (const BudgetLine& line : uncertainty.budget) {
    text += fmt::format("    {:<20}", line.source);
    for (const double share : line.share) {
      text += fmt::format("{:>12.1f} %", 100.0 * share);
    }
    text += "\n";
  }
  if (uncertainty.sources.empty()) {
    text +=
        "    only noise counts: neither bench file nor bar model files a deviation\n"
        "    (<key>_sd)\n";
  }
  return text;
}

}  // namespace kolsky::cli
