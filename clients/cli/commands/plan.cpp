#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/figure/layout.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/planning/shot_plan.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  std::string bench;
  std::string specimen;
  std::optional<std::string> bar_model;
  std::optional<double> striker_speed;
  std::optional<double> pulse_strain;
  std::optional<double> pulse_duration_s;
  std::optional<double> rise_s;
  std::optional<double> noise_microstrain;
};

/// What the bars are taken to be.
struct Bars {
  Material material;
  std::string in_words;
  bool assumed = false;
};

void require_option(const std::optional<double>& number, const std::string& name,
                    const Range& range) {
  if (number) {
    require_in_range("kolsky plan: " + name, {*number, 0.0}, range);
  }
}

PlannedPulse pulse_of(const Settings& s, const Bench& bench, const Material& bars) {
  constexpr Range kSpeed{0.01, 500.0, "m/s", "give metres per second"};
  constexpr Range kStrain{1e-6, 0.1, "", "give strain: 1000 microstrain is 1e-3"};
  constexpr Range kDuration{1e-6, 0.01, "s", "give seconds: 170 us is 170e-6"};
  constexpr Range kRise{1e-9, 0.01, "s", "give seconds: 20 us is 20e-6"};
  require_option(s.striker_speed, "--striker-speed", kSpeed);
  require_option(s.pulse_strain, "--pulse-strain", kStrain);
  require_option(s.pulse_duration_s, "--pulse-duration", kDuration);
  require_option(s.rise_s, "--rise", kRise);
  const double rise_s = s.rise_s.value_or(0.0);
  if (s.pulse_strain && s.pulse_duration_s && !s.striker_speed) {
    return pulse_of_strain(bench, bars, *s.pulse_strain, *s.pulse_duration_s, rise_s);
  }
  std::optional<double> speed = s.striker_speed;
  if (!speed && bench.striker && bench.striker->speed_m_per_s) {
    speed = bench.striker->speed_m_per_s->value;
  }
  if (s.striker_speed && (s.pulse_strain || s.pulse_duration_s)) {
    throw InputError("kolsky plan", "is told two pulses, a striker's and one by itself",
                     "give --striker-speed, or both --pulse-strain and --pulse-duration");
  }
  if (!speed || s.pulse_strain || s.pulse_duration_s) {
    throw InputError("kolsky plan", "does not know the pulse",
                     "give --striker-speed, or both --pulse-strain and --pulse-duration");
  }
  return pulse_of_striker(bench, bars, *speed, rise_s);
}

/// What the reduction of the shot would say.
JsonValue reduced_json(const ShotPlan& plan) {
  if (!plan.reduction.quality.reducible) {
    return nullptr;
  }
  const LoopSummary loop = summarise(plan.reduction);
  return JsonObject{{"peak_strain", loop.peak_strain},
                    {"peak_stress_Pa", loop.peak_stress_Pa},
                    {"quotable", plan.quotable.text}};
}

