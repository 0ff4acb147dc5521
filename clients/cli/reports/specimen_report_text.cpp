#include <fmt/format.h>

#include <cmath>

#include "clients/cli/reports/budget.hpp"
#include "clients/cli/reports/fit_draws.hpp"
#include "clients/cli/reports/specimen_report.hpp"
#include "clients/figure/layout.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/identification/parameter_budget.hpp"

namespace kolsky::cli {
namespace {

std::string table_of(const std::vector<FittedNumber>& list) {
  std::string text;
  for (const FittedNumber& p : list) {
    text +=
        fmt::format("    {:<12}{:>12.5g} ± {:.2g} %\n", p.name, p.value, 100.0 * p.sd / p.value);
  }
  return text;
}

std::string deviation(double sd) {
  return std::isnan(sd) ? "       -" : fmt::format("± {:<6.2g}", sd);
}

/// J at a few frequencies, for people.
std::string spectrum_text(const std::vector<CompliancePoint>& spectrum) {
  constexpr double kPerGPa = 1e9;
  std::string text =
      "      mean of the shots ± deviation of one\n"
      "          Hz        J1 [1/GPa]        J2 [1/GPa]\n";
  double next = 0.0;
  for (const CompliancePoint& point : spectrum) {
    if (point.frequency_Hz >= next) {
      next = point.frequency_Hz * 1.35;
      text += fmt::format("    {:>8.0f}  {:>8.4g} {}  {:>8.4g} {}\n", point.frequency_Hz,
                          kPerGPa * point.J1_per_Pa, deviation(kPerGPa * point.J1_sd),
                          kPerGPa * point.J2_per_Pa, deviation(kPerGPa * point.J2_sd));
    }
  }
  return text;
}

}  // namespace

std::string bars_in_words(const IdentifiedSpecimen& outcome) {
  const Shot& first = outcome.shots.front();
  if (all_elastic(first.bench)) {
    return "elastic, moduli from the bench";
  }
  if (outcome.bars) {
    Material named = outcome.bars->prior.material;
    named.source = outcome.bars->name;
    return viscoelastic_in_words(first.bench, named);
  }
  return viscoelastic_in_words(first.bench, first.bar_model);
}

std::string report(const IdentifiedSpecimen& outcome) {
  const SpecimenFit& fit = outcome.fit;
  std::string text = fmt::format("specimen from {} shot{}, bars: {}\n", outcome.shots.size(),
                                 outcome.shots.size() == 1 ? "" : "s", bars_in_words(outcome));
  text += fmt::format("  direct fit to the records ({}, up to {}, {} of each record)\n",
                      name_of(fit.solid), with_unit(fit.band_limit_Hz, "Hz"),
                      with_unit(fit.judged_s, "s"));
  text += table_of(fit.parameters);
  text += budget_table(parameter_budget(fit.parameters, fit.by_bench, fit.bench),
                       names_of(fit.parameters));
  text += fmt::format("    chi2 per degree of freedom {:.3f} ({} of them); bars {}, specimen {}\n",
                      fit.chi2_reduced, fit.degrees_of_freedom, name_of(fit.theory.bars),
                      name_of(fit.theory.specimen));
  for (const TriedTheory& tried : fit.tried) {
    text +=
        fmt::format("      tried: bars {:<10} specimen {:<9} {}{}\n", name_of(tried.theory.bars),
                    name_of(tried.theory.specimen),
                    tried.refused.empty() ? fmt::format("chi2 {:.1f}", tried.chi2) : tried.refused,
                    tried.solid == fit.solid ? "" : ", three elements");
  }
  if (fit.three_element) {
    text +=
        fmt::format("    three elements leave {:.1f} more of chi2\n", fit.three_element->chi2_gain);
  }
  text += spectrum_text(fit.spectrum);
  if (outcome.spectral) {
    text += fmt::format("  strain over stress, frequency by frequency (eq. 25, up to {})\n",
                        with_unit(outcome.spectral->band_limit_Hz, "Hz"));
    text += table_of(outcome.spectral->parameters);
    text +=
        "    these deviations hold noise and scatter, neither the bench's nor the bars': --draws "
        "has "
        "them\n";
    if (outcome.spectral->separation == Separation::equilibrium) {
      text += "    waves overlap: told apart by the output bar's force, as if in equilibrium\n";
    }
    text += spectrum_text(outcome.spectral->spectrum);
    for (const std::string& warning : outcome.spectral->warnings) {
      text += "    warning: " + warning + "\n";
    }
  } else {
    text += "  no estimate from the histories: " + outcome.spectral_refused + "\n";
  }
  text += report(outcome.draws);
  for (const std::string& warning : fit.warnings) {
    text += "  warning: " + warning + "\n";
  }
  return text;
}

}  // namespace kolsky::cli
