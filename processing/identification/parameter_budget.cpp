#include "processing/identification/parameter_budget.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace kolsky {
namespace {

/// In the words of a reduction's budget.
std::string source_of(const std::string& number) {
  constexpr std::array kSources{std::pair{"gauge-factor", "gauge factors"},
                                std::pair{"gauge-position", "gauge positions"},
                                std::pair{"channel-delay", "channel delays"},
                                std::pair{"bar-length", "bar lengths"},
                                std::pair{"bar-diameter", "bar diameters"},
                                std::pair{"diameter", "bar diameters"},
                                std::pair{"density", "bar densities"},
                                std::pair{"poisson-ratio", "Poisson's ratios"},
                                std::pair{"youngs-modulus", "bar moduli"},
                                std::pair{"bar-model", "bar moduli"},
                                std::pair{"output-bar-model", "bar moduli"},
                                std::pair{"specimen-length", "specimen length"},
                                std::pair{"specimen-diameter", "specimen diameter"},
                                std::pair{"specimen-density", "specimen inertia"}};
  const std::string kind = number.substr(0, number.find(':'));
  for (const auto& [name, words] : kSources) {
    if (kind == name) {
      return words;
    }
  }
  return kind;
}

}  // namespace

std::vector<BudgetLine> parameter_budget(const std::vector<FittedNumber>& parameters,
                                         const std::vector<std::vector<double>>& by_bench,
                                         const std::vector<FittedNumber>& bench) {
  std::map<std::string, std::vector<double>> variances;
  std::vector<double> rest;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    rest.push_back(std::pow(parameters[p].sd, 2));
    for (std::size_t i = 0; i < bench.size(); ++i) {
      auto& line = variances[source_of(bench[i].name)];
      line.resize(parameters.size());
      const double variance = std::min(std::pow(by_bench[p][i], 2), rest[p]);
      line[p] += variance;
      rest[p] -= variance;
    }
  }
  variances["noise"] = rest;
  std::vector<BudgetLine> budget;
  for (const auto& [source, line] : variances) {
    BudgetLine& entry = budget.emplace_back(BudgetLine{source, {}, {}});
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const double all = std::pow(parameters[p].sd, 2);
      entry.sd.push_back(std::sqrt(line[p]));
      entry.share.push_back(all > 0.0 ? line[p] / all : 0.0);
    }
  }
  std::stable_sort(budget.begin(), budget.end(), [](const BudgetLine& a, const BudgetLine& b) {
    return a.sd.front() > b.sd.front();
  });
  return budget;
}

}  // namespace kolsky