JsonValue describe(const ShotPlan& plan, const Bars& bars) {
  JsonList gauges;
  for (const GaugeForecast& gauge : plan.gauges) {
    gauges.push_back(JsonObject{{"name", gauge.name},
                                {"highest_strain", gauge.highest_strain},
                                {"lowest_strain", gauge.lowest_strain},
                                {"unit", gauge.unit},
                                {"highest_reading", gauge.highest_reading}});
  }
  const Quality& quality = plan.reduction.quality;
  JsonObject checks;
  for (const Check& check : quality.checks) {
    checks.push_back({check.name, JsonObject{{"value", check.value},
                                             {"limit", check.limit},
                                             {"verdict", verdict_name(check.verdict)},
                                             {"text", check.text}}});
  }
  return JsonObject{
      {"bar_model", bars.in_words},
      {"bar_model_assumed", bars.assumed},
      {"pulse", JsonObject{{"peak_force_N", plan.pulse.step_force_N.front()},
                           {"duration_s", plan.pulse.duration_s() + plan.pulse.rise_s},
                           {"rise_s", plan.pulse.rise_s}}},
      {"peak_strain", plan.summary.peak_strain},
      {"peak_stress_Pa", plan.summary.peak_stress_Pa},
      {"mean_strain_rate_per_s", plan.summary.mean_strain_rate_per_s},
      {"loading_s", plan.summary.loading_s},
      {"equilibrium_from_s", plan.equilibrium.any ? JsonValue(plan.equilibrium.from_s) : nullptr},
      {"equilibrium_from_strain",
       plan.equilibrium.any ? JsonValue(plan.equilibrium.from_strain) : nullptr},
      {"specimen_transit_s", plan.specimen_transit_s},
      {"window_s", plan.window_s},
      {"whole_pulse_m", plan.whole_pulse_m},
      {"returns_s", plan.returns_s},
      {"gauges", std::move(gauges)},
      {"reduced", reduced_json(plan)},
      {"quality", JsonObject{{"reducible", quality.reducible},
                             {"reason", quality.reason},
                             {"mend", quality.mend},
                             {"verdict", verdict_name(quality.verdict())},
                             {"checks", std::move(checks)}}},
      {"time_s", plan.specimen.time_s},
      {"stress_Pa", plan.specimen.stress_Pa},
      {"strain", plan.specimen.strain},
      {"strain_rate_per_s", plan.specimen.strain_rate_per_s}};
}

std::string line(const std::string& name, const std::string& text) {
  return fmt::format("  {:<18}{}\n", name, text);
}

/// What would keep the reflection from hiding the pulse.
std::string needed(const ShotPlan& plan) {
  const double bar_m = plan.shot.bench.input.length_m;
  return fmt::format("too short: it takes a pulse of at most {}, or a gauge {} from the specimen{}",
                     with_unit(plan.window_s, "s"), with_unit(plan.whole_pulse_m, "m"),
                     bar_m < plan.whole_pulse_m
                         ? fmt::format(", on a bar longer than its {}", with_unit(bar_m, "m"))
                         : "");
}

std::string equilibrium_text(const Quotable& part) {
  return part.any ? fmt::format("from {} on, at a strain of {}", with_unit(part.from_s, "s"),
                                with_unit(part.from_strain, "strain"))
                  : "none while the specimen is loaded";
}

/// What a reduction of the shot would see; where the striker's push is hidden, no more than that.
std::string reduced_text(const ShotPlan& plan) {
  const Quality& quality = plan.reduction.quality;
  std::string text = line("reduced", verdict_name(quality.verdict()));
  if (!quality.reducible) {
    return text + line("", quality.reason) + line("", quality.mend);
  }
  const Check* overlap = quality.find("window_overlap");
  if (overlap != nullptr && overlap->verdict == Verdict::fail) {
    return text + line("", "not what is foretold: " + overlap->text);
  }
  const LoopSummary loop = summarise(plan.reduction);
  text += line(
      "", fmt::format("largest strain {}, peak stress {}", with_unit(loop.peak_strain, "strain"),
                      with_unit(loop.peak_stress_Pa, "Pa")));
  text += line("  may be quoted", plan.quotable.text);
  for (const Check& check : quality.checks) {
    if (check.verdict != Verdict::pass) {
      text += line("  " + check.name, check.text);
    }
  }
  return text;
}

std::string report(const ShotPlan& plan, const Bars& bars) {
  const double pulse_s = plan.pulse.duration_s() + plan.pulse.rise_s;
  std::string text =
      line("pulse", fmt::format("{} for {}", with_unit(plan.pulse.step_force_N.front(), "N"),
                                with_unit(pulse_s, "s"))) +
      line("bars", bars.in_words);
  text += line("largest strain", with_unit(plan.summary.peak_strain, "strain"));
  text += line("peak stress", with_unit(plan.summary.peak_stress_Pa, "Pa"));
  text +=
      line("mean strain rate", fmt::format("{} over {} of loading",
                                           with_unit(plan.summary.mean_strain_rate_per_s, "1/s"),
                                           with_unit(plan.summary.loading_s, "s")));
  text += line("equilibrium", equilibrium_text(plan.equilibrium));
  text +=
      line("window", fmt::format("{} of incident pulse alone at the first gauge, which lasts {}",
                                 with_unit(plan.window_s, "s"), with_unit(pulse_s, "s")));
  if (plan.window_s < pulse_s) {
    text += line("", needed(plan));
  }
  text += line("", fmt::format("a far end answers at the specimen {} after arrival",
                               with_unit(plan.returns_s, "s")));
  text += line("specimen transit", with_unit(plan.specimen_transit_s, "s"));
  for (const GaugeForecast& gauge : plan.gauges) {
    text += line(
        "gauge " + gauge.name,
        fmt::format("{:+.0f} to {:+.0f} microstrain{}", 1e6 * gauge.lowest_strain,
                    1e6 * gauge.highest_strain,
                    gauge.unit == "V" ? ", up to " + with_unit(gauge.highest_reading, "V") : ""));
  }
  return text + reduced_text(plan);
}

