#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "clients/cli/reports/bar_report.hpp"
#include "clients/cli/reports/budget.hpp"
#include "clients/cli/reports/fit_draws.hpp"
#include "clients/figure/layout.hpp"
#include "processing/identification/parameter_budget.hpp"

namespace kolsky::cli {
namespace {

std::string unit_of(const std::string& name) {
  if (name.ends_with("_Pa_s")) {
    return "Pa s";
  }
  return name.ends_with("_Pa") ? "Pa" : "";
}

std::string table_of(const std::vector<FittedNumber>& list) {
  std::string text;
  for (const FittedNumber& p : list) {
    text += fmt::format("    {:<10} {:>14.6g} ± {:.2g} {:<5} ({:.2g} %)\n", p.name, p.value, p.sd,
                        unit_of(p.name), 100.0 * p.sd / p.value);
  }
  return text;
}

std::string choice_text(const ChoiceByEvidence& choice) {
  if (choice.asked) {
    return "as asked";
  }
  return fmt::format("{}, ahead of the next by a log evidence of {:.3g}",
                     choice.told_apart ? "by the records" : "not told apart by the records",
                     choice.ahead);
}

std::string alternatives_text(const BarIdentification& result) {
  if (result.alternatives.empty()) {
    return "";
  }
  const double best = result.alternatives.front().log_evidence;
  std::string text =
      "  tried, best first (log evidence under the best's, reduced chi2; roughly: no better by a "
      "rough search, not searched further)\n";
  for (const Alternative& a : result.alternatives) {
    text += fmt::format("    {:<11}{:<20}far end {:<8}", name_of(a.theory.waves),
                        a.theory.lossless ? "elastic" : name_of(a.theory.solid),
                        name_of(a.theory.far_end));
    text += a.failed.empty() ? fmt::format("{:>12.1f} {:>10.4f}{}\n", a.log_evidence - best,
                                           a.chi2_reduced, a.left_behind ? "  roughly" : "")
                             : " " + a.failed + "\n";
  }
  return text;
}

/// J at a few frequencies, for people.
std::string spectrum_text(const BarSpectrum& spectrum) {
  std::string text =
      "  frequency by frequency (mean of the shots ± deviation of one)\n"
      "          Hz      J1 [1/GPa]        J2 [1/GPa]       alpha [1/m]   c [m/s]\n";
  double next = 0.0;
  for (std::size_t k = 0; k < spectrum.frequency_Hz.size(); ++k) {
    const double f = spectrum.frequency_Hz[k];
    if (f < next) {
      continue;
    }
    next = f < 5e3 ? f + 900.0 : f * 1.35;
    text += fmt::format("    {:>8.0f}  {:.5f} ± {:.5f}  {:.5f} ± {:.5f}  {:>10.4f} {:>10.2f}\n", f,
                        1e9 * spectrum.J1_per_Pa.mean[k], 1e9 * spectrum.J1_per_Pa.sd[k],
                        1e9 * spectrum.J2_per_Pa.mean[k], 1e9 * spectrum.J2_per_Pa.sd[k],
                        spectrum.alpha_per_m.mean[k],
                        2.0 * std::numbers::pi * f / spectrum.wavenumber_per_m.mean[k]);
  }
  return text;
}

Complex compliance_at(const BarFit& fit, double frequency_Hz) {
  std::vector<double> values;
  for (const FittedNumber& p : fit.parameters) {
    values.push_back(p.value);
  }
  return make_solid(fit.solid, values)->at({0.0, 2.0 * std::numbers::pi * frequency_Hz});
}

}  // namespace

std::string report(const BarIdentification& result, const std::optional<FitDraws>& draws) {
  const BarFit& three = result.three_element;
  std::string text =
      fmt::format("bar from {} shot{}, up to {}\n", result.shot_ids.size(),
                  result.shot_ids.size() == 1 ? "" : "s", with_unit(three.band_limit_Hz, "Hz"));
  text +=
      result.two_passes
          ? "  three-element solid, by maximum likelihood, one gauge: the pulse and its return\n"
          : "  three-element solid, by maximum likelihood over whole records\n";
  text += table_of(three.parameters);
  text += budget_table(parameter_budget(three.parameters, three.by_bench, three.bench),
                       names_of(three.parameters));
  text += report(draws);
  text +=
      fmt::format("    reduced chi2 {:.4f} of {}\n", three.chi2_reduced, three.degrees_of_freedom);
  text += "  waves: " + name_of(three.theory) + " (" + choice_text(result.wave_theory) + ")\n";
  text += "  far end: " + name_of(three.far_end) + " (" + choice_text(result.far_end) + ")\n";
  if (result.fit.solid != SolidKind::three_element) {
    text += "  " + name_of(result.fit.solid) + " solid\n" + table_of(result.fit.parameters);
  }
  text += alternatives_text(result);
  if (result.shot_ids.size() > 1) {
    text += "  mean of the shots, and deviation of one\n" + table_of(result.over_shots);
  }
  if (!result.paper.empty()) {
    text +=
        "  the paper's analysis for comparison (straight lines over position, elementary waves, to "
        "15 kHz)\n" +
        table_of(result.paper);
  }
  text += spectrum_text(result.spectrum);
  for (const std::string& warning : result.warnings) {
    text += "  warning: " + warning + "\n";
  }
  return text;
}

Figure bar_figure(const BarIdentification& result, const ForetoldShot& foretold) {
  const BarSpectrum& s = result.spectrum;
  Series J1_fit{"fit J1", s.frequency_Hz, {}};
  Series J2_fit{"fit J2", s.frequency_Hz, {}};
  std::vector<double> speed;
  for (std::size_t k = 0; k < s.frequency_Hz.size(); ++k) {
    const Complex J = compliance_at(result.fit, s.frequency_Hz[k]);
    J1_fit.y.push_back(J.real());
    J2_fit.y.push_back(-J.imag());
    speed.push_back(2.0 * std::numbers::pi * s.frequency_Hz[k] / s.wavenumber_per_m.mean[k]);
  }
  Figure figure;
  figure.title = "identified bar";
  figure.notes = result.warnings;
  figure.panels.push_back({"compliance J1",
                           {"frequency", "Hz"},
                           {"J1", "1/Pa"},
                           {{"J1", s.frequency_Hz, s.J1_per_Pa.mean}, J1_fit}});
  figure.panels.push_back({"compliance J2",
                           {"frequency", "Hz"},
                           {"J2", "1/Pa"},
                           {{"J2", s.frequency_Hz, s.J2_per_Pa.mean}, J2_fit}});
  figure.panels.push_back({"attenuation",
                           {"frequency", "Hz"},
                           {"alpha", "1/m"},
                           {{"alpha", s.frequency_Hz, s.alpha_per_m.mean}}});
  figure.panels.push_back(
      {"phase velocity", {"frequency", "Hz"}, {"c", "m/s"}, {{"c", s.frequency_Hz, speed}}});
  Panel waves{"measured, and foretold", {"time", "s"}, {"strain", "strain"}, {}};
  Panel left{"measured less foretold", {"time", "s"}, {"strain", "strain"}, {}};
  for (const ForetoldGauge& gauge : foretold.gauges) {
    waves.series.push_back({gauge.name, foretold.time_s, gauge.measured});
    waves.series.push_back({gauge.name + " foretold", foretold.time_s, gauge.foretold});
    Series residual{gauge.name, foretold.time_s, gauge.measured};
    for (std::size_t n = 0; n < residual.y.size(); ++n) {
      residual.y[n] -= gauge.foretold[n];
    }
    left.series.push_back(std::move(residual));
  }
  figure.panels.push_back(std::move(waves));
  figure.panels.push_back(std::move(left));
  return figure;
}

}  // namespace kolsky::cli
