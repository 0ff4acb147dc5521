#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "clients/cli/reports/budget.hpp"
#include "clients/cli/reports/intervals.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/figure/layout.hpp"

namespace kolsky::cli {
namespace {

void add_band(const Band& band, const std::string& name, const std::string& unit,
              JsonObject& object) {
  object.push_back({name + "_sd" + unit, band.sd});
  object.push_back({name + "_low" + unit, band.low});
  object.push_back({name + "_high" + unit, band.high});
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

bool files_a_deviation(const Uncertainty& uncertainty) {
  return std::any_of(uncertainty.sources.begin(), uncertainty.sources.end(),
                     [](const UncertaintySource& source) { return source.name != kHiddenPush; });
}

}  // namespace

void describe_uncertainty(const Uncertainty& uncertainty, bool front_known, JsonObject& object) {
  add_band(uncertainty.stress_Pa, "stress", "_Pa", object);
  add_band(uncertainty.strain, "strain", "", object);
  add_band(uncertainty.strain_rate_per_s, "strain_rate", "_per_s", object);
  if (front_known) {
    add_band(uncertainty.force_front_N, "force_front", "_N", object);
  }
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
                                 {"figures", intervals_json(uncertainty.figures)},
                                 {"sources", std::move(sources)},
                                 {"uncounted", uncertainty.uncounted}}});
  std::vector<std::string> numbers;
  for (const UncertainFigure& figure : uncertainty.figures) {
    numbers.push_back(figure.name);
  }
  object.push_back({"budget", budget_json(uncertainty.budget, numbers)});
}

std::string uncertainty_report(const Uncertainty& uncertainty) {
  if (uncertainty.draws == 0) {
    return "  uncertainty       none: there is no curve to give one to; why not is said below\n";
  }
  std::string text = fmt::format(
      "  uncertainty       {} draws, 95 % intervals{}\n", uncertainty.draws,
      uncertainty.failed > 0 ? fmt::format("; {} draws could not be reduced", uncertainty.failed)
                             : "");
  for (const UncertainFigure& figure : uncertainty.figures) {
    const std::string unit = unit_of(figure.name);
    text += fmt::format("    {:<16}{}, {} to {}\n", short_name(figure.name),
                        with_deviation(figure.value, figure.sd, unit), with_unit(figure.low, unit),
                        with_unit(figure.high, unit));
    if (figure.lifted_by_noise > figure.sd) {
      text += fmt::format(
          "                    some {} of it is noise, as it is the largest of noisy samples: of "
          "a\n"
          "                    plateau quote the mean\n",
          with_unit(figure.lifted_by_noise, unit));
    }
  }
  if (uncertainty.figures.empty()) {
    text += "    of the curve alone: there is no loading to give numbers of\n";
  }
  std::vector<std::string> heads;
  for (const UncertainFigure& figure : uncertainty.figures) {
    heads.push_back(short_name(figure.name));
  }
  text += heads.empty() ? "" : budget_table(uncertainty.budget, heads);
  for (const std::string& name : uncertainty.uncounted) {
    text +=
        "    not counted: " + name + ", for moved by its deviation the shot cannot be reduced\n";
  }
  if (!files_a_deviation(uncertainty)) {
    text +=
        "    nothing else counts: no deviation is filed of what this curve depends on\n"
        "    (<key>_sd)\n";
  }
  return text;
}

}  // namespace kolsky::cli