Bars bars_of(const Settings& settings, const Bench& bench) {
  require_own_material_holds(bench);
  if (settings.bar_model) {
    const BarModelFile model = read_bar_model(*settings.bar_model);
    require_holds(model, bench);
    const std::string doubt = poorly_identified(model.prior.material);
    Material named = model.prior.material;
    named.source = model.name + (doubt.empty() ? "" : " (" + doubt + ")");
    return {model.prior.material, viscoelastic_in_words(bench, named), false};
  }
  try {
    const Material material = assumed_bars(bench);
    if (all_elastic(bench)) {
      return {material, "elastic, moduli from the bench", false};
    }
    return {material, viscoelastic_in_words(bench, std::nullopt), takes_bar_model(bench)};
  } catch (const InputError& error) {
    throw error.inside(settings.bench);
  }
}

int run(const Settings& settings, Context& context) {
  const Bench bench = read_bench(settings.bench).bench;
  const Bars bars = bars_of(settings, bench);
  const Material specimen = read_material(settings.specimen);
  constexpr Range kNoise{1e-6, 1e5, "microstrain", "give microstrain, as 4"};
  require_option(settings.noise_microstrain, "--noise", kNoise);
  PlanOptions options;
  options.bars_assumed = bars.assumed;
  options.noise_strain = 1e-6 * settings.noise_microstrain.value_or(1e6 * options.noise_strain);
  try {
    const ShotPlan plan = plan_shot(bench, bars.material, specimen,
                                    pulse_of(settings, bench, bars.material), options);
    context.out << (context.json ? to_text(describe(plan, bars)) + "\n" : report(plan, bars));
  } catch (const InputError& error) {
    throw error.inside(settings.bench);
  }
  return kDone;
}

}  // namespace

Command plan_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "plan";
  command.purpose =
      "what a shot will give before it is fired\n"
      "Strain, rate, time to equilibrium, windows and gauge ranges, from a striker's speed or a\n"
      "pulse, for a linear specimen that stays in touch with both bars; and what a reduction of\n"
      "the records that its gauges would take will see of that.";
  command.examples =
      "  kolsky plan --bench bench.toml --specimen core.toml --pulse-strain 1e-3 --pulse-duration "
      "170e-6 --rise 40e-6\n"
      "  kolsky plan --bench bench.toml --specimen core.toml --striker-speed 12\n";
  command.arguments = {
      needed("--bench", "BENCH.toml", "the bench file: bars, gauges, specimen, striker", &s.bench),
      needed("--specimen", "S.toml", "material file of the specimen", &s.specimen),
      option("--bar-model", "M.toml", "material file of viscoelastic bars; else the paper's PMMA",
             &s.bar_model),
      option("--striker-speed", "V", "in m/s; else the bench's own", &s.striker_speed),
      option("--pulse-strain", "STRAIN",
             "largest of the incident pulse at the input bar's first gauge, instead of a speed",
             &s.pulse_strain),
      option("--pulse-duration", "S", "of the incident pulse in s", &s.pulse_duration_s),
      option("--rise", "S", "of the pulse in s; else what a wave needs along the bar's diameter",
             &s.rise_s),
      option("--noise", "MICROSTRAIN", "rms at the gauges; 5 by default", &s.noise_microstrain)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
